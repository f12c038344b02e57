#include <algorithm>
#include <cmath>

#include "overlay.h"

namespace pf::capture {

using namespace colours;

Colour state_colour(int32_t state) {
  switch (state) {
    case PF_STATE_STARTING:
      return kDim;
    case PF_STATE_TRACKING:
      return kPoint;
    case PF_STATE_COASTING:
      return kMissed;
    default:
      return kOutlier;
  }
}

namespace {

std::string format(const char* how, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), how, value);
  return text;
}

}  // namespace

void Overlay::draw_numbers(const FrameView& view, double x, double y, double width) {
  const double left = x + 14.0;
  const double right = x + width - 14.0;
  double row = y + 22.0;
  const double room = image_height_ - y;
  const double step = std::clamp((room - 16.0) / 11.0, 14.0, 22.0);
  const double size = step < 17.0 ? 11.0 : 12.5;
  int counts[5] = {0, 0, 0, 0, 0};
  int points = 0;
  int planar = 0;
  for (const pf_match_t& track : view.tracks) {
    counts[track.status <= 4 ? track.status : 0] += 1;
    points += track.status == PF_MATCH_INLIER && track.kind == PF_FEATURE_POINT ? 1 : 0;
    planar +=
        track.status == PF_MATCH_INLIER && (track.kind == PF_FEATURE_FOLDED || track.kind == PF_FEATURE_FIXED) ? 1 : 0;
  }
  const auto put = [&](const Colour& mark, const char* name, const std::string& value) {
    if (row > image_height_ - 4.0) {
      return;
    }
    canvas_.colour(mark);
    canvas_.dot(left + 4.0, row - 4.0, 3.6);
    canvas_.colour(kText);
    canvas_.text(left + 16.0, row, name, size);
    canvas_.text(right - canvas_.text_width(value, size), row, value, size);
    row += step;
  };
  put(kPoint, "measured, 3-D point", std::to_string(points));
  put(kInverseDepth, "measured, inverse depth", std::to_string(counts[PF_MATCH_INLIER] - points - planar));
  put(kPath, "measured, on a plane", std::to_string(planar));
  put(kOutlier, "found, but disagrees", std::to_string(counts[PF_MATCH_OUTLIER]));
  put(kMissed, "looked for, not found", std::to_string(counts[PF_MATCH_MISSED]));
  put(kNew, "new", std::to_string(counts[PF_MATCH_NEW]));
  const auto note = [&](const char* name, const std::string& value) {
    if (row > image_height_ - 4.0) {
      return;
    }
    canvas_.colour(kDim);
    canvas_.text(left, row, name, size);
    canvas_.text(right - canvas_.text_width(value, size), row, value, size);
    row += step;
  };
  note("planes", std::to_string(view.planes.size()));
  note("features in map / state", std::to_string(view.report.features) + " / " + std::to_string(view.report.state_dim));
  if (view.has_pose) {
    const double* c = view.pose.covariance;
    const bool metric = session_.is_metric();
    const double sigma_p = std::sqrt(std::max(0.0, (c[21] + c[28] + c[35]) / 3.0));
    const double sigma_r = std::sqrt(std::max(0.0, (c[0] + c[7] + c[14]) / 3.0));
    note("position \xc2\xb1", metric ? format("%.1f mm", 1e3 * sigma_p) : format("%.2f %%", 1e2 * sigma_p));
    note("rotation \xc2\xb1", format("%.2f\xc2\xb0", sigma_r * 180.0 / M_PI));
  }
  note("time", format("%.2f ms", view.ms));
}

void Overlay::draw_strip(const FrameView& view) {
  const double top = image_height_;
  const double width = canvas_.width();
  canvas_.rectangle(0, top, width, kOverlayStripHeight, {0.045, 0.055, 0.072});
  const std::string state = state_name(view.report.state);
  const Colour badge = state_colour(view.report.state);
  const double badge_width = canvas_.text_width(state, 13.0, true) + 20.0;
  canvas_.rectangle(10.0, top + 6.0, badge_width, 20.0, badge);
  canvas_.colour({0.03, 0.04, 0.05});
  canvas_.text(20.0, top + 20.5, state, 13.0, true);
  std::string text =
      "frame " + std::to_string(view.index + 1) + (view.count > 0 ? " / " + std::to_string(view.count) : "");
  if (view.status == PF_NOTE_UNUSABLE) {
    text += "   image has no usable content";
  }
  canvas_.colour(kText);
  canvas_.text(badge_width + 24.0, top + 20.5, text, 13.0);
  const double used = badge_width + 24.0 + canvas_.text_width(text, 13.0);
  const double title_width = canvas_.text_width(title_, 13.0);
  if (used + 30.0 + title_width < width) {
    canvas_.colour(kText);
    canvas_.text(width - title_width - 14.0, top + 20.5, title_, 13.0);
  }
  draw_time_line(view);
}

/// From left to right the frames so far, in the colours of their states; the width is all frames that there will be, where that is known.
void Overlay::draw_time_line(const FrameView& view) {
  const double top = image_height_ + kOverlayStripHeight - 6.0;
  const double width = canvas_.width();
  const double count = static_cast<double>(view.count > 0 ? view.count : std::max<int64_t>(frames_, 1));
  const double column = width * static_cast<double>(column_frames_) / count;
  canvas_.rectangle(0, top, width, 6.0, kGrid);
  for (size_t i = 0; i < time_line_.size(); ++i) {
    canvas_.rectangle(column * static_cast<double>(i), top, std::max(1.0, column), 6.0, state_colour(time_line_[i]),
                      0.9);
  }
}

}  // namespace pf::capture
