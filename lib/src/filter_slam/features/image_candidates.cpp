#include <algorithm>

#include "filter_slam/features/image_front_end.h"
#include "frame/feature_upkeep.h"
#include "frame/tuning.h"

/// Which features a frame searches for.

namespace pf {
namespace {

using namespace tuning::image_front_end;

}  // namespace

/// Whether a feature has an appearance and is predicted inside of the image, and where.
bool ImageFrontEnd::is_visible(int feature, Vec2* pixel) const {
  const Feature& f = map_.features[feature];
  if ((f.is_target && map_.target_withdrawn) || !f.has_appearance) return false;
  PixelMeasurement o;
  if (!filter_.predict_pixel(filter_.lens(), f.slot, &o)) return false;
  const Scalar margin = static_cast<Scalar>(settings_.border_px);
  *pixel = o.predicted;
  return !(o.predicted.x() < margin || o.predicted.y() < margin ||
           o.predicted.x() > static_cast<Scalar>(settings_.camera.width - 1) - margin ||
           o.predicted.y() > static_cast<Scalar>(settings_.camera.height - 1) - margin);
}

/// How reliable a feature is; negative where this view cannot be compared with its first.
float ImageFrontEnd::rate(int feature, const Vec2& pixel) const {
  const Feature& f = map_.features[feature];
  const float rate = reliability(f);
  SearchTask task = task_of(feature);
  task.predicted = pixel;
  return search_.tracker().is_comparable(task) ? rate : rate - kIncomparable;
}

/// A full list keeps the best, and the scouts are the best. What cannot be compared comes last: it would fill the list in place of what
/// was added instead.
int ImageFrontEnd::list_visible() {
  Scalar* rates = scratch_;
  int count = 0;
  for (int i = 0; i < map_.features.capacity(); ++i) {
    Vec2 pixel;
    if (!map_.features.used(i) || !is_visible(i, &pixel)) continue;
    const Scalar mine = static_cast<Scalar>(rate(i, pixel));
    int at = count;
    if (count == settings_.max_observations) {
      if (rates[count - 1] >= mine) continue;
      at = count - 1;
    } else {
      ++count;
    }
    for (; at > 0 && rates[at - 1] < mine; --at) {
      update_.candidate(at) = update_.candidate(at - 1);
      rates[at] = rates[at - 1];
    }
    update_.candidate(at).feature = i;
    rates[at] = mine;
  }
  for (int i = 0; i < count; ++i) {
    Candidate& candidate = update_.candidate(i);
    const Feature& f = map_.features[candidate.feature];
    candidate.match = frame_.add({candidate.feature, f.id, MatchStatus::kMissed, filter_.state().block[f.slot].kind,
                                  false, Vec2::Zero(), Mat2::Zero(), Vec2::Zero(), Scalar(0)});
  }
  return count;
}

}  // namespace pf
