#pragma once

#include <cstdint>

#include "base/arena.h"
#include "bundle/start_bundle.h"
#include "bundle/start_still.h"
#include "frame/tracking_state.h"
#include "vision/appearance.h"

/// Start with nothing known: records the pixels of the first frames until a bundle adjustment has a unique solution for them.
/// Knows no filter: it is given poses and pixels, and its solution is read from it.

namespace pf {

class Archive;

class StartWithoutTarget {
 public:
  /// lens_rows: of a lens that a start adjusts with its depths; 0: it is exact.
  bool layout(Arena& arena, int lens_rows = 0);
  /// No start is under way.
  void init();
  /// Begins a start.
  void begin() { data_.progress.recording = true; }
  /// Logs what solve() has just given: kStill for the first time since init(), or the first depths of a map.
  void log(StartOutcome outcome, const Hooks& hooks) const;
  /// Begins a record beside a filter that has a scale, to check its depths.
  void begin_check() { data_.progress.checking = true; }
  const StartProgress& progress() const { return data_.progress; }

  /// Begins the record with this frame. Its camera is the record's frame of reference.
  void begin_record(const Quat& q_WC, const Vec3& p_W, std::int64_t t_ns);
  /// The lens has this prior, and is adjusted with the depths of this record.
  void free_lens(const Camera& calibration, const LensPrior& prior, const Camera& now) {
    bundle_.free_lens(calibration, prior, now);
  }
  /// Adds a feature of the first frame, by its ray there.
  void add_feature(std::uint32_t id, const Vec3& ray_C);
  /// Adds a later frame with its estimated pose in W. Its pixels follow, corrected to the frame's time. held: it stays in
  /// the record, however many come.
  void begin_frame(const Quat& q_WC, const Vec3& p_W, std::int64_t t_ns, bool held = false);
  void add_pixel(const Camera& camera, std::uint32_t id, const Vec2& pixel);
  /// Tries to solve the record. kTooFew empties it, unless depths are known already; then the start is over, and so is a check. kStill
  /// comes only as long as no depths are known.
  StartOutcome solve(const Camera& camera, Scalar sigma_px, Scalar median_depth);

  /// Improves the last frame's pose while the depths are open (StartBundle::follow). rho: of each feature, about one.
  CameraView follow(const Camera& camera, Scalar sigma_px, Scalar depth, Scalar* rho);

  /// Covariance in W of the last frame's place about that of the record's first frame, as long as depths are open
  /// (StartBundle::baseline_covariance).
  bool baseline_covariance(const Camera& camera, Scalar sigma_px, Scalar median_depth, Mat3* covariance) const;

  bool empty() const { return record_.features() == 0; }
  const StartRecord& record() const { return record_; }
  const StartBundle& bundle() const { return bundle_; }
  /// Index of a feature in the record; -1 where it is not in it.
  int index_of(std::uint32_t id) const;
  /// Whether it has not moved since the record's first frame.
  bool stays(const Camera& camera, int index) const { return is_still(lens_of_record(camera), record_, index); }
  /// The record's first frame in W.
  const Quat& base_q_WC() const { return data_.base_q_WC; }
  const Vec3& base_p_W() const { return data_.base_p_W; }
  /// Frame k of the record in W.
  CameraView view(int k) const;
  std::int64_t begin_ns() const { return data_.begin_ns; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// What is kept between frames, beside the record and the last solution.
  struct Data {
    StartProgress progress;
    Quat base_q_WC = Quat::Identity();
    Vec3 base_p_W = Vec3::Zero();
    std::int64_t begin_ns = 0;
    int frame = 0;           ///< that pixels are added to
    std::int64_t t_ns = 0;   ///< its time
    bool is_second = false;  ///< it is the first one after the record's first frame
    int others = 0;          ///< matches of the frame that are of no feature of the record
    int stills = 0;          ///< how often a solution was kStill
    std::uint32_t id[StartRecord::kMaxFeatures] = {};
  };

  const Camera& lens_of_record(const Camera& camera) const {
    return bundle_.lens() != nullptr ? *bundle_.lens() : camera;
  }
  void move_ray(const Camera& camera, int index, const Vec2& pixel);

  Data data_;
  StartRecord record_;
  StartBundle bundle_;
};

}  // namespace pf
