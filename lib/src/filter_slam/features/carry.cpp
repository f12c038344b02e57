#include "base/archive.h"
#include "filter_slam/features/image_front_end.h"

namespace pf {

void SameView::carry(Archive& archive) {
  auto& [q_WC, p_W, frames] = data_;
  archive.numbers(q_WC, p_W);
  archive.counts(frames);
}

void FeatureSearch::carry(Archive& archive) {
  search_.carry(archive);
  followed_.carry(archive);
}

/// Candidates are those of a frame that is over.
void ImageFrontEnd::carry(Archive& archive) {
  hypotheses_.carry(archive);
  search_.carry(archive);
  same_view_.carry(archive);
  archive.flags(is_learnt_);
  if (!archive.is_reading()) return;
  is_measured_ = false;
  listed_ = 0;
  outcome_ = UpdateOutcome();
}

}  // namespace pf
