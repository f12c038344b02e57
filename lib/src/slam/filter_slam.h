#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/status.h"
#include "filter/filter.h"
#include "map/map.h"
#include "map/plane_search.h"
#include "slam/body_motion.h"
#include "slam/frame.h"
#include "slam/settings.h"
#include "slam/start.h"
#include "slam/tracking_state.h"
#include "track/quad_refine.h"
#include "track/tracker.h"
#include "window/start_bundle.h"

/// The order of work of one frame with the filter as back end (Gee 2007), and nothing else:
///
///   predict -> where to look -> search -> agreement -> update -> (what is left: again) -> housekeeping -> new features
///
/// Two doors lead in: images, and observations that something else has matched.

namespace pf {

struct PixelObservation {
  std::uint32_t track;
  Vec2 pixel;
  Scalar sigma_px;
};

/// How many features hang on a plane.
struct PlanePoints {
  int folded = 0;  ///< fixed ones among them
  int fixed = 0;
};

class FilterSlam {
 public:
  FilterSlam() = default;
  FilterSlam(const FilterSlam&) = delete;  // its parts refer to each other
  FilterSlam& operator=(const FilterSlam&) = delete;

  /// Whether a start at this target can be made with these capacities.
  bool fits(const Target& target) const;

  bool layout(Arena& arena, const Settings& settings);
  void init(const Settings& settings);

  Status start_from_target(const Target& target);
  Status start_from_pose(const KnownBody& known);
  void withdraw_target() { map_.target_withdrawn = true; }
  void push_steering(const Vec3& dv_C, const Vec3& dw_C) { motion_.push_steering(dv_C, dw_C); }

  Status push_frame(const ImageView& image, std::int64_t t_ns);
  Status push_observations(const PixelObservation* observations, int count, std::int64_t t_ns);

  /// A rectangle is found in images; there is no such thing in a list of observations.
  bool takes_images_only() const { return target_.kind == TargetKind::kRectangle; }
  /// Where the observation door leaves what came in: as many as the map and a frame can hold together.
  PixelObservation* observation_inbox() { return inbox_; }
  int observation_inbox_size() const { return settings_.max_features + settings_.max_observations; }

  const Settings& settings() const { return settings_; }
  const Filter& filter() const { return filter_; }
  const FeatureTable& features() const { return map_.features; }
  const PlaneTable& planes() const { return map_.planes; }
  /// Outline of a plane (entry of the table) in the coordinates of its frame, from the points that hang on it.
  PlanePoints outline(int plane_entry, PlaneOutline* outline) const;
  const FrameReport& report() const { return frame_.report; }
  const Match* tracks() const { return frame_.matches(); }
  int track_count() const { return frame_.match_count(); }
  SlamState state() const { return tracking_.state(); }
  bool has_pose() const { return tracking_.has_pose(); }
  bool used() const { return frame_.report.frames > 0; }
  std::int64_t last_ns() const { return frame_.report.t_ns; }

  /// Body and pose covariance (6x6) predicted to a later time.
  void predict_pose(std::int64_t t_ns, Body* body, Mat6* covariance) const {
    motion_.predict_pose(last_ns(), t_ns, body, covariance);
  }

 private:
  // filter_slam.cpp
  bool begin_frame(std::int64_t t_ns);
  Status end_frame();
  void begin_at(const Body& body, const Scalar* covariance);
  void begin_from_knowledge();
  void start_over();
  void begin_filter();

  // housekeeping.cpp
  void convert_what_is_linear();
  void drop_what_fails();
  void drop(const int* entries, int count);
  bool make_room(int rows);
  bool make_room_at(int* anchor);
  Scalar usual_inverse_depth() const;
  int begin_feature(int anchor, const Vec2& pixel, const Mat2& noise);
  void add_target_points();

  // planes_in_map.cpp
  void tend_planes();
  void unfold_misfits();
  bool is_in_reach(int plane_entry, const Vec3& p_W) const;
  bool lies_on(int plane, int slot) const;
  void fold_into(int plane_entry);
  void support(int plane_entry, int slot);
  void fix_on(int plane_entry);
  void loosen(int plane_slot, int children);
  bool is_settled(int entry) const;
  bool is_certain(int entry, Mat3* covariance) const;

  // planes_come_and_go.cpp
  void discover_plane();
  bool same_plane(int slot, int other) const;
  void merge_into(int plane_entry);
  void settle_frame(int plane_entry);
  void dissolve(int plane_entry);
  void dissolve_weak();

  // taking_in.cpp
  bool take_in(int first, int count);
  Mat2 expected_innovation(Observation* o) const;
  void take_in_again_where_bent(int first, int count);

  // observation_door.cpp
  int find_track(std::uint32_t track) const;

  // frame_door.cpp
  int list_visible();
  void predict_pixels(int first, int count);
  int search(int first, int count);
  void measure(int first, int count);
  Scalar widest_ellipse(int count) const;
  void begin_features_in_image();

  // start_at_target.cpp
  bool start_in_image();
  bool sight_rectangle(PoseEstimate* pose, Vec2* pixel) const;
  bool sight_points(PoseEstimate* pose, Vec2* pixel) const;

  // start_without_target.cpp
  void begin_record();
  void record_frame();
  Vec2 at_frame_time(int slot, const Vec2& measured) const;
  void move_rays_to_frame_time();
  void restart_from_record();
  void release(int entry);

  Settings settings_;
  Filter filter_;
  Map map_;
  Frame frame_;
  TrackingState tracking_;
  BodyMotion motion_{settings_, filter_};
  PlaneCandidate* candidate_ = nullptr;  ///< max_features
  int* candidate_entry_ = nullptr;       ///< feature table entry of each
  std::uint32_t random_ = 1;
  SparseRows scale_;  ///< picks the log scale out of an error, where planes are tended to
  Tracker tracker_;
  Target target_;
  QuadWorkspace quad_workspace_;
  KnownBody known_body_;
  StartRecord record_;
  StartBundle bundle_;
  StartProgress start_;
  Quat base_q_WC_ = Quat::Identity();  ///< the record's frame 0 in W
  Vec3 base_p_W_ = Vec3::Zero();
  std::int64_t record_begin_ns_ = 0;
  Scalar start_covariance_[Body::kMaxDim * Body::kMaxDim] = {};  ///< of the body at the first frame
  Observation* observation_ = nullptr;                           ///< max_observations
  int* entry_ = nullptr;                                         ///< feature table entry of each observation
  unsigned char* keep_ = nullptr;                                ///< of each observation: taken in
  int* track_of_ = nullptr;                                      ///< and its track
  int* scratch_ = nullptr;                                       ///< max_features
  PixelObservation* inbox_ = nullptr;
};

}  // namespace pf
