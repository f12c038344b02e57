#include "track_rows.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>

#include "text_file.h"

namespace pf::capture {

namespace {

const char* kind_name(int32_t kind) {
  constexpr const char* kNames[] = {"unknown", "inverse_depth", "point", "folded", "fixed"};
  return kNames[kind >= 0 && kind <= 4 ? kind : 0];
}

}  // namespace

const char* match_name(int32_t status) {
  constexpr const char* kNames[] = {"unknown", "inlier", "outlier", "missed", "new"};
  return kNames[status >= 0 && status <= 4 ? status : 0];
}

void TrackRows::add(const FrameView& view, Source& source, std::string& tracks, std::string& planes) {
  has_depth_ = source.depth(depth_, surface_);
  std::vector<const pf_feature_t*> by_id;
  for (const pf_feature_t& feature : view.features) {
    by_id.push_back(&feature);
  }
  std::sort(by_id.begin(), by_id.end(), [](const pf_feature_t* a, const pf_feature_t* b) { return a->id < b->id; });
  for (const pf_match_t& t : view.tracks) {
    append(tracks, "%" PRId64 ",%u,%s,%s,%.3f,%.3f,%.4g,%.4g,%.4g", view.index, t.id, match_name(t.status),
           kind_name(t.kind), t.predicted_px[0], t.predicted_px[1], t.covariance_px[0], t.covariance_px[1],
           t.covariance_px[3]);
    if (t.status == PF_MATCH_MISSED) {
      tracks += ",,";
    } else {
      append(tracks, ",%.3f,%.3f", t.measured_px[0], t.measured_px[1]);
    }
    const auto found = std::lower_bound(by_id.begin(), by_id.end(), t.id,
                                        [](const pf_feature_t* a, uint32_t id) { return a->id < id; });
    if (found == by_id.end() || (*found)->id != t.id || (*found)->is_target != 0) {
      tracks += ",,";
    } else {
      append(tracks, ",%u,%d", (*found)->plane, (*found)->on_trial);
    }
    add_depth(t, view.image.width, view.image.height, tracks);
    tracks += '\n';
  }
  for (const PlaneView& plane : view.planes) {
    append(planes, "%" PRId64 ",%u,%d,%d,%.6f,%.6f,%.6f,%.6g,%.4g,%.4g\n", view.index, plane.id,
           plane.points - plane.trial, plane.trial, plane.normal[0], plane.normal[1], plane.normal[2], plane.distance,
           plane.sigma, plane.area());
  }
}

void TrackRows::add_depth(const pf_match_t& track, int32_t width, int32_t height, std::string& tracks) const {
  const long x = std::lround(track.measured_px[0]);
  const long y = std::lround(track.measured_px[1]);
  if (!has_depth_ || track.status == PF_MATCH_MISSED || x < 0 || y < 0 || x >= width || y >= height) {
    tracks += ",,";
    return;
  }
  const size_t at = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  append(tracks, ",%d,%.5g", surface_[at], static_cast<double>(depth_[at]));
}

}  // namespace pf::capture
