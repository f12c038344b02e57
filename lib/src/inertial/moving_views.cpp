#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/imu_path.h"
#include "geometry/pnp.h"
#include "geometry/so3.h"
#include "inertial/moving_start.h"
#include "inertial/tuning.h"

/// The views of a start while moving: kept, thinned out, and placed in the present map.

namespace pf {

/// Integrates the samples between a time and the view. False where they are missing.
bool MovingStart::integrate(std::int64_t from_ns, View* view) const {
  const Body& body = filter_.state().body;
  const Vec3 gyro_bias = filter_.uses_samples() ? body.gyro_bias : Vec3(Vec3::Zero());
  Preintegral samples(motion_.unit_noise().now(), gyro_bias, Vec3::Zero(), filter_.state().mounting.intrinsics);
  ImuReading now;
  if (integrate_samples(imu_, motion_.on_unit_clock(from_ns), motion_.on_unit_clock(view->t_ns), Coasting(), &samples,
                        &now) > Scalar(0))
    return false;
  view->samples = {samples.dt(), gyro_bias,   Quat(samples.R()),
                   samples.v(),  samples.p(), samples.by_bias().cast<float>()};
  return true;
}

void MovingStart::integrate_again() {
  int first = data_.count > 0 ? data_.count - 1 : 0;
  while (first > 0 && integrate(data_.view[first - 1].t_ns, &data_.view[first])) --first;
  drop(first);
  rest_.is_first = rest_.is_first && first == 0;
  data_.left = data_.first = data_.end = 0;
}

/// Leaves out the oldest views.
void MovingStart::drop(int count) {
  std::copy(data_.view + count, data_.view + data_.count, data_.view);
  for (int* index : {&data_.count, &data_.left, &data_.first, &data_.end}) *index = std::max(0, *index - count);
}

/// Drops every second view but the first and the last.
void MovingStart::halve() {
  int count = 1;
  for (int k = 2; k < data_.count; ++k) {
    if (k % 2 == 0) data_.view[k].samples.begin_with(data_.view[k - 1].samples);
    if (k % 2 == 0 || k + 1 == data_.count) data_.view[count++] = data_.view[k];
  }
  data_.count = count;
  data_.left = data_.first = data_.end = 0;
  ++rest_.halvings;
}

void MovingStart::begin_at_rest(const RestReading& rest, std::int64_t since_ns) {
  const std::int64_t until_ns = frame_.report.t_ns - nanoseconds(tuning::rest::kLate);
  int last = data_.count - 1;
  while (last >= 0 && data_.view[last].t_ns > until_ns) --last;
  if (last < 0 || data_.view[last].t_ns < since_ns) return;
  drop(last);
  rest_ = {true, rest, 0};
}

/// Keeps this frame: its inliers, and the samples since the last one that is kept. False where samples are missing.
bool MovingStart::add(const MovingFrame& told, const MovingPoints& points) {
  if (data_.count == kMaxMovingPoses) {
    const bool sees_rest = !(data_.left == 0 && data_.first > 0);  // as far as is known
    if (rest_.is_first && sees_rest && rest_.halvings < kMaxHalvings) {
      halve();
    } else {
      drop(1);
      rest_.is_first = false;
    }
  }
  View& view = data_.view[data_.count];
  view = View();
  view.is_placed = told.is_placed;
  view.q_WC = told.view.q_WC;
  view.p_W = told.view.c_W;
  const std::int64_t t_ns = frame_.report.t_ns;
  view.t_ns = t_ns;
  if (data_.count > 0 && !integrate(data_.t_ns, &view)) return false;
  for (int i = 0; i < frame_.match_count() && view.count < kMaxPixels; ++i) {
    const Match& match = frame_.match(i);
    if (match.status != MatchStatus::kInlier || match.feature < 0) continue;  // it may have left the map since
    const Vec2 pixel = points.pixel_of(points.owner, match);
    view.seen[view.count++] = {match.id, static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
  }
  data_.t_ns = t_ns;
  data_.frames = 0;
  ++data_.count;
  return true;
}

/// Pose of a view against the present map, with the noise that its pixels show.
bool MovingStart::locate(const MovingPoints& points, View* view) const {
  using namespace tuning::moving_verdict;
  PnpPoint point[kMaxPixels];
  int count = 0;
  for (int i = 0; i < view->count; ++i) {
    Vec3 p_W;
    if (!points.find(points.owner, view->seen[i].id, &p_W)) continue;
    point[count++] = {p_W, Scalar(1), Vec2(static_cast<Scalar>(view->seen[i].x), static_cast<Scalar>(view->seen[i].y))};
  }
  if (count < kMinPixels) return false;
  PoseEstimate pose;
  pose.q_WC = view->q_WC;
  pose.p_WC = view->p_W;
  if (!refine_pnp(points.camera, point, count, nullptr, {settings_.sigma_px, kHuber, kRounds}, &pose)) return false;
  view->is_placed = true;
  view->q_WC = pose.q_WC;
  view->p_W = pose.p_WC;
  const Scalar noise = pose.rms_px / settings_.sigma_px;
  const Scalar pixels = static_cast<Scalar>(count);
  view->covariance = (pose.covariance * (noise * noise * pixels / (pixels - 3))).cast<float>();
  return true;
}

/// Goes on with the sweep, or begins one: of all views behind the last one that sees too little of the map. A view that was kept before
/// there were depths is looked for where the next one was. True where it is through.
bool MovingStart::sweep(const MovingPoints& points) {
  if (data_.left == 0) data_.left = data_.first = data_.end = data_.count;
  for (int i = 0; i < tuning::moving_verdict::kLocated && data_.left > 0; ++i) {
    View& view = data_.view[data_.left - 1];
    if (!view.is_placed && data_.left < data_.count) {
      view.q_WC = data_.view[data_.left].q_WC;
      view.p_W = data_.view[data_.left].p_W;
    }
    if (!locate(points, &view)) {
      data_.left = 0;
      break;
    }
    data_.first = --data_.left;
  }
  return data_.left == 0;
}

}  // namespace pf
