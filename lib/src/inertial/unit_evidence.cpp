#include "inertial/unit_evidence.h"

#include <algorithm>

#include "base/elapsed.h"
#include "inertial/tuning.h"

namespace pf {

using namespace tuning::unit_watch;

namespace {

constexpr double kFrozen = 1;  ///< [s] of use, or in metres, before noise is learned

}  // namespace

UnitUse UnitEvidence::use() const {
  return {filter_.is_metric(), data_.doubts > 0 && seconds(data_.used_ns) < static_cast<double>(kTrial)};
}

/// Evidence of a frame against the samples: a chi-square of six. A frame that needs the prediction without them contributes the most that
/// one frame can. A frame that neither prediction explains contributes nothing.
Scalar UnitEvidence::contradiction(const UnitFrame& frame) const {
  const FrameReport& report = frame_.report;
  if (!frame.is_tracked) return kSlack;
  if (frame.is_taken_back) return kMaxOfFrame;
  if (!frame.before_was_tracked || report.pose.dof == 0) return kSlack;
  return std::min(static_cast<Scalar>(report.pose.nis * Body::kPoseDim / report.pose.dof), kMaxOfFrame);
}

/// Frozen while samples have only begun to be used, or lengths to be metres: what P does not explain then is the start's.
void UnitEvidence::learn_noise(const UnitFrame& frame) {
  const FrameReport& report = frame_.report;
  data_.used_ns += frame.dt_ns;
  if (!frame.is_tracked || frame.is_worse_than_none || seconds(data_.used_ns) < kFrozen) return;
  if (frame.is_taken_back) {
    noise_.note_innovation(UnitNoise::kGyro, kMaxOfFrame, 3);
  } else if (frame.before_was_tracked && report.pose.dof > 0) {
    const int dof = report.pose.dof / 2;
    noise_.note_innovation(UnitNoise::kGyro, static_cast<Scalar>(report.pose.of_rotation), dof);
    if (filter_.is_metric() && seconds(data_.metric_ns) > kFrozen)
      noise_.note_innovation(UnitNoise::kAccel, static_cast<Scalar>(report.pose.nis - report.pose.of_rotation), dof);
  }
}

/// Innovations count against the unit once no plausible noise explains them.
bool UnitEvidence::add(const UnitFrame& frame, UnitMode mode) {
  const bool explained =
      !frame.is_worse_than_none && !noise_.is_at_bound(UnitNoise::kGyro) && !noise_.is_at_bound(UnitNoise::kAccel);
  const Scalar more = contradiction(frame) - kSlack;
  data_.sum = std::max(Scalar(0), data_.sum + (explained ? std::min(more, Scalar(0)) : more));
  if (!(data_.sum < (mode == UnitMode::kProbation ? kBoundOnProbation : kBound))) return true;
  if (frame.is_tracked && filter_.is_metric()) data_.metric_ns += frame.dt_ns;
  if (data_.sum <= 0) data_.sound_ns = data_.metric_ns;
  return false;
}

void UnitEvidence::count_doubt() {
  data_.used_ns = 0;
  data_.doubts = std::min(data_.doubts + 1, kMaxDoublings);
}

bool UnitEvidence::is_map_on_trial() const {
  return filter_.is_metric() && seconds(data_.sound_ns) < static_cast<double>(kTrial);
}

}  // namespace pf
