#include "slam/rest_detector.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "slam/tuning.h"

namespace pf {

using namespace tuning::rest;

void RestDetector::layout(Arena& arena) {
  if (!settings_.inertial) return;
  seen_ = arena.take<Seen>(kMaxPixels);
  data_ = arena.take<Data>(1);
}

bool RestDetector::note(bool seen, RestReading* rest) {
  const std::int64_t t_ns = frame_.report.t_ns;
  const bool has_pixels = data_->seen > 0;
  if (!data_->begun || !seen || (has_pixels && has_moved())) {
    begin();
    return false;
  }
  if (!has_pixels) keep_pixels();  // a map's first frame has none yet
  for (int i = 0; i < imu_.held(); ++i)
    if (imu_[i].t_ns > data_->sample_ns) add(imu_[i]);
  const Scalar T = static_cast<Scalar>(seconds(elapsed_ns(data_->begin_ns, t_ns)));
  if (T < kTime) return false;
  const bool at_rest = is_quiet();
  if (at_rest) {
    const ImuNoise& noise = settings_.unit.noise;
    const Scalar root = std::sqrt(T);
    rest->gyro = data_->mean[0];
    rest->accel = data_->mean[1];
    rest->sigma_gyro = noise.gyro_density / root + noise.gyro_walk * root;
    rest->sigma_accel = noise.accel_density / root + noise.accel_walk * root;
    // What the picture can vouch for: its motion at the depth that is assumed before any is known.
    const Scalar motion_px = std::max(std::sqrt(data_->motion2), kMinMotionPx);
    rest->sigma_speed = motion_px * settings_.start_depth / (settings_.camera.fx * T);
    rest->sigma_accel_bias = tuning::inertial::kAccelBias;
    rest->gravity = settings_.unit.gravity;
    data_->rest_begin_ns = data_->begin_ns;
  }
  const std::int64_t rest_begin_ns = data_->rest_begin_ns;
  begin();
  data_->rest_begin_ns = rest_begin_ns;
  return at_rest;
}

/// The next second; samples before it have been seen.
void RestDetector::begin() {
  *data_ = Data();
  data_->begun = true;
  data_->begin_ns = frame_.report.t_ns;
  data_->sample_ns = imu_.any() ? imu_.counts().last_ns : INT64_MIN;
  keep_pixels();
}

void RestDetector::keep_pixels() {
  data_->seen = 0;
  for (int t = 0; t < frame_.match_count() && data_->seen < kMaxPixels; ++t) {
    const Match& match = frame_.match(t);
    if (match.status == MatchStatus::kInlier || match.status == MatchStatus::kNew)
      seen_[data_->seen++] = {match.id, match.measured};
  }
}

/// Welford's running mean and sum of squares.
void RestDetector::add(const ImuSample& sample) {
  const Vec3 value[2] = {Vec3(sample.gyro[0], sample.gyro[1], sample.gyro[2]),
                         Vec3(sample.accel[0], sample.accel[1], sample.accel[2])};
  ++data_->count;
  data_->sample_ns = sample.t_ns;
  for (int k = 0; k < 2; ++k) {
    const Vec3 before = value[k] - data_->mean[k];
    data_->mean[k] += before / static_cast<Scalar>(data_->count);
    data_->square[k] += before.dot(value[k] - data_->mean[k]);
  }
}

/// Both sensors scatter as their densities say, at the rate at which samples come, and the specific force is about gravity.
bool RestDetector::is_quiet() const {
  if (data_->count < kMinSamples || imu_.counts().median_ns <= 0) return false;
  const Scalar rate = Scalar(1) / static_cast<Scalar>(seconds(imu_.counts().median_ns));
  const ImuNoise& noise = settings_.unit.noise;
  const auto quiet = [&](int k, Scalar density) {
    const Scalar expected = 3 * static_cast<Scalar>(data_->count - 1) * density * density * rate;
    return data_->square[k] < kMaxScatter * kMaxScatter * expected;
  };
  const Scalar off = std::abs(data_->mean[1].norm() - settings_.unit.gravity);
  return quiet(0, noise.gyro_density) && quiet(1, noise.accel_density) && data_->mean[0].norm() < kMaxGyroBias &&
         off < kMaxGravityError;
}

/// Whether the picture has moved since the second began, by the similarity that fits its features: their mean displacement, and
/// rotation and expansion about their mean, which average the noise of single pixels. Too few of them say nothing, which counts as moved.
///
///   d = t + A c,   A = (a -b; b a)      c, d from the means of before and of the displacement
bool RestDetector::has_moved() {
  int count = 0;
  Vec2 centre = Vec2::Zero(), shift = Vec2::Zero();
  Scalar turned = 0, grown = 0, spread = 0;
  const auto for_each = [&](auto f) {
    for (int t = 0; t < frame_.match_count(); ++t) {
      const Match& match = frame_.match(t);
      if (match.status != MatchStatus::kInlier) continue;
      for (int i = 0; i < data_->seen; ++i)
        if (seen_[i].id == match.id) f(seen_[i].pixel, Vec2(match.measured - seen_[i].pixel));
    }
  };
  for_each([&](const Vec2& pixel, const Vec2& d) {
    ++count;
    centre += pixel;
    shift += d;
  });
  if (count < kMinPixels) return true;
  centre /= static_cast<Scalar>(count);
  shift /= static_cast<Scalar>(count);
  for_each([&](const Vec2& pixel, const Vec2& d) {
    const Vec2 c = pixel - centre, e = d - shift;
    grown += c.dot(e);
    turned += c.x() * e.y() - c.y() * e.x();
    spread += c.squaredNorm();
  });
  const Scalar by_shape = (grown * grown + turned * turned) / (spread * static_cast<Scalar>(count));
  data_->motion2 = shift.squaredNorm() + by_shape;
  return !(data_->motion2 < kMaxMotionPx * kMaxMotionPx);
}

}  // namespace pf
