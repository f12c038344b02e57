#include "frame/start/carry.h"

#include "frame/start/start_at_target.h"
#include "frame/start/start_without_target.h"

namespace pf {

void carry(Archive& archive, Target& target) {
  auto& [kind, width, height, has_place, q_WT, p_WT, count, point_W, sigma_m, first_pose, first_covariance] = target;
  archive.within(kind, 0, static_cast<int>(TargetKind::kPoints));
  archive.flags(has_place);
  archive.within(count, 0, Target::kMaxPoints);
  archive.numbers(width, height, q_WT, p_WT, sigma_m, first_covariance);
  carry(archive, first_pose);
  for (int i = 0; i < Target::kMaxPoints; ++i) {
    if (archive.is_reading() && i >= count) point_W[i].setZero();
    if (i < count) archive.numbers(point_W[i]);
  }
}

void carry(Archive& archive, KnownBody& known) {
  auto& [given, body, covariance] = known;
  archive.flags(given);
  carry(archive, body);
  archive.numbers(covariance);
}

void StartAtTarget::carry(Archive& archive) {
  pf::carry(archive, target_);
  archive.flags(has_begun_);
}

void StartWithoutTarget::carry(Archive& archive) {
  auto& [progress, base_q_WC, base_p_W, begin_ns, frame, t_ns, is_second, others, stills, id] = data_;
  archive.flags(progress.recording, progress.depth_known, progress.checking, is_second);
  archive.numbers(base_q_WC, base_p_W);
  archive.any(begin_ns, t_ns, id);
  archive.within(frame, 0, StartRecord::kMaxFrames - 1);
  archive.counts(others, stills);
  record_.carry(archive);
  bundle_.carry(archive);
}

}  // namespace pf
