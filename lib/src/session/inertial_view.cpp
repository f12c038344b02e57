#include "session/inertial_view.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/scale_row.h"
#include "filter_slam/filter_slam.h"
#include "geometry/so3.h"
#include "keyframe_slam/keyframe_slam.h"

namespace pf {

namespace {

/// With R_CB_true = Exp(mu) R_CB and m_true = m + e_m:
///
///   R_BC_true = Exp(-R_BC mu) R_BC,   p_BC = -R_BC m:   e = -R_BC e_m - R_BC [m]x mu
void describe_mounting(const Settings& settings, const Filter& filter, const Mounting& mounting, InertialView* out) {
  const BodyLayout& layout = settings.body;
  const Mat3 R_BC = mounting.R_CB.transpose();
  out->q_BC = Quat(R_BC);
  out->p_BC = -(R_BC * mounting.p_C);
  out->delay_s = seconds(settings.unit.delay_ns) + static_cast<double>(mounting.delay);
  for (int i = 8; i < 18; ++i) out->sigma[i] = Scalar(-1);
  const int turn = layout.row(BodyPart::kMountRotation), place = layout.row(BodyPart::kMountPlace);
  const auto put_sigmas = [&](int first, const Mat3* by_turn, const Mat3* by_place) {
    RowsOf<3, 6, 2> J;
    J.parts = 0;
    const int columns = by_turn != nullptr && by_place != nullptr ? 6 : 3;
    int column = 0;
    const auto add = [&](int row, const Mat3* by) {
      if (by == nullptr) return;
      J.part[J.parts++] = Part::body(row, 3);
      put<3, 3>(J.h, columns, column, *by);
      column += 3;
    };
    add(turn, by_turn);
    add(place, by_place);
    const Mat3 C = filter.covariance_of<3>(J);
    for (int i = 0; i < 3; ++i) out->sigma[first + i] = std::sqrt(std::max(Scalar(0), C(i, i)));
  };
  const Mat3 by_turn = -R_BC.lazyProduct(hat(mounting.p_C)), minus = -R_BC;
  if (turn >= 0) put_sigmas(8, &minus, nullptr);
  if (place >= 0) put_sigmas(11, turn >= 0 ? &by_turn : nullptr, &minus);
  if (layout.has(BodyPart::kDelay))
    out->sigma[14] = std::sqrt(std::max(Scalar(0), filter.variance(layout.row(BodyPart::kDelay))));
  out->intrinsics = mounting.intrinsics;
  if (layout.has(BodyPart::kIntrinsics))
    for (int i = 0; i < Intrinsics::kRows; ++i)
      out->sigma[17] = std::max(out->sigma[17],
                                std::sqrt(std::max(Scalar(0), filter.variance(layout.row(BodyPart::kIntrinsics) + i))));
  out->readout_s = static_cast<double>(filter.lens().readout);
  const LensRows& lens = filter.state().lens_rows;
  if (lens.has_readout())
    out->sigma[15] = std::sqrt(std::max(Scalar(0), filter.variance(layout.row(BodyPart::kLens) + lens.count - 1)));
}

/// unit: UnitKeeper or KeyframeUnit.
template <typename Unit>
UnitDoubt doubt_of(const Settings& settings, const Unit& unit) {
  UnitDoubt doubt;
  if (!settings.inertial) return doubt;
  doubt.doubted = is_rejected(unit.watch().mode());
  doubt.doubted_ns = unit.watch().rejected_ns();
  doubt.reason = static_cast<int>(unit.reason(&doubt.reason_value, &doubt.reason_R_CB));
  const ImuNoise noise = unit.noise();
  doubt.gyro_density = noise.gyro_density;
  doubt.accel_density = noise.accel_density;
  return doubt;
}

template <typename Unit>
void describe(const Settings& settings, const Filter& filter, const Unit& unit, bool is_from_motion,
              InertialView* out) {
  const Body& body = filter.state().body;
  const int gravity = settings.body.row(BodyPart::kGravity), gyro = settings.body.row(BodyPart::kGyroBias);
  out->gravity_W = settings.unit.gravity * body.gravity_W();
  out->gyro_bias = body.gyro_bias;
  out->accel_bias = body.accel_bias;
  for (int k = 0; k < 2; ++k) out->axis_W[k] = body.q_WG.toRotationMatrix().col(k);
  const auto row = [&](int i) { return i < 2 ? gravity + i : gyro + i - 2; };  // the accelerometer's bias follows
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      out->covariance[i][j] = filter.covariance()(std::max(row(i), row(j)), std::min(row(i), row(j)));
  out->metric = filter.is_metric();
  out->from_motion = out->metric && is_from_motion;
  out->resting = unit.hold().holds();
  out->rests = unit.hold().rests();
  for (int i = 0; i < 8; ++i) out->sigma[i] = std::sqrt(std::max(Scalar(0), out->covariance[i][i]));
  describe_mounting(settings, filter, unit.mounting(), out);
  ScaleRow l;
  if (out->metric && find_scale_row(filter, &l)) out->sigma[16] = std::sqrt(std::max(Scalar(0), filter.variance_of(l)));
}

}  // namespace

UnitDoubt read_unit_doubt(const Settings& settings, const FilterSlam& slam) { return doubt_of(settings, slam.unit()); }

UnitDoubt read_unit_doubt(const Settings& settings, const KeyframeSlam& slam) {
  return doubt_of(settings, slam.placement().unit());
}

bool read_inertial(const Settings& settings, const FilterSlam& slam, InertialView* out) {
  if (!settings.inertial || !slam.tracking().has_pose()) return false;
  const UnitKeeper& unit = slam.unit();
  describe(settings, slam.filter(), unit, unit.metric().is_from_motion(), out);
  return true;
}

bool read_inertial(const Settings& settings, const KeyframeSlam& slam, InertialView* out) {
  const KeyframeUnit& unit = slam.placement().unit();
  if (!settings.inertial || !unit.has_begun()) return false;
  describe(settings, unit.filter(), unit, unit.is_from_motion(), out);
  const KeyframeLens& lens = slam.map().lens();
  out->readout_s = static_cast<double>(lens.camera().readout);
  if (lens.rows().has_readout()) out->sigma[15] = std::sqrt(std::max(Scalar(0), lens.readout_variance()));
  // The filter has gravity in the map about the camera, which may be tilted in W.
  const Mat3 of_map = slam.placement().map_covariance(slam.motion().body().p_W).topLeftCorner<3, 3>();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) out->covariance[i][j] += out->axis_W[i].dot(of_map * out->axis_W[j]);
  for (int i = 0; i < 2; ++i) out->sigma[i] = std::sqrt(std::max(Scalar(0), out->covariance[i][i]));
  return true;
}

}  // namespace pf
