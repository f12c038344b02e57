#pragma once

#include <algorithm>
#include <cstdint>

#include "base/arena.h"
#include "filter/block_filter.h"
#include "filter/estimated_rows.h"
#include "filter/fold_rule.h"
#include "filter/gauge_prior.h"
#include "filter/inertial_motion.h"
#include "filter/motion.h"
#include "filter/transport.h"
#include "geometry/camera.h"
#include "model/state.h"

/// The extended Kalman filter: holds the state and the covariance, and alone changes them together. Gee 2007, section 3.1.

namespace pf {

struct FilterCapacity {
  int state_dim;
  int features;
  int observations;  ///< in one update
  int planes;
};

class Filter {
 public:
  bool layout(Arena& arena, const FilterCapacity& capacity);
  void init(const Kernels* kernels, const BodyLayout& layout, bool keep_gauge);
  /// Noise of a folded point's pixel: surfaces of planes added from now on are uneven by this much [m].
  void set_roughness(Scalar roughness) { roughness_ = roughness; }
  void keep_gauge(bool keep) { keep_gauge_ = keep; }
  bool keeps_gauge() const { return keep_gauge_; }
  /// Changes with each init(), after which slots that others keep are not valid.
  std::uint32_t generation() const { return generation_; }
  const State& state() const { return state_; }
  const BlockFilter& blocks() const { return blocks_; }
  /// P: the covariance of the state without what apart() holds.
  const Triangle& covariance() const { return blocks_.P(); }
  /// Covariance of gauge directions that is not in P.
  const GaugePrior& apart() const { return apart_; }
  /// J C J^T of a few rows and the whole covariance C.
  template <int kRows>
  Eigen::Matrix<Scalar, kRows, kRows> covariance_of(const Rows& J) const {
    Eigen::Matrix<Scalar, kRows, kRows> C = blocks_.covariance_of<kRows>(J);
    if (apart_.any()) C += apart_.covariance_of<kRows>(state_, J);
    return C;
  }
  /// The same for covariances that leave the library: a difference of numbers is known no better than their rounding,
  ///   C_rr >= epsilon sum_i h_ri^2 P_ii
  template <int kRows>
  Eigen::Matrix<Scalar, kRows, kRows> rounded_covariance_of(const Rows& J) const {
    Eigen::Matrix<Scalar, kRows, kRows> C = covariance_of<kRows>(J);
    for (int r = 0; r < kRows; ++r) C(r, r) = std::max(C(r, r), blocks_.rounding_of(J, r));
    return C;
  }
  Scalar variance_of(const Rows& row) const;          ///< of a single row
  void body_covariance(int rows, Scalar* out) const;  ///< of its first rows (rows x rows, row-major)
  /// Sets the mean of the body and leaves its covariance, where the mean comes from elsewhere (a restart).
  void set_mean(const Body& body) { state_.body = body; }

  /// Set the calibration and, where the layout has a lens, its prior; the unit's mounting. Before any block is added.
  void set_lens(const Camera& camera, const LensPrior& prior);
  void set_mounting(const Mounting& mounting) { state_.mounting = mounting; }
  /// From now on the samples of the inertial unit measure the scale. With `start`, the map has been one up to scale and is scaled first.
  void set_metric();
  void set_metric(const struct MovingSolution& start, const Mounting& mounting);
  bool is_metric() const { return state_.metric; }
  /// Sets whether samples move the body from now on (State::uses_samples). init() keeps it.
  void use_samples(bool use) { state_.uses_samples = use; }
  bool uses_samples() const { return state_.uses_samples; }
  /// Whether updates consider the lens, even where the layout has it as estimated.
  void consider_lens(bool only_considered);
  const Camera& lens() const { return state_.lens; }  ///< present calibration

  /// Sets the parts of the body that move and the unit's constants, with their covariance (over the unit rows, row-major) and, with J_lens,
  /// their dependence on the lens (null: none). Only while nothing in the map depends on the body.
  void set_body(const Body& body, const Scalar* covariance, const Scalar* J_lens = nullptr);

  /// From now on something measures the place or the scale of W, so what is apart goes into P and stays there. (The speed of a start does
  /// so for kSpeedTells updates; by then process noise has replaced it.)
  void tell_gauge();

  /// Sets the entry of the map's table that a block belongs to.
  void set_owner(int slot, int owner) { state_.set_owner(slot, owner); }

  // --- predict
  /// Predicts the body: mean, F and Q of the transition.
  void predict(const Transition& transition);

  // --- augment; -1 where there is no room
  /// Adds an anchor where the camera is, or a reference camera.
  int add_anchor(int reference = kBodyBlock);
  /// Adds a copy of the camera at the frame's time, fully correlated with it.
  int add_reference_camera();
  /// Adds a camera that was known before, independent of all else; covariance is of (theta, p).
  int add_known_camera(const Quat& q_WK, const Vec3& p_WK, const Mat6& covariance);
  /// Adds a point x_K that a reference camera K knows, as an inverse depth of an anchor at K, with K's errors beside its own covariance.
  int add_point_of(int camera, int anchor, const Vec3& x_K, const Mat3& covariance_K);
  /// Adds a patch whose corners a reference camera has seen with this covariance [px^2]; it is removed with that camera.
  int add_patch(int camera, const PatchMeasurement::Matrix& covariance);
  /// tau: when the pixel's row was read out, from the frame's time [s].
  int add_inverse_depth(int anchor, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px, Scalar rho,
                        Scalar sigma_rho, Scalar tau = Scalar(0));
  /// The same at the distance of a plane along the pixel's ray (with its correlations), with an independent relative_sigma of that
  /// distance. -1 too where the ray does not meet it.
  int add_before_plane(int anchor, int plane, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px,
                       Scalar relative_sigma, Scalar tau = Scalar(0));
  int add_point(const Vec3& p_W, const Mat3& covariance);
  /// Adds a point of a plane, where the ray of a pixel meets it. -1 too where the ray does not meet it.
  int add_plane_point(int plane, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px, Scalar tau = Scalar(0));

  /// Adds a plane through 3-D points, about the frame of their fit, with the fit's Jacobian (Gee 2007, eq 3 and 8) and the noise of a rough
  /// surface. Folds no point.
  int add_plane(const PlaneFit& fit, const int* slots, int count, Scalar roughness);
  /// Adds a plane known beforehand, independent of all else. covariance is of (a, b, h) about the frame; roughness is of its surface [m].
  /// apart: until join_planes_apart no measurement uses it, and it does not constrain the gauge.
  int add_known_plane(const PlaneFrame& frame, const Mat3& covariance, Scalar roughness, bool apart = false);
  /// Multiplies the map by `scale` about pivot; planes that are apart become planes like all others.
  void join_planes_apart(Scalar scale, const Vec3& pivot);
  /// Adds this variance to the log scale, with pivot as the place that does not depend on it.
  void open_scale(Scalar variance, const Vec3& pivot) { apart_.add_scale(variance, pivot); }

  // --- transform
  /// Converts an inverse depth to a 3-D point, in its slot; the anchor is removed with its last child.
  void convert_to_point(int slot);

  static constexpr int kMaxFolded = BlockFilter::kBatch;  ///< in one call

  /// 3-D points, or points of another plane, become points of this one: those that pass the gate are conditioned together on a distance of
  /// zero, which is then dropped. folded[i]: whether the i-th was. Returns how many.
  int fold(int plane, const int* slots, int count, const FoldRule& rule, unsigned char* folded);
  /// Distance of a feature from a plane, and its variance without roughness. False where it has no place.
  bool distance(int plane, int slot, Scalar* d, Scalar* variance) const;
  /// Variance of the distance of an exactly known point from a plane.
  Scalar plane_variance(int plane, const Vec3& p_W) const;
  /// Unfolds: a planar feature becomes a 3-D point, sigma_normal [m] more uncertain along the plane's normal. False without room.
  bool unfold(int slot, Scalar sigma_normal);
  /// Gathers S = H P H^T (without noise) of the distances of features from a plane, measured as zero. Then innovation_of<1> of blocks()
  /// is valid until the state changes. Every feature must have a place.
  void begin_distances(int plane, const int* slots, int count, Scalar noise, DistanceMeasurement* z);
  /// The same, and moves the point along its ray from the camera by `along` [m], known to sigma_along [m]: its pixel stays.
  bool unfold_along(int slot, Scalar along, Scalar sigma_along);
  /// Moves a plane without a point group to (a, b, h) = x, and adds Q to its covariance. Its points follow along their rays, with the
  /// plane's uncertainty and sigma_uv [m] each. False, with nothing changed, where Q is no covariance.
  bool slide_plane(int plane, const Vec3& x, const Mat3& Q, Scalar sigma_uv);
  /// Adds Q to the covariance of a plane's (a, b, h).
  void inflate(int plane, const Mat3& Q);
  /// Inflates a plane that was wrong by sigma of (a, b, h), seen from the camera, and all else through its correlation with it.
  void forget_through(int plane, const Vec3& sigma);
  /// Multiplies the covariance of a wrong known plane's prior by (1 + widening). False where the prior is tighter than the plane.
  bool forget_prior(int plane, const Mat3& prior, Scalar widening);
  void add_noise(const Rows& U, const Scalar* Q) { blocks_.add_noise(U, Q); }  ///< P += Uᵀ Q U, Q symmetric
  /// Undoes what an update by this row contributed: its variance grows by `variance`, and that of all else by its share.
  void forget_row(const Rows& row, Scalar variance) { blocks_.inflate_along(row, variance); }
  /// Moves the plane, and the points that depend on it directly, to another frame. False, with nothing changed, when the frame is too
  /// slanted or a point group depends on the plane.
  bool reanchor(int plane, const PlaneFrame& frame);

  /// Largest variance of a plane point's coordinates [m^2] against the other points of its plane: in the point group, or
  /// where there is none yet against the similarity that fits `members` (slots of plane points of the same plane, it among them).
  Scalar variance_in_group(int slot, const int* members, int num_members) const;
  /// Fixes plane points of one plane in its point group, which is made from `members` where there is none. False, with nothing changed,
  /// without room.
  bool fix(const int* slots, int count, FixForm form, const int* members, int num_members);
  /// Releases a fixed point, which becomes a plane point again. False without room.
  bool release(int slot);
  /// The point group of a plane, or -1.
  int group_of(int plane) const;

  // --- remove; anchors, point groups and reference cameras that nothing needs any more go with them, all in one pass
  void remove(const int* slots, int count);
  /// Pins a block for a use outside of the state: it stays without children.
  void pin(int slot) { ++state_.block[slot].pins; }
  /// Removes a pin; the block is removed where nothing else needs it.
  void unpin(int slot);

  // --- update
  /// Prediction, Jacobian and columns of a feature's pixel; false when it does not project.
  bool predict_pixel(const Camera& lens, int slot, PixelMeasurement* out) const;
  /// Prediction, Jacobian and columns of the corners of a patch on a plane, whose corners were at these pixels of its reference camera.
  /// False where one of them does not project.
  bool predict_patch(const Camera& lens, int patch, int plane, const Vec2* reference_px, PatchMeasurement* out) const;
  Mat2 innovation(const PixelMeasurement& pixel) const;  ///< H P H^T of one pixel, without noise
  /// Gathers H P and S = H P H^T (without noise) of measurements. Then innovation_block is valid until the state changes.
  void begin_update(const Measurement* z, int count) { blocks_.project(z, count); }
  void begin_update(const PixelMeasurement* z, int count) { begin_update(views_of(z, count), count); }
  Mat2 innovation_block(int i, int j) const { return blocks_.innovation2(i, j); }
  /// Scratch of i + 1 numbers for all but the last row of S: the caller's between begin_update and finish_update.
  Scalar* scratch_row(int i) { return blocks_.scratch_row(i); }
  /// Updates the state with the chosen measurements (keep[i] != 0; null: all). False, with the state and P unchanged, when S cannot be
  /// factored or the step is no number. *nis (may be null) gets the normalised innovation squared.
  bool finish_update(const Measurement* z, int count, const unsigned char* keep, Scalar* nis,
                     EstimatedRows rows = EstimatedRows()) {
    if (!solve_update(z, count, keep, nis, rows)) return false;
    commit_update();
    return true;
  }
  bool finish_update(const PixelMeasurement* z, int count, const unsigned char* keep, Scalar* nis,
                     EstimatedRows rows = EstimatedRows()) {
    return finish_update(views_of(z, count), count, keep, nis, rows);
  }
  /// finish_update in two steps. The first changes neither the state nor P, and the second need not follow; solved_step: dx, all rows.
  bool solve_update(const Measurement* z, int count, const unsigned char* keep, Scalar* nis,
                    EstimatedRows rows = EstimatedRows());
  bool solve_update(const PixelMeasurement* z, int count, const unsigned char* keep, Scalar* nis,
                    EstimatedRows rows = EstimatedRows()) {
    return solve_update(views_of(z, count), count, keep, nis, rows);
  }
  const Scalar* solved_step() const { return blocks_.step(); }
  void commit_update();
  /// The same of a measurement that is linearised at another pose, near, and predicted for the estimate: h(near) + H (x [-] near). Before
  /// it, what the pose shares with the gauge moves to near, so that H N = 0 there too.
  bool finish_update_near(const Measurement& z, const Body& near, Scalar* nis);
  /// The part of the innovation that concerns the pose, of the update that solve_update has just solved. With L L^T = S + R, A = L^-1 H P_x
  /// and y = L^-1 (measured - predicted), x the rows of the pose,
  ///
  ///   nis = y^T A (A^T A)^-1 A^T y = e^T (P_before - P_after)^-1 e,   e the correction of the pose
  ///
  /// chi-square with six degrees of freedom; *of_rotation: the rotation's, with three. False where it does not constrain all of the pose.
  bool pose_nis(Scalar* nis, Scalar* of_rotation) const;

  /// Predicted reading of a unit at rest, with R = R_WB and g = gravity R_WG e_z:
  ///
  ///   z = (b_g, b_a - R^T g),   e_bg,   e_ba - R^T [g]x theta - R^T E d          E = gravity (-R_WG e_y, R_WG e_x)
  ///
  /// and where they are estimated, by axes theta + R_WC mu for theta, by intrinsics D_a^-1 R^T for R^T. A rotation of W changes neither.
  void predict_still(const StillReading& still, Scalar gravity, StillMeasurement* out) const;
  /// Whether the NIS of the reading is within max_nis; updates with it where `commit` is set.
  bool take_still(const StillReading& still, Scalar gravity, Scalar max_nis, bool commit);

  /// Pose (q_KC, p_KC) of the camera in the frame of a reference camera K, and the covariance of its (theta, p), in K (relative_pose.h).
  void motion_since(int camera, Quat* q_KC, Vec3* p_KC, Mat6* covariance) const;
  /// Covariance of a feature's place, to first order.
  Mat3 covariance3(int slot) const;
  /// The best known of a few log lengths, as a row over the state: l N = (0, 0, 1). False, and no parts, where there is none.
  bool scale_row(ScaleRow* row) const;
  /// Covariance of a 3-D point against the camera's position and the world's scale: of f - p - (f - p) l e.
  Mat3 relative_covariance(int slot, const ScaleRow& l) const;
  /// Standard deviation of an inverse depth against the world's scale: of e_rho + rho l e.
  Scalar relative_sigma_rho(int slot, const ScaleRow& l) const;
  /// A feature's place in W; an inverse depth that is not positive counts as far away.
  Vec3 point(int slot) const;
  int first_row(int slot) const { return blocks_.first(slot); }  ///< of a block in the covariance
  Scalar variance(int row) const { return covariance()(row, row); }
  /// Of the rotation of the unit's axes, a mean over them [rad^2]; 0 where it is not estimated.
  Scalar unit_turn_variance() const;
  Scalar block_variance(int slot, int offset) const { return variance(first_row(slot) + offset); }
  int dim() const { return blocks_.dim(); }
  int room() const { return blocks_.room(); }  ///< rows that are still free

  // --- soundness: finite, bounded, and no variance below zero
  /// Checks a part of P, which depends on turn, and repairs it where it is no covariance.
  BlockFilter::Repair repair(int turn) { return blocks_.repair(turn); }
  bool body_is_sound() const;
  /// The same for a block and the anchor that it depends on.
  bool block_is_sound(int slot) const;
  void carry(Archive& archive);  ///< base/archive.h
 private:
  int take_slot(BlockKind kind);
  const Measurement* views_of(const PixelMeasurement* z, int count);
  bool is_step(const Scalar* dx) const;
  RowRange considered(EstimatedRows rows) const;
  void begin_move();
  void end_move();
  // pixels.cpp
  Mat2 parallax_noise(const struct CameraAt& camera, int slot, Scalar rho, const Mat23& J_z_anchor) const;
  bool predict_at(const Camera& lens, const CameraAt& camera, int slot, PixelMeasurement* out, Mat26* J_camera) const;
  // scale_row.cpp
  bool scale_candidate(int slot, int* places, ScaleRow* row) const;
  // apart.cpp
  bool keeps_apart() const;
  void end_update_apart(const ScaleRow& l);
  Scalar replace_scale(Scalar left);
  void scale_map(Scalar s, Scalar* factor);
  void translate(const Vec3& t);
  // planes.cpp
  void place_plane(int slot, const PlaneFrame& frame, Scalar roughness);
  Scalar bend_of_distance(int plane, int slot, const ScaleRow& l) const;
  bool condition_on(int plane, const int* slots, int count, Scalar noise, const unsigned char* folded);
  void predict_distance(int plane, const struct Place& at, DistanceMeasurement* out) const;
  // point_groups.cpp
  int add_group(int plane, const int* members, int count);

  State state_;
  BlockFilter blocks_;
  Transport transport_;
  GaugePrior apart_;
  bool keep_gauge_ = true;
  int told_updates_ = 0;                        ///< for which something still measures the gauge; -1: for good
  std::uint32_t generation_ = 0, cameras_ = 0;  ///< copies of the camera so far
  Scalar roughness_ = 0;
  Measurement* view_ = nullptr;  ///< observations; of pixels
  Vec3* place_ = nullptr;        ///< slots; of points, scratch of scale_row
  int* place_slot_ = nullptr;    ///< slots; whose
};

}  // namespace pf
