#include "frame/kept/carry.h"

#include "frame/fit_warnings.h"
#include "frame/fixed_features.h"
#include "frame/followed_view.h"
#include "frame/frame.h"
#include "frame/frozen_camera.h"
#include "frame/image_search.h"
#include "frame/noise_model.h"
#include "frame/tracking_state.h"

namespace pf {
namespace {

void carry_report(Archive& archive, FrameReport& report) {
  auto& [t_ns, frames, duplicates, repairs, attempts, matches, inliers, new_features, evicted, consensus, reason, nis,
         nis_dof, pose, templates, template_area, stage_ns] = report;
  archive.any(t_ns, stage_ns);
  archive.counts(frames, duplicates, repairs, attempts, matches, inliers, new_features, evicted, consensus, nis_dof,
                 pose.dof, templates);
  archive.within(reason, 0, static_cast<int>(FrameReason::kLens));
  archive.numbers(nis, pose.nis, pose.of_rotation, template_area);
}

}  // namespace

void Frame::carry(Archive& archive, const FeatureTable& features) {
  carry_report(archive, report);
  archive.numbers(correction.T.q, correction.T.t, correction.T.s);
  archive.any(correction.from_map_id);
  archive.within(masked, 0, 1000);
  archive.within(count_, 0, capacity_);
  for (int i = 0; i < count_; ++i) {
    auto& [feature, id, status, kind, searched, agrees, predicted, innovation, measured, nis] = match_[i];
    archive.within(feature, -1, features.capacity() - 1);
    archive.any(id);
    archive.within(status, static_cast<int>(MatchStatus::kInlier), static_cast<int>(MatchStatus::kNew));
    archive.within(kind, 0, kBlockKinds - 1);
    archive.flags(searched, agrees);
    archive.numbers(predicted, innovation, measured, nis);
    archive.require(feature < 0 || features.used(feature));
  }
}

void FrozenCamera::carry(Archive& archive) {
  auto& [has_image, fingerprint, first_ns] = data_;
  archive.flags(has_image);
  archive.any(fingerprint, first_ns);
}

void FollowedView::carry(Archive& archive) {
  auto& [thumbnail, is_kept, q_WC, q_now_WC, p_W] = data_;
  archive.flags(is_kept);
  archive.numbers(q_WC, q_now_WC, p_W);
  if (is_kept) archive.bytes(thumbnail.pixels, sizeof thumbnail.pixels);
}

void NoiseModel::carry(Archive& archive) {
  archive.numbers(sigma_px_, scale_, tau_, prior_tau_, variance_, excess_, frame_variance_, squares_, products_,
                  pairs_);
  archive.counts(count_);
}

void FitWarnings::carry(Archive& archive) { archive.flags(said_noise_, said_lens_); }

void FixedFeatures::carry(Archive& archive) {
  for (int i = 0; i < capacity_; ++i) {
    auto& [id, u, v, evidence, rho, weight] = entry_[i];
    archive.any(id, u, v, evidence);
    archive.numbers(rho, weight);
  }
  mask_.carry(archive);
  archive.numbers(view_.q_WC, view_.c_W, prior_);
  archive.flags(has_view_);
  archive.any(last_young_);
  archive.counts(age_);
}

void ImageSearch::carry(Archive& archive) { fixed_.carry(archive); }

void PoseHypotheses::carry(Archive& archive) { archive.within(tried_, 1, Archive::kMaxCount); }

void TrackingState::carry(Archive& archive) {
  auto& [state, has_pose, from_target, lost, unusable, may_skip_target, depths_known, lens_said, map_id, last_map_id,
         usable_ns, started_over, failed_updates, last_tracked_ns, belief] = data_;
  archive.within(state, 0, static_cast<int>(SlamState::kLost));
  archive.flags(has_pose, from_target, lost, unusable, may_skip_target, depths_known, lens_said, started_over);
  archive.any(map_id, last_map_id, last_tracked_ns);
  archive.within(usable_ns, 0, INT64_MAX / 2);
  archive.counts(failed_updates);
  belief.carry(archive);
}

}  // namespace pf
