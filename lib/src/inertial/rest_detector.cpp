#include "inertial/rest_detector.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/tuning.h"
#include "inertial/tuning.h"

namespace pf {

using namespace tuning::rest;

void RestDetector::layout(Arena& arena) {
  if (!settings_.inertial) return;
  seen_ = arena.take<Seen>(2 * kMaxPixels);
  data_ = arena.take<Data>(1);
}

bool RestDetector::note(bool seen, RestReading* rest) {
  const std::int64_t t_ns = frame_.report.t_ns;
  const bool has_pixels = data_->seen > 0;
  if (!data_->begun || !seen || (has_pixels && has_moved())) {
    begin(false);
    return false;
  }
  if (!has_pixels) keep_pixels();  // a map's first frame has none yet
  if (data_->anew && data_->seen > 0) {
    data_->anew = false;
    data_->mean_ns = t_ns;
  }
  for (int i = 0; i < imu_.held(); ++i)
    if (imu_[i].t_ns > data_->sample_ns) add(imu_[i]);
  if (data_->first > 0) compare_with_first();
  if (data_->rested > Scalar(0)) data_->rested = static_cast<Scalar>(seconds(elapsed_ns(data_->first_ns, t_ns)));
  if (!data_->anew && seconds(elapsed_ns(data_->mean_ns, t_ns)) < static_cast<double>(kTime)) keep_first();
  const Scalar T = static_cast<Scalar>(seconds(elapsed_ns(data_->begin_ns, t_ns)));
  if (T < kTime) return false;
  const bool at_rest = covers(data_->count, T) && is_quiet();
  if (at_rest) {
    const ImuNoise noise = noise_.now();
    const Scalar root = std::sqrt(T);
    rest->gyro = data_->mean[0];
    rest->accel = data_->mean[1];
    rest->sigma_gyro = noise.gyro_density / root + noise.gyro_walk * root;
    rest->sigma_accel = noise.accel_density / root + noise.accel_walk * root;
    // The motion that the image can exclude, at the depth that is assumed before any is known.
    const Scalar motion_px = std::max(std::sqrt(data_->motion2), kMinMotionPx);
    rest->sigma_speed = motion_px * settings_.start_depth / (settings_.camera.fx * T);
    rest->sigma_accel_bias = tuning::inertial::kAccelBias;
    rest->gravity = settings_.unit.gravity;
    data_->rest_begin_ns = data_->begin_ns;
  }
  const std::int64_t rest_begin_ns = data_->rest_begin_ns;
  begin(at_rest);
  data_->rest_begin_ns = rest_begin_ns;
  return at_rest;
}

/// The next second; samples before it have been seen. rests_on: the one before was at rest.
void RestDetector::begin(bool rests_on) {
  const Data before = *data_;
  *data_ = Data();
  data_->begun = true;
  data_->first_ns = data_->mean_ns = frame_.report.t_ns;
  if (rests_on) {
    data_->mean_ns = before.mean_ns;
    data_->first_ns = before.first_ns;
    data_->rested = static_cast<Scalar>(seconds(elapsed_ns(before.first_ns, frame_.report.t_ns)));
    data_->first = before.first;
    data_->motion_px = before.motion_px;
    for (int k = 0; k < 2; ++k) data_->scatter[k] = before.scatter[k];
  }
  data_->begin_ns = frame_.report.t_ns;
  data_->sample_ns = imu_.any() ? imu_.counts().last_ns : INT64_MIN;
  keep_pixels();
}

void RestDetector::keep_pixels() {
  data_->seen = 0;
  for (int t = 0; t < frame_.match_count() && data_->seen < kMaxPixels; ++t) {
    const Match& match = frame_.match(t);
    if (match.status == MatchStatus::kInlier || match.status == MatchStatus::kNew)
      seen_[data_->seen++] = {match.id, 1, match.measured};
  }
}

/// Running means over the first second, of the features that it began with.
void RestDetector::keep_first() {
  Seen* const first = seen_ + kMaxPixels;
  if (data_->first == 0)
    for (; data_->first < data_->seen; ++data_->first) first[data_->first] = seen_[data_->first];
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    for (int i = 0; i < data_->first && match.status == MatchStatus::kInlier; ++i)
      if (first[i].id == match.id)
        first[i].pixel += (match.measured - first[i].pixel) / static_cast<Scalar>(++first[i].count);
  }
}

/// How the picture has moved since the rest began; where it has, the rest is over.
void RestDetector::compare_with_first() {
  if (!(data_->rested > Scalar(0))) return;
  Vec4 motion;
  if (!motion_since(seen_ + kMaxPixels, data_->first, &motion)) return end_rest();
  data_->motion_px += kMeanGain * (motion - data_->motion_px);
  if (motion_px() > kMaxMeanMotionPx) end_rest();
}

void RestDetector::begin_pixels_anew() {
  data_->anew = true;
  data_->seen = data_->first = 0;
  data_->motion_px.setZero();
}

Scalar RestDetector::motion_px() const { return std::max(data_->motion_px.norm(), kMinMeanMotionPx); }

bool RestDetector::read_frame(Scalar dt, StillReading* still) const {
  if (!is_resting()) return false;
  Vec3 gyro = Vec3::Zero(), accel = Vec3::Zero();
  int count = 0;
  for (int i = 0; i < imu_.held(); ++i) {
    const ImuSample& sample = imu_[i];
    if (sample.t_ns <= data_->sample_ns) continue;
    gyro += Vec3(sample.gyro[0], sample.gyro[1], sample.gyro[2]);
    accel += Vec3(sample.accel[0], sample.accel[1], sample.accel[2]);
    ++count;
  }
  if (count == 0 || imu_.counts().median_ns <= 0 || !covers(count, dt)) return false;
  const ImuNoise noise = noise_.now();
  const Scalar n = static_cast<Scalar>(count);
  const Scalar root = std::sqrt(n * static_cast<Scalar>(seconds(imu_.counts().median_ns)));
  still->gyro = gyro / n;
  still->accel = accel / n;
  still->sigma_gyro = data_->scatter[0] * noise.gyro_density / root;
  still->sigma_accel = data_->scatter[1] * noise.accel_density / root;
  return true;
}

/// Whether so many samples cover a time T [s]. Nothing is known of what happened in a longer gap, or of a clock that jumped.
bool RestDetector::covers(int count, Scalar T) const {
  return T <=
         static_cast<Scalar>(count) * static_cast<Scalar>(seconds(imu_.counts().median_ns)) + tuning::imu::kMaxCoast;
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

/// True where both sensors scatter as their densities predict at the samples' rate, and the specific force is about gravity.
bool RestDetector::is_quiet() {
  if (data_->count < kMinSamples || imu_.counts().median_ns <= 0) return false;
  const Scalar rate = Scalar(1) / static_cast<Scalar>(seconds(imu_.counts().median_ns));
  const ImuNoise noise = noise_.now();
  const auto quiet = [&](int k, Scalar density) {
    const Scalar expected = 3 * static_cast<Scalar>(data_->count - 1) * density * density * rate;
    data_->scatter[k] = std::max(Scalar(1), std::sqrt(data_->square[k] / expected));
    return data_->scatter[k] < kMaxScatter;
  };
  const Scalar off = std::abs(data_->mean[1].norm() - settings_.unit.gravity);
  return quiet(0, noise.gyro_density) && quiet(1, noise.accel_density) && data_->mean[0].norm() < kMaxGyroBias &&
         off < kMaxGravityError;
}

/// Whether the image has moved since the second began. With too few features it counts as moved.
bool RestDetector::has_moved() {
  Vec4 motion_px;
  if (!motion_since(seen_, data_->seen, &motion_px)) return true;
  data_->motion2 = motion_px.squaredNorm();
  return !(data_->motion2 < kMaxMotionPx * kMaxMotionPx);
}

/// How the picture has moved, by the similarity that fits its features: their mean displacement, and rotation and expansion about their
/// mean as root mean square displacements, which average the noise of single pixels. What is farther than kMaxApartPx from the median
/// displacement moves by itself (a hand), and is left out. False where too few are left, or less than half.
///
///   d = t + A c,   A = (a -b; b a)      c, d from the means of before and of the displacement
bool RestDetector::motion_since(const Seen* before, int count_before, Vec4* motion_px) const {
  Vec2 c[kMaxPixels], d[kMaxPixels];
  Scalar sorted[kMaxPixels];
  int all = 0;
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.status != MatchStatus::kInlier) continue;
    for (int i = 0; i < count_before && all < kMaxPixels; ++i)
      if (before[i].id == match.id) {
        c[all] = before[i].pixel;
        d[all++] = match.measured - before[i].pixel;
      }
  }
  if (all < kMinPixels) return false;
  Vec2 median, centre = Vec2::Zero(), shift = Vec2::Zero();
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < all; ++i) sorted[i] = d[i](k);
    std::nth_element(sorted, sorted + all / 2, sorted + all);
    median(k) = sorted[all / 2];
  }
  int count = 0;
  for (int i = 0; i < all; ++i) {
    if ((d[i] - median).squaredNorm() > kMaxApartPx * kMaxApartPx) continue;
    c[count] = c[i];
    d[count++] = d[i];
  }
  if (count < kMinPixels || kMinTogether * count < all) return false;
  for (int i = 0; i < count; ++i) {
    centre += c[i] / static_cast<Scalar>(count);
    shift += d[i] / static_cast<Scalar>(count);
  }
  Scalar turned = 0, grown = 0, spread = 0;
  for (int i = 0; i < count; ++i) {
    const Vec2 r = c[i] - centre, e = d[i] - shift;
    grown += r.dot(e);
    turned += r.x() * e.y() - r.y() * e.x();
    spread += r.squaredNorm();
  }
  const Scalar root = std::sqrt(spread * static_cast<Scalar>(count));
  *motion_px << shift, grown / root, turned / root;
  return true;
}

}  // namespace pf
