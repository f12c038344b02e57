#pragma once

#include <cstdint>

#include "base/arena.h"
#include "bundle/bundle.h"
#include "vision/appearance.h"

/// Table of keyframes: poses whose images the map was measured in, with the pixels of its points.

namespace pf {

class Archive;
class FeatureTable;

struct Keyframe {
  int number = 0;  ///< counted from 1 in the order of time; 0: this entry is free
  std::int64_t t_ns = 0;
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
  Mat6 covariance =
      Mat6::Zero();  ///< of (theta, p) in W when it was the newest; it was hardly adjusted against W's origin since
  /// With which pixels of points without a depth were taken to the frame's time (window_rows.h): velocities, and a depth, 0: none were.
  /// matches_by_motion: those of points that were seen before too, and not the new points' alone.
  Vec3 v_W = Vec3::Zero(), w_C = Vec3::Zero();
  Scalar row_depth = 0;
  bool matches_by_motion = false;

  CameraView view() const { return {q_WC, p_W}; }
};

class KeyframeTable {
 public:
  bool layout(Arena& arena, int capacity, int points) {
    keyframe_ = arena.take<Keyframe>(static_cast<std::size_t>(capacity));
    pixel_ = arena.take<BundlePixel>(static_cast<std::size_t>(capacity) * static_cast<std::size_t>(points));
    capacity_ = capacity;
    points_ = points;
    return arena.ok();
  }
  void init() {
    last_number_ = 0;
    begin_map();
  }
  /// Removes all keyframes. The next one is the map's first; numbers are not used again.
  void begin_map() {
    for (int k = 0; k < capacity_; ++k) keyframe_[k] = Keyframe();
    count_ = 0;
    newest_ = -1;
    first_number_ = last_number_ + 1;
  }

  static constexpr std::int64_t kLongAgo = INT64_MIN;  ///< time of a keyframe that has come back

  int capacity() const { return capacity_; }
  int count() const { return count_; }
  /// Number of keyframes that there have been.
  int numbered() const { return last_number_; }
  /// The one with which the map began, and its W.
  bool is_first(int k) const { return keyframe_[k].number == first_number_; }
  /// W began elsewhere: in a map that was saved, or in another one that this one was joined to.
  bool began_elsewhere() const { return first_number_ == kNone; }
  void set_began_elsewhere() { first_number_ = kNone; }
  /// Entry of the newest one, or -1.
  int newest() const { return newest_; }
  bool used(int k) const { return keyframe_[k].number > 0; }
  /// Entry of the one with this number, or -1.
  int entry_of(int number) const {
    for (int k = 0; k < capacity_; ++k)
      if (used(k) && keyframe_[k].number == number) return k;
    return -1;
  }
  Keyframe& operator[](int k) { return keyframe_[k]; }
  const Keyframe& operator[](int k) const { return keyframe_[k]; }

  /// Entry of a new keyframe that has seen no point yet, or -1 when the table is full.
  int add(std::int64_t t_ns, const Quat& q_WC, const Vec3& p_W) {
    for (int k = 0; k < capacity_; ++k) {
      if (used(k)) continue;
      keyframe_[k] = {++last_number_, t_ns, q_WC, p_W, Mat6::Zero()};
      for (int i = 0; i < points_; ++i) pixels(k)[i].seen = false;
      ++count_;
      return newest_ = k;
    }
    return -1;
  }
  /// A keyframe that has been removed comes back, and has seen no point yet. Its number is none of those in the table, and at most that of
  /// the last one. Entry, or -1 when the table is full.
  int add_again(int number, const Quat& q_WC, const Vec3& p_W, const Mat6& covariance) {
    const int newest = newest_, last_number = last_number_;
    const int k = add(kLongAgo, q_WC, p_W);
    if (k < 0) return -1;
    last_number_ = last_number;
    keyframe_[k].number = number;
    keyframe_[k].covariance = covariance;
    if (newest >= 0 && keyframe_[newest].number > number) newest_ = newest;
    return k;
  }
  /// The next one is counted from here on.
  void number_from(int last) {
    last_number_ = last;
    set_began_elsewhere();
  }
  void remove(int k) {
    keyframe_[k] = Keyframe();
    --count_;
  }

  /// Pixels of all points, by their row.
  BundlePixel* pixels(int k) { return pixel_ + k * points_; }
  const BundlePixel* pixels(int k) const { return pixel_ + k * points_; }
  void set_pixel(int k, int point, const Vec2& pixel) {
    pixels(k)[point] = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), true};
  }
  /// The row of a point is free for another one.
  void forget_point(int point) {
    for (int k = 0; k < capacity_; ++k) pixels(k)[point].seen = false;
  }

  void carry(Archive& archive, const FeatureTable& features);  ///< base/archive.h

 private:
  Keyframe* keyframe_ = nullptr;
  BundlePixel* pixel_ = nullptr;  ///< capacity_ x points_
  int capacity_ = 0, points_ = 0;
  static constexpr int kNone = -1;
  int count_ = 0, last_number_ = 0, first_number_ = 1;
  int newest_ = -1;
};

}  // namespace pf
