#pragma once

#include "frame/followed_view.h"
#include "frame/image_search.h"
#include "frame/noise_model.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/planes/planes.h"
#include "keyframe_slam/tracking/motion.h"
#include "keyframe_slam/tracking/pose.h"
#include "keyframe_slam/tracking/tuning.h"

/// Measures an image with the window's map: where its points should be, where they are, and the pose that this says.

namespace pf {

/// Where a point is expected.
struct ExpectedPixel {
  Vec2 pixel;
  Mat2 spread;  ///< by pose and depth, without the noise of a match [px^2]
};

class KeyframeTracking {
 public:
  KeyframeTracking(const Settings& settings, KeyframeMap& map, const KeyframePlanes& planes, Frame& frame,
                   KeyframeMotion& motion, NoiseModel& noise)
      : settings_(settings), map_(map), planes_(planes), frame_(frame), motion_(motion), noise_(noise) {}

  bool layout(Arena& arena);
  void init();
  bool begin_frame(const ImageView& image) {
    listed_ = found_ = 0;
    return search_.begin_frame(image);
  }

  /// Finds points with a depth about the predicted pose, and corrects the body by the pose that they say; then finds those without. Where
  /// those with a depth say none, all say it together.
  void measure(Scalar median_depth);
  /// So few points have a depth that those without must help.
  bool is_young() const { return map_.placed() < tuning::keyframe_tracking::kYoung; }
  /// Finds all points about the predicted pose, and corrects the body by the pose that they say together: a point without a depth says
  /// where the camera is but for a shift along its epipolar line.
  void measure_young(Scalar median_depth);
  /// The same about another pose than the predicted one. Changes nothing but the frame's matches. Returns the number of inliers, and the
  /// pose with its information.
  int measure_about(const PosePrior& about, CameraPose* pose, Mat6* information);
  /// Corrects the body by a pose that measure_about() returned, and says which matches agree with it.
  void correct(const CameraPose& pose, const Mat6& information);
  /// Finds points without a depth about where they were last, as if the camera had only turned. Returns how many were found.
  int follow(Scalar depth);
  /// Pose that all of the first `found` matches that were followed say together, about a rotation that is known; where it fails, that.
  void settle_followed(int found, const Quat& q_WC, const Vec3& p_W, Scalar depth);
  /// The body before or after the frame's matches, as it is now.
  PosePrior now() const;
  /// Where a match would be at the frame's time, by the body's velocities. depth: of a point without one.
  Vec2 at_frame_time(const Match& match, Scalar depth) const;
  /// The same by how far its pixel has moved since it was last accepted, where velocities are not known yet.
  Vec2 followed_at_frame_time(const Match& match) const;
  /// After a frame that supported its pose: the next one may be followed from it.
  void keep_view();
  /// The map is given up, and with it all poses.
  void forget_view() { followed_.init(); }
  /// Updates the noise model with the residuals of this frame's inliers.
  void learn_noise();
  /// Updates masks and normals of templates with this frame's inliers.
  void learn_templates();
  /// Counts a found feature as an inlier. The match's pixel is its last one from now on.
  void accept(Match* match) { accept(match, at_frame_time(*match, Scalar(1))); }
  /// The same with the pixel at the frame's time.
  void accept(Match* match, const Vec2& pixel);

  /// Within which a match supports a pose [px].
  Scalar bound_px() const;
  ImageSearch& search() { return search_; }
  const Tracker& tracker() const { return search_.tracker(); }
  const Camera& camera() const { return map_.camera(); }

 private:
  bool is_wide(const Mat2& innovation) const;
  bool begin_following();
  bool aim(int i, SearchTask* task) const;
  bool expect_placed(int i, const PosePrior& at, ExpectedPixel* out) const;
  bool has_rows() const { return map_.camera().readout != Scalar(0); }
  bool expect_row(const PosePrior& at, const Vec3& m, Scalar w, ExpectedPixel* out) const;
  Vec2 match_at_frame_time(const Match& match, const PosePrior& at, Scalar depth) const;
  bool follow_velocities(const CameraPose& pose, const Mat6& information, KeyframeMotion* after) const;
  void correct_by_rows(const PosePrior& before, CameraPose pose, Mat6 information);
  Vec2 image_motion(const Match& match) const;
  bool is_seen_again(const Match& match) const;
  void correct_first_pixel(const Match& match);
  bool expect_unplaced(int i, const PosePrior& at, Scalar depth, ExpectedPixel* out) const;
  SearchTask task_of(int i, const PosePrior& at, Scalar depth) const;
  int list(const PosePrior& at, bool placed, Scalar depth);
  void expect(int first, int count, const PosePrior& at);
  int search_for(int first, int count, const PosePrior& at, Scalar depth);
  void make_pose_match(int c, const PosePrior& prior, Scalar depth, int shared);
  int find_pose(int found, const PosePrior& prior, CameraPose* pose, Mat6* information);
  bool is_believed(int inliers, int found, Scalar shares) const;
  static Scalar chance_share(Scalar area, Scalar searched);
  Scalar agreeing_area(int c) const;
  bool most_agree(int found) const;
  void measure_all(Scalar median_depth);
  void fit_all(int found, const PosePrior& prior, Scalar median_depth);
  void mark(int found, const PosePrior& at);
  bool apply(const CameraPose& pose, Mat6 information, PosePrior* now);
  void measure_unplaced(Scalar depth);
  bool is_inside(const Vec2& pixel) const;

  const Settings& settings_;
  KeyframeMap& map_;
  const KeyframePlanes& planes_;
  Frame& frame_;
  KeyframeMotion& motion_;
  NoiseModel& noise_;
  ImageSearch search_;
  KeyframePose pose_;
  FollowedView followed_;
  bool is_following_ = false;  ///< searches go about the followed view's pixels

  /// A point that is searched for.
  struct Candidate {
    int match;        ///< of the frame
    Mat2 noise;       ///< of its match
    Scalar searched;  ///< area [px^2]
  };
  Candidate* candidate_ = nullptr;  ///< one for each point
  int listed_ = 0;                  ///< with a depth
  int found_ = 0;                   ///< of these, at the front
};

}  // namespace pf
