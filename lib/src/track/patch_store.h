#pragma once

#include <cstdint>

#include "base/arena.h"
#include "track/patch_wait.h"
#include "vision/plane_patch.h"

/// The patches on planes that are followed: pixels, and what is known of each beside its block in the filter. Rows hold no pointers.

namespace pf {

class Archive;

/// Result for a patch in the last frame. With the numbers of pf_match_status_t, one for a patch that was not searched for, and
/// PF_PATCH_WAITING: found, and no measurement yet.
enum class PatchStatus : std::uint8_t { kUnseen = 0, kInlier = 1, kOutlier = 2, kMissed = 3, kNew = 4, kWaiting = 5 };

struct StoredPatch {
  using Mat8 = Eigen::Matrix<Scalar, 8, 8>;

  std::uint32_t id = 0;     ///< never used twice; 0: this entry is free
  std::uint32_t plane = 0;  ///< id of the plane that it lies on; while it waits, of the wall that was seen there, or 0
  int camera = -1;          ///< block of its reference camera
  int block = -1;           ///< of what its reference's noise did to the corners; -1: it was not found again yet
  int frames = 0;           ///< in which it was measured
  int born = 0;             ///< number of the frame in which it began
  std::int16_t failures = 0;    ///< in a row: it should have been there and was not
  std::int16_t rejections = 0;  ///< in a row: it was found elsewhere
  std::int16_t through = 0;     ///< in a row: it was measured through a wall that should hide it
  PatchStatus status = PatchStatus::kUnseen;
  std::int64_t last_seen_ns = 0;
  float gain = 1, offset = 0;  ///< of light against the reference
  float weight = 0;            ///< share of its pixels that fitted in the last frame
  Vec2 reference_px[4];        ///< where its reference camera saw the corners at the frame's own time
  Vec2 corner[4];              ///< where they are: measured, or else predicted
  Mat8 covariance;             ///< of corners that were measured [px^2]
  PatchWait wait;              ///< for the plane that it lies on
  Vec3 early_plane =
      Vec3::Zero();  ///< n / d in its reference camera, from an early view while it waits; zero: not known
  Vec3 last_plane = Vec3::Zero();  ///< the same from the last frame in which it waited and had parallax
  PlanePatch pixels;

  bool is_proven() const { return block >= 0; }
  /// In the last frame.
  bool was_found() const {
    return status == PatchStatus::kInlier || status == PatchStatus::kNew || status == PatchStatus::kWaiting;
  }
};
static_assert(sizeof(StoredPatch) <= 24 * 1024, "what the header says that a patch takes");

class PatchStore {
 public:
  bool layout(Arena& arena, int capacity) {
    entry_ = arena.take<StoredPatch>(static_cast<std::size_t>(capacity));
    capacity_ = capacity;
    return arena.ok();
  }
  void init() {
    next_id_ = 1;
    clear();
  }
  /// Removes all patches. Their ids are not used again.
  void clear() {
    for (int i = 0; i < capacity_; ++i) entry_[i].id = 0;
  }

  int capacity() const { return capacity_; }
  bool used(int i) const { return entry_[i].id != 0; }
  StoredPatch& operator[](int i) { return entry_[i]; }
  const StoredPatch& operator[](int i) const { return entry_[i]; }

  int count() const {
    int n = 0;
    for (int i = 0; i < capacity_; ++i) n += used(i);
    return n;
  }
  /// A free entry, or -1.
  int find_free() const {
    for (int i = 0; i < capacity_; ++i)
      if (!used(i)) return i;
    return -1;
  }
  /// Begins a patch whose pixels lie in this free entry already.
  StoredPatch& begin(int i);
  void remove(int i) { entry_[i].id = 0; }

  /// Number of reference cameras of the patches.
  int cameras() const;
  int patches_of(int camera) const {
    int n = 0;
    for (int i = 0; i < capacity_; ++i) n += used(i) && entry_[i].camera == camera;
    return n;
  }

  /// base/archive.h. slots: of the blocks that it names; max_side: of a patch [px].
  void carry(Archive& archive, int slots, int max_side);

 private:
  StoredPatch* entry_ = nullptr;
  int capacity_ = 0;
  std::uint32_t next_id_ = 1;
};

}  // namespace pf
