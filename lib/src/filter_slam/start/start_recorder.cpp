#include "filter_slam/start/start_recorder.h"

#include "filter/frame_pixels.h"
#include "filter_slam/start/record_check.h"
#include "frame/start/tuning.h"
#include "frame/tuning.h"
#include "model/camera_at.h"

namespace pf {

bool StartRecorder::layout(Arena& arena) {
  return record_.layout(arena, adjusts_lens() ? settings_.lens.rows.shape_count() : 0);
}

void StartRecorder::begin_record() {
  if (!is_recording() || !record_.empty()) return;
  if (beginning_.known().given) beginning_.note_covariance();
  const CameraAt camera = camera_at(filter_.state(), Scalar(0));
  record_.begin_record(camera.q_WC, camera.p_W, frame_.report.t_ns);
  if (adjusts_lens() && !progress().checking)
    record_.free_lens(settings_.camera, shape_prior(settings_.lens), settings_.camera);
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    Vec3 ray_C;
    if (match.feature < 0) continue;
    if (match.status != MatchStatus::kNew && !map_.features[match.feature].is_target) continue;
    if (unproject(settings_.camera, match.measured, &ray_C)) record_.add_feature(match.id, ray_C);
  }
  if (progress().checking && record_.empty()) init();
}

bool StartRecorder::record_frame(bool has_image) {
  if (!is_recording() || record_.empty() || frame_.report.inliers < settings_.min_inliers) return false;
  add_pixels();
  const bool first = !progress().depth_known, checks = progress().checking;
  const StartOutcome outcome = record_.solve(settings_.camera, tuning::noise::kSearchSigma, settings_.start_depth);
  switch (outcome) {
    case StartOutcome::kWait:
      if (progress().pending()) bound_baseline();
      break;
    case StartOutcome::kSolved:
    case StartOutcome::kSettled:
      if (checks) return check_depths(outcome == StartOutcome::kSettled);
      if (first) record_.log(outcome, settings_.hooks);
      first ? restart(Scalar(1)) : restart_known(Scalar(1));
      break;
    case StartOutcome::kTooFew:
      if (first && !checks) begin_anew(has_image);  // only rotation so far, or too few features in view
      break;
    case StartOutcome::kStill:
      stay_at_base();
      record_.log(outcome, settings_.hooks);
      break;
  }
  return false;
}

/// The gate judges by the depths of the last solution. What it rejects, the next one may explain, and that adjustment is robust.
void StartRecorder::add_pixels() {
  const CameraAt camera = camera_at(filter_.state(), Scalar(0));
  record_.begin_frame(camera.q_WC, camera.p_W, frame_.report.t_ns);
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature < 0 || (match.status != MatchStatus::kInlier && match.status != MatchStatus::kOutlier)) continue;
    record_.add_pixel(settings_.camera, match.id,
                      at_frame_time(filter_, map_.features[match.feature].slot, match.measured));
  }
}

/// After a start at a target, or at a known pose before walls: where the record has other depths than the filter, the filter has converged
/// to a wrong explanation of the first frames, and begins again with those of the record. Returns whether it did.
bool StartRecorder::check_depths(bool settled) {
  const bool by_walls = map_.planes.has_known();  // with a target there is no check beside them
  const Scalar unit =
      by_walls ? unit_by_walls(filter_, map_, record_) : unit_by_target(map_, target_.target(), record_);
  if (!(unit > Scalar(0))) {
    if (by_walls && settled) init();
    return false;
  }
  const bool agree = depths_agree(filter_, map_, record_, unit) && (!by_walls || motion_agrees(filter_, record_, unit));
  if (!agree) {
    settings_.hooks.say("first depths rejected by a record of ", record_.record().frames() + 1,
                        " frames: the map begins again ", by_walls ? "at the first pose" : "at the target",
                        " with depths of the record");
    restart_known(unit);
  }
  if (agree || settled) init();
  // Its points lie on walls of the plan. Until now the filter could not distinguish them from points before the walls.
  if (agree && by_walls) map_.planes.forget_refusals();
  return !agree;
}

/// The world stays, and a record begins with this frame. Features that were found in several frames begin again where they are now: where
/// most corners are never found again (speckles, leaves), a record of corners alone would run out of features before there is parallax.
void StartRecorder::begin_anew(bool has_image) {
  Vec2 proven[StartRecord::kMaxFeatures];
  int count = 0;
  for (int t = 0; has_image && t < frame_.match_count() && count < StartRecord::kMaxFeatures; ++t) {
    const Match& match = frame_.match(t);
    if (match.feature >= 0 && match.status == MatchStatus::kInlier &&
        map_.features[match.feature].observations >= tuning::filter_start::kProven)
      proven[count++] = Vec2(match.measured.array().round());
  }
  features_.drop_all();
  corners_.add_at(proven, count);
}

}  // namespace pf
