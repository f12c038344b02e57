#include "frame/start/carry.h"

#include "filter_slam/start/filter_start.h"
#include "filter_slam/start/metric_start.h"

namespace pf {

void MapBeginning::carry(Archive& archive) {
  auto& [known, begin_ns, covariance] = data_;
  pf::carry(archive, known);
  archive.any(begin_ns);
  archive.numbers(covariance);
}

void StartRecorder::carry(Archive& archive) {
  if (archive.is_reading() && adjusts_lens())
    record_.free_lens(settings_.camera, shape_prior(settings_.lens), settings_.camera);
  record_.carry(archive);
}

void FilterStart::carry(Archive& archive) {
  auto& [has_place, knows_scale] = data_;
  archive.flags(has_place, knows_scale);
  target_.carry(archive);
  mounting_.carry(archive);
  beginning_.carry(archive);
  recorder_.carry(archive);
}

void MetricStart::carry(Archive& archive) { archive.flags(is_from_motion_); }

}  // namespace pf
