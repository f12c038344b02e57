#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/eigen.h"
#include "base/table_entries.h"

/// Table of features: the data of each beside its block in the filter.

namespace pf {

class Archive;

/// Running mean of a feature's normalised residuals, for their correlation in time.
struct ResidualTrace {
  float mean[2] = {0, 0};
  int frame = 0;  ///< number of the last frame with a residual; 0: none yet
};

/// Ordered by size, since there are as many as features.
struct Feature {
  std::int64_t last_seen_ns = 0;
  std::uint32_t id = 0;           ///< never used twice
  std::uint32_t external_id = 0;  ///< the caller's id of an observed feature; of the target, the index of the point
  int slot = -1;                  ///< block in the filter; -1: this entry is free
  int observations = 0;           ///< frames in which it was an inlier
  int attempts = 0;               ///< frames in which it was searched for
  float log_odds = 0;             ///< that it is a point of the scene (belief/feature_belief.h)
  ResidualTrace residuals;
  std::uint8_t rejections = 0;  ///< matches that were outliers, since it was last an inlier; up to 255
  bool is_target = false;
  bool has_appearance = false;
  bool began_by_wall = false;  ///< at the distance of a wall of the plan, which it may stand before
  bool on_trial = false;       ///< began on a plane that its own parallax does not confirm yet
  bool was_missed = false;     ///< no inlier when it was last searched for
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
  /// A feature that was here before comes back under its id, in place of the new one of an entry that add() has just given out.
  void come_back(int i, std::uint32_t id) {
    if (feature_[i].id + 1 == next_id_) --next_id_;
    feature_[i].id = id;
  }
  /// Ids up to this one are never given out.
  void reserve_ids(std::uint32_t last) {
    if (next_id_ <= last) next_id_ = last + 1;
  }
  void remove(int i) {
    feature_[i] = Feature();
    --count_;
  }

  /// Entry of the feature with this id, or -1.
  int entry_of(std::uint32_t id) const { return entry_with_id(*this, id); }
  /// Whether a feature may be evicted: not one of the target, nor one that was seen since this time.
  bool may_evict(int i, std::int64_t not_since_ns) const {
    return used(i) && !feature_[i].is_target && feature_[i].last_seen_ns < not_since_ns;
  }
  /// The feature to evict first: the least often measured class (proof()), among equals the longest unseen; -1 if there is none. Most new
  /// features are never measured again, and must not evict those that may come back into view.
  int least_useful(std::int64_t not_since_ns) const {
    int worst = -1;
    for (int i = 0; i < capacity_; ++i) {
      if (!may_evict(i, not_since_ns)) continue;
      if (worst < 0 || is_less_useful(feature_[i], feature_[worst])) worst = i;
    }
    return worst;
  }

  void carry(Archive& archive, int slots);  ///< base/archive.h; slots: of blocks

 private:
  /// Class of a feature by its measurements: 0 with fewer than kAgain, 1 with fewer than kProven, then one more for each doubling up to
  /// kMaxProof.
  static int proof(const Feature& feature) {
    constexpr int kAgain = 3, kProven = 10, kMaxProof = 80;  // frames
    if (feature.observations < kProven) return feature.observations < kAgain ? 0 : 1;
    int proof = 2;
    for (int frames = 2 * kProven; frames <= kMaxProof && feature.observations >= frames; frames *= 2) ++proof;
    return proof;
  }
  static bool is_less_useful(const Feature& a, const Feature& b) {
    return proof(a) != proof(b) ? proof(a) < proof(b) : a.last_seen_ns < b.last_seen_ns;
  }

  Feature* feature_ = nullptr;
  int capacity_ = 0;
  int count_ = 0;
  std::uint32_t next_id_ = 1;
};

}  // namespace pf
