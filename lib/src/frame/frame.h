#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/eigen.h"
#include "base/elapsed.h"
#include "geometry/similarity.h"
#include "model/state.h"

/// Results of the current frame: its report, its correction of the map and its matches, as the caller reads them.

namespace pf {

class Archive;
class FeatureTable;

/// With the numbers of pf_match_status_t.
enum class MatchStatus : std::uint8_t { kInlier = 1, kOutlier = 2, kMissed = 3, kNew = 4 };

/// One feature in one frame.
struct Match {
  int feature;  ///< entry in the feature table; -1 once it has left the map, or if it could not be predicted
  std::uint32_t id;
  MatchStatus status;
  BlockKind kind;
  bool searched;  ///< the image was compared with its appearance
  bool agrees;    ///< with the pose that was weighed last
  Vec2 predicted;
  Mat2 innovation;
  Vec2 measured;
  Scalar nis;  ///< normalised innovation squared of the match alone, two degrees of freedom; zero without a match
};

enum Stage { kPyramid, kPredict, kSearch, kGate, kUpdate, kMap, kImu, kPatch, kTemplate, kAdjust, kStageCount };

/// Why a frame was not tracked. With the numbers of pf_frame_reason_t.
enum class FrameReason : int {
  kNone = 0,
  kNothingInView = 1,
  kFewFound = 2,
  kDisagree = 3,
  kImprobable = 4,
  kUncertain = 5,
  kLens = 6
};

/// Normalised innovation squared of the pose alone, Filter::pose_nis.
struct PoseNis {
  double nis = 0;
  double of_rotation = 0;  ///< the rotation's part, with half the degrees of freedom
  int dof = 0;
};

struct FrameReport {
  std::int64_t t_ns = 0;
  int frames = 0;
  int duplicates = 0;  ///< images since the beginning that repeated the one before
  int repairs = 0;     ///< frames since the beginning in which P had to be repaired
  int attempts = 0, matches = 0, inliers = 0, new_features = 0, evicted = 0;
  int consensus = 0;  ///< inliers of the best of the poses about which the frame was searched
  FrameReason reason = FrameReason::kNone;
  double nis = 0;
  int nis_dof = 0;
  PoseNis pose;             ///< only with an inertial unit
  int templates = 0;        ///< templates that were updated in this frame
  float template_area = 0;  ///< sum of their masks, in parts of a template
  std::int64_t stage_ns[kStageCount] = {};
};

/// How far poses that were given out before have moved in a frame, about the camera: what was at p is at T.of(p), what had the rotation R
/// has T.q R.
struct MapCorrection {
  Similarity T;
  std::uint32_t from_map_id =
      0;  ///< of the map that they were given out in, where it goes on under another id; 0: it does not

  void add(const Similarity& more) { T = more.after(T); }
  /// The map goes on under another id than this one.
  void rename(std::uint32_t before) { from_map_id = from_map_id != 0 ? from_map_id : before; }
};

class Frame {
 public:
  FrameReport report;
  MapCorrection correction;
  int masked = 0;  ///< of the image, as fixed to it, since the beginning [1/1000]

  /// Notes the inliers of a pose about which the frame was searched; the largest count stays in the report.
  void note_consensus(int inliers) { report.consensus = inliers > report.consensus ? inliers : report.consensus; }

  bool layout(Arena& arena, int capacity) {
    match_ = arena.take<Match>(static_cast<std::size_t>(capacity));
    capacity_ = capacity;
    return arena.ok();
  }
  void init() {
    report = FrameReport();
    correction = MapCorrection();
    masked = 0;
    count_ = 0;
  }
  /// Begins the next frame: an empty report with its time and its number, no correction and no matches.
  void begin(std::int64_t t_ns) {
    const int frames = report.frames;
    const int duplicates = report.duplicates, repairs = report.repairs;
    report = FrameReport();
    correction = MapCorrection();
    report.t_ns = t_ns;
    report.frames = frames;
    report.duplicates = duplicates;
    report.repairs = repairs;
    count_frame(&report.frames);
    count_ = 0;
  }

  /// Begins the same frame once more: as begin() left it, but keeps the times of its stages, and how the map has moved.
  void begin_again() {
    const FrameReport before = report;
    const MapCorrection moved = correction;
    begin(before.t_ns);
    correction = moved;
    report.frames = before.frames;
    for (int i = 0; i < kStageCount; ++i) report.stage_ns[i] = before.stage_ns[i];
  }

  int match_count() const { return count_; }
  bool full() const { return count_ >= capacity_; }
  Match& match(int i) { return match_[i]; }
  const Match& match(int i) const { return match_[i]; }
  const Match* matches() const { return match_; }
  /// Adds a match and returns its index. Only while not full().
  int add(const Match& match) {
    match_[count_] = match;
    return count_++;
  }
  /// Before a pose is weighed: no match agrees with it yet.
  void forget_agreement() {
    for (int i = 0; i < count_; ++i) match_[i].agrees = false;
  }
  /// Detaches the matches of a feature that has left the map. They stay readable.
  void forget(int feature) {
    for (int i = 0; i < count_; ++i)
      if (match_[i].feature == feature) match_[i].feature = -1;
  }
  void forget_all() {
    for (int i = 0; i < count_; ++i) match_[i].feature = -1;
  }
  /// Removes this frame's matches, so that the same features can be searched for again.
  void forget_searches() {
    count_ = 0;
    report.attempts = report.matches = 0;
  }

  void carry(Archive& archive, const FeatureTable& features);  ///< base/archive.h

 private:
  Match* match_ = nullptr;
  int capacity_ = 0;
  int count_ = 0;
};

}  // namespace pf
