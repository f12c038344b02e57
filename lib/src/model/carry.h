#pragma once

#include "geometry/carry.h"
#include "model/body.h"

/// Archive: what the structs of this room hold.

namespace pf {

inline void carry(Archive& archive, Body& body) {
  auto& [q_WC, p_W, v_W, a_C, w_C, gyro_bias, accel_bias, q_WG] = body;
  archive.numbers(q_WC, p_W, v_W, a_C, w_C, gyro_bias, accel_bias, q_WG);
}

inline void carry(Archive& archive, Mounting& mounting) {
  auto& [R_CB, p_C, delay, in_metres, intrinsics] = mounting;
  auto& [D_w, D_a, open] = intrinsics;
  archive.numbers(R_CB, p_C, delay, D_w, D_a);
  archive.flags(in_metres, open);
}

}  // namespace pf
