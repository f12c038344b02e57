#include "slam/relocaliser.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "geometry/so3.h"
#include "slam/agreement.h"
#include "slam/consensus.h"
#include "slam/tracking_state.h"

namespace pf {
namespace {

constexpr Scalar kLogFalseRecovery = Scalar(-13.8);  ///< ln 1e-6: of agreements that chance makes in one frame
constexpr int kTrials = 40;
constexpr int kAgreeingFrames =
    3;  ///< in a row, from anywhere: frames in random order are neighbours by chance in one of twenty
constexpr Scalar kProposalSigma = Scalar(0.004);  ///< of a match against the map, of the image's width
constexpr Scalar kDepthKnown = Scalar(0.3);       ///< relative sigma of an inverse depth that may place the camera
constexpr Scalar kNarrow = Scalar(0.1);           ///< [rad] sigma of a rotation up to which the prediction is searched
constexpr float kRecognised = 0.5f;               ///< correlation of a view that may be the same
constexpr Scalar kAboutView = Scalar(0.1);        ///< sigma of the pose about a recognised view [rad], and in depths
constexpr Scalar kAboutProposal = Scalar(0.03);   ///< likewise about the last frame's proposal
constexpr Scalar kMapSigma = Scalar(2);           ///< [px] of a point of the map in a search about such a pose
constexpr int kColumns = 4, kRows = 3, kLeastCells = 4;  ///< cells of the image, and how many the agreement must reach
constexpr Scalar kProposalTurn =
    Scalar(0.035);  ///< [rad] by which proposals of two frames may differ beside the motion
constexpr Scalar kProposalShift = Scalar(0.05);  ///< and in depths
constexpr Scalar kMotionGate = Scalar(3);        ///< sigmas of the velocities
constexpr Scalar kFastTurn = Scalar(1);          ///< [rad/s] sigma of a hand's rotation at most
constexpr Scalar kFastShift = Scalar(0.5);       ///< [depths/s] likewise

}  // namespace

bool Relocaliser::layout(Arena& arena, int max_observations) {
  const std::size_t count = static_cast<std::size_t>(max_observations);
  views_.layout(arena);
  searched_px2_ = arena.take<Scalar>(count);
  place_ = arena.take<Vec3>(count);
  pixel_ = arena.take<Vec2>(count);
  return arena.ok();
}

void Relocaliser::init() {
  data_ = Data();
  views_.init();
}

void Relocaliser::remember_view(Scalar median_depth) {
  data_.depth = median_depth;
  views_.keep_if_new(filter_.state().body.q_WC, filter_.state().body.p_W);
}

/// The prediction is good enough to be linear about it.
bool Relocaliser::is_narrow() const {
  Scalar variance = 0;
  for (int i = 0; i < 3; ++i) variance += filter_.variance(Body::kTheta + i);
  return variance < kNarrow * kNarrow;
}

/// Where to search: about the last frame's proposal; where little is known of the rotation, about a view that looks like this picture; else
/// about the prediction. False: the prediction, with its covariance.
bool Relocaliser::choose_search_pose(Body* pose, Mat6* P) const {
  *P = Mat6::Zero();
  Scalar rotation = kAboutProposal, position = kAboutProposal;
  if (data_.proposal.frames > 0) {
    pose->q_WC = data_.proposal.q_WC;
    pose->p_W = data_.proposal.p_W;
    position *= data_.proposal.depth;
  } else {
    if (is_narrow()) return false;
    const Recognition place = views_.recognise(settings_.camera);
    if (place.score < kRecognised) return false;
    pose->q_WC = place.q_WC;
    pose->p_W = place.p_W;
    rotation = kAboutView;
    position = kAboutView * data_.depth;
  }
  for (int i = 0; i < 3; ++i) {
    (*P)(i, i) = rotation * rotation;
    (*P)(3 + i, 3 + i) = position * position;
  }
  return true;
}

/// After a short gap: what agrees about the prediction, depths that are hardly known among it.
void Relocaliser::recover_nearby(int count) {
  const int found = images_.search(0, count);
  const bool before = data_.agreed_nearby;
  data_.agreed_nearby = false;
  if (found < TrackingState::kMinInliers) return;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
  for (int i = 0; i < found; ++i) searched_px2_[i] = images_.searched_area(i);
  update_.begin(0, found);
  const int inliers = find_inliers(filter_, update_.observations(), found, settings_.gate, update_.keep());
  const Agreement agreement = find_agreement(filter_, update_.observations(), searched_px2_, found,
                                             frame_.report.attempts, settings_.gate, kTrials, update_.keep(), nullptr);
  if (inliers < TrackingState::kMinInliers || !(agreement.log_false < kLogFalseRecovery) || !is_spread(found)) return;
  data_.agreed_nearby = true;
  if (!before) return;
  mark_matches(found);
  update_.apply(0, found);
  data_.agreed_nearby = false;
}

void Relocaliser::mark_matches(int found) {
  for (int i = 0; i < found; ++i) {
    Match& match = frame_.match(update_.candidate(i).match);
    match.status = update_.keep()[i] != 0 ? MatchStatus::kInlier : MatchStatus::kOutlier;
    match.nis = squared_distance(match.measured - update_.observation(i).predicted,
                                 filter_.innovation_block(i, i) + update_.observation(i).R_gate);
  }
}

/// Searches everywhere where the pose may be, and takes in what agrees when the frame before agreed as well.
void Relocaliser::recover(std::int64_t dt_ns) {
  const Body estimate = filter_.state().body;
  Body about = estimate;
  Mat6 P;
  const bool elsewhere = choose_search_pose(&about, &P);
  if (elsewhere) {
    filter_.body().q_WC = about.q_WC;
    filter_.body().p_W = about.p_W;
  } else {
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) P(i, j) = filter_.covariance()(i, j);
  }
  const int count = images_.list_visible();
  images_.predict_pixels(0, count);
  if (!elsewhere && is_narrow()) {
    recover_nearby(count);
    return;
  }
  // Features whose depth is hardly known say nothing about where the camera is.
  int listed = 0;
  for (int i = 0; i < count; ++i) {
    const int slot = map_.features[update_.candidate(i).feature].slot;
    const Block& block = filter_.state().block[slot];
    if (update_.observation(i).block < 0) continue;
    if (block.kind == BlockKind::kInverseDepth) {
      const Scalar rho = block.inverse_depth().rho;
      if (!(rho > 0) || filter_.block_variance(slot, 2) > kDepthKnown * kDepthKnown * rho * rho) continue;
    }
    if (i != listed) {
      update_.swap(listed, i);
    }
    if (elsewhere) {
      const PixelMeasurement& o = update_.observation(listed);
      const int columns = o.H.columns();
      Mat26 J;
      for (int a = 0; a < 2; ++a)
        for (int c = 0; c < 6; ++c) J(a, c) = o.H.h[a * columns + c];
      const Mat26 JP = J.lazyProduct(P);
      frame_.match(update_.candidate(listed).match).innovation =
          JP.lazyProduct(J.transpose()) + Mat2::Identity() * (kMapSigma * kMapSigma);
    }
    ++listed;
  }
  int found = images_.search(0, listed);
  filter_.body() = estimate;
  const int before = data_.proposal.frames;
  data_.proposal.frames = 0;
  if (found < TrackingState::kMinInliers) return;

  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
  for (int i = 0; i < found; ++i) {
    place_[i] = filter_.point(map_.features[update_.candidate(i).feature].slot);
    pixel_[i] = update_.observation(i).measured;
    searched_px2_[i] = images_.searched_area(i);
  }
  Body pose = about;
  const Scalar sigma = std::max(Scalar(1), kProposalSigma * static_cast<Scalar>(settings_.camera.width));
  if (pf::propose_pose(settings_.camera, P, place_, pixel_, found, sigma, &pose) < TrackingState::kMinInliers) return;
  const int attempts = frame_.report.attempts;
  found = linearise_at(pose, found);
  if (found < TrackingState::kMinInliers) return;
  update_.begin(0, found);
  const Agreement agreement = find_agreement(filter_, update_.observations(), searched_px2_, found, attempts,
                                             settings_.gate, kTrials, nullptr, update_.keep());
  if (agreement.inliers < TrackingState::kMinInliers || !(agreement.log_false < kLogFalseRecovery) || !is_spread(found))
    return;
  const Scalar depth = median_depth(pose, found);
  const bool follows = before > 0 && depth > 0 && follows_last_proposal(pose, depth, dt_ns);
  data_.proposal.frames = follows ? before + 1 : 1;
  data_.proposal.q_WC = pose.q_WC;
  data_.proposal.p_W = pose.p_W;
  data_.proposal.depth = depth;
  if (data_.proposal.frames < kAgreeingFrames) return;
  mark_matches(found);
  update_.apply(0, found);
  data_.proposal.frames = 0;
}

/// Predictions and Jacobians of the matches at a pose far from the estimate, as the estimate sees them:
///
///   z ~ h(x_0) + H (x [-] x_0),   so that the prediction at the estimate is h(x_0) + H (x^ [-] x_0)
///
/// Returns how many can be seen from there; those move to the front.
int Relocaliser::linearise_at(const Body& pose, int found) {
  const Body estimate = filter_.state().body;
  Vec6 e;
  e << log_so3(estimate.q_WC * pose.q_WC.conjugate()), estimate.p_W - pose.p_W;
  filter_.body().q_WC = pose.q_WC;
  filter_.body().p_W = pose.p_W;
  int seen = 0;
  for (int i = 0; i < found; ++i) {
    PixelMeasurement& o = update_.observation(i);
    const Vec2 measured = o.measured;
    const Mat2 R = o.R_gate - o.second_order;
    const Mat2 correlated = o.R_update - o.R_gate;  // beyond one match by itself
    const int slot = o.block;
    if (!filter_.predict_pixel(settings_.camera, slot, &o)) continue;
    const int columns = o.H.columns();
    for (int a = 0; a < 2; ++a)
      for (int c = 0; c < 6; ++c) o.predicted(a) += o.H.h[a * columns + c] * e(c);
    o.measured = measured;
    o.set_noise(R);
    // The product of an uncertain baseline and an uncertain depth is gone where the baseline is proposed.
    if (is_planar(filter_.state().block[slot].kind)) o.set_noise(R + o.second_order);
    o.R_update += correlated;
    if (seen != i) {
      update_.swap(seen, i);
      std::swap(searched_px2_[seen], searched_px2_[i]);
    }
    ++seen;
  }
  filter_.body() = estimate;
  return seen;
}

/// Whether the camera can have come here from the last frame's proposal.
bool Relocaliser::follows_last_proposal(const Body& pose, Scalar depth, std::int64_t dt_ns) const {
  const Scalar dt = static_cast<Scalar>(static_cast<double>(dt_ns) * 1e-9);
  const Body& body = filter_.state().body;
  Scalar turn = kProposalTurn, shift = kProposalShift * depth;
  if (filter_.state().body_dim == Body::kMaxDim) {
    Scalar v = 0, w = 0;
    for (int i = 0; i < 3; ++i) {
      v += filter_.variance(Body::kVelocity + i);
      w += filter_.variance(Body::kRate + i);
    }
    turn += (kMotionGate * std::min(std::sqrt(w), kFastTurn) + body.w_C.norm()) * dt;
    shift += (kMotionGate * std::min(std::sqrt(v), kFastShift * depth) + body.v_W.norm()) * dt;
  } else {
    turn += kMotionGate * settings_.motion_noise.angular * std::sqrt(3 * dt);
    shift += kMotionGate * settings_.motion_noise.linear * std::sqrt(3 * dt);
  }
  return log_so3(pose.q_WC * data_.proposal.q_WC.conjugate()).norm() < turn &&
         (pose.p_W - data_.proposal.p_W).norm() < shift;
}

/// Not in one corner only.
bool Relocaliser::is_spread(int found) const {
  bool cell[kRows][kColumns] = {};
  int cells = 0;
  for (int i = 0; i < found; ++i) {
    if (update_.keep()[i] == 0) continue;
    const Vec2& z = update_.observation(i).measured;
    const int column = std::clamp(static_cast<int>(z.x()) * kColumns / settings_.camera.width, 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(z.y()) * kRows / settings_.camera.height, 0, kRows - 1);
    cells += cell[row][column] ? 0 : 1;
    cell[row][column] = true;
  }
  return cells >= kLeastCells;
}

Scalar Relocaliser::median_depth(const Body& pose, int found) const {
  constexpr int kMost = 256;
  Scalar depth[kMost];
  int count = 0;
  const Vec3 forward = pose.q_WC.toRotationMatrix().col(2);
  for (int i = 0; i < found && count < kMost; ++i)
    if (update_.keep()[i] != 0)
      depth[count++] = forward.dot(filter_.point(map_.features[update_.candidate(i).feature].slot) - pose.p_W);
  if (count == 0) return 0;
  std::nth_element(depth, depth + count / 2, depth + count);
  return depth[count / 2];
}

}  // namespace pf
