#pragma once

#include <cstdint>

#include "base/arena.h"
#include "slam/tracking_state.h"
#include "window/start_bundle.h"

/// A start with nothing known: the pixels of the first frames are recorded until a bundle adjustment can explain them in one way only.
/// Knows no filter: what it records is given to it, and what it explains is read from it.

namespace pf {

class StartWithoutTarget {
 public:
  bool layout(Arena& arena);
  /// None is under way.
  void init();
  /// One is under way from now on.
  void begin() { data_.progress.recording = true; }
  const StartProgress& progress() const { return data_.progress; }

  /// The record begins with this frame, whose camera is its world.
  void begin_record(const Quat& q_WC, const Vec3& p_W, std::int64_t t_ns);
  /// A feature of the first frame, by the ray on which it was seen there.
  void add_feature(std::uint32_t id, const Vec3& ray_C);
  /// A later frame, with the pose in W that is believed; its pixels follow, as if all were read out at the frame's time.
  void begin_frame(const Quat& q_WC, const Vec3& p_W, std::int64_t t_ns);
  void add_pixel(const Camera& camera, std::uint32_t id, const Vec2& pixel);
  /// Explains the record where it can. Afterwards a record that holds too few features is empty.
  StartOutcome solve(const Camera& camera, Scalar sigma_px, Scalar median_depth);

  bool empty() const { return record_.features() == 0; }
  const StartRecord& record() const { return record_; }
  const StartBundle& bundle() const { return bundle_; }
  /// Index of a feature in the record; -1 where it is not in it.
  int index_of(std::uint32_t id) const;
  /// The record's first frame in W.
  const Quat& base_q_WC() const { return data_.base_q_WC; }
  const Vec3& base_p_W() const { return data_.base_p_W; }
  std::int64_t begin_ns() const { return data_.begin_ns; }

 private:
  /// What is kept between frames, beside the record and the last explanation.
  struct Data {
    StartProgress progress;
    Quat base_q_WC = Quat::Identity();
    Vec3 base_p_W = Vec3::Zero();
    std::int64_t begin_ns = 0;
    int frame = 0;           ///< that pixels are added to
    std::int64_t t_ns = 0;   ///< its time
    bool is_second = false;  ///< it is the first after the record's own
    std::uint32_t id[StartRecord::kMaxFeatures] = {};
  };

  void move_ray(const Camera& camera, int index, const Vec2& pixel);

  Data data_;
  StartRecord record_;
  StartBundle bundle_;
};

}  // namespace pf
