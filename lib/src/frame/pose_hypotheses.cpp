#include "frame/pose_hypotheses.h"

#include <cmath>

#include "frame/tuning.h"

namespace pf {
namespace {

/// -1: it is the only one.
int nearest_searched(const Frame& frame, int of) {
  int nearest = -1;
  Scalar least = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    if (t == of || !frame.match(t).searched) continue;
    const Scalar distance2 = (frame.match(t).predicted - frame.match(of).predicted).squaredNorm();
    if (nearest >= 0 && !(distance2 < least)) continue;
    nearest = t;
    least = distance2;
  }
  return nearest;
}

}  // namespace

PoseHypothesis PoseHypothesis::about(const Quat& q_WC, const Vec3& p_W, Scalar rotation, Scalar position) {
  PoseHypothesis out;
  out.q_WC = q_WC;
  out.p_W = p_W;
  for (int i = 0; i < 3; ++i) {
    out.P(i, i) = rotation * rotation;
    out.P(3 + i, 3 + i) = position * position;
  }
  return out;
}

bool find_elsewhere(const PoseProposal& last, const ViewMemory& views, const Pyramid& image, const Camera& lens,
                    Scalar depth, PoseHypothesis* out) {
  using namespace tuning::relocaliser;
  if (last.is_set) {
    *out = PoseHypothesis::about(last.q_WC, last.p_W, kAboutProposal, kAboutProposal * last.depth);
    return true;
  }
  const Recognition place = views.recognise(image, lens);
  if (place.score < kMinRecognition) return false;
  *out = PoseHypothesis::about(place.q_WC, place.p_W, kAboutView, kAboutView * depth);
  return true;
}

void note_zoom(const ZoomFit& fit, const Settings& settings, PoseConsensus* consensus) {
  if (!(fit.variance > Scalar(0))) return;
  const LensPrior& lens = settings.lens;
  const bool is_uncertain = lens.rows.count > 0 && lens.rows.parameter[0] == 0;
  const Scalar known = is_uncertain ? std::sqrt(lens.variance[0]) / settings.camera.fx : Scalar(0);
  consensus->log_zoom = fit.log_ratio;
  consensus->lens_evidence = lens_evidence(fit.log_ratio, fit.variance, known);
}

int paired_inliers(const Frame& frame) {
  int paired = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    if (!frame.match(t).agrees || !frame.match(t).searched) continue;
    const int nearest = nearest_searched(frame, t);
    if (nearest >= 0 && frame.match(nearest).agrees) ++paired;
  }
  return paired;
}

void note_paired(const Frame& frame, const FindShare& share, PoseConsensus* consensus) {
  if (share.is_less(consensus->searched, consensus->inliers)) consensus->paired = paired_inliers(frame);
}

Scalar PoseHypotheses::evidence(const PoseConsensus& consensus) const {
  return belief_.evidence(consensus) - std::log(static_cast<Scalar>(tried_));
}

bool PoseHypotheses::accepts(const PoseConsensus& consensus, Scalar log_odds, bool is_last) {
  return consensus.inliers >= settings_.min_inliers && (is_last || PoseBelief::is_settled(log_odds)) &&
         belief_.may_use(log_odds, consensus);
}

}  // namespace pf
