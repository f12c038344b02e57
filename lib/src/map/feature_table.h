#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/eigen.h"

/// Table of features: what is kept about each beside its block in the filter.

namespace pf {

struct Feature {
  std::uint32_t id = 0;           ///< never used twice
  std::uint32_t external_id = 0;  ///< the caller's id of an observed feature; of the target, the index of the point
  int slot = -1;                  ///< block in the filter; -1: this entry is free
  bool is_target = false;
  bool has_appearance = false;
  int observations = 0;  ///< frames in which it was an inlier
  int attempts = 0;      ///< frames in which it was searched for
  int failures = 0;      ///< attempts since it was last an inlier
  int rejections = 0;    ///< of these failures, matches that were outliers
  std::int64_t last_seen_ns = 0;
};

class FeatureTable {
 public:
  bool layout(Arena& arena, int capacity) {
    feature_ = arena.take<Feature>(static_cast<std::size_t>(capacity));
    capacity_ = capacity;
    return arena.ok();
  }
  void init() {
    clear();
    next_id_ = 1;
  }
  /// Removes all features. Their ids are not used again.
  void clear() {
    for (int i = 0; i < capacity_; ++i) feature_[i] = Feature();
    count_ = 0;
  }

  int capacity() const { return capacity_; }
  int count() const { return count_; }
  bool used(int i) const { return feature_[i].slot >= 0; }
  Feature& operator[](int i) { return feature_[i]; }
  const Feature& operator[](int i) const { return feature_[i]; }

  /// Entry of a new feature, or -1 when the table is full.
  int add(int slot) {
    for (int i = 0; i < capacity_; ++i) {
      if (used(i)) continue;
      feature_[i] = Feature();
      feature_[i].slot = slot;
      feature_[i].id = next_id_++;
      ++count_;
      return i;
    }
    return -1;
  }
  void remove(int i) {
    feature_[i] = Feature();
    --count_;
  }

  /// Whether a feature may be evicted: not one of the target, nor one that was seen since this time.
  bool may_evict(int i, std::int64_t not_since_ns) const {
    return used(i) && !feature_[i].is_target && feature_[i].last_seen_ns < not_since_ns;
  }
  /// The feature to evict first: longest unseen, not of the target and not seen since this time; -1 if there is none.
  int least_useful(std::int64_t not_since_ns) const {
    int worst = -1;
    for (int i = 0; i < capacity_; ++i) {
      if (!may_evict(i, not_since_ns)) continue;
      if (worst < 0 || feature_[i].last_seen_ns < feature_[worst].last_seen_ns) worst = i;
    }
    return worst;
  }

 private:
  Feature* feature_ = nullptr;
  int capacity_ = 0;
  int count_ = 0;
  std::uint32_t next_id_ = 1;
};

}  // namespace pf
