#include "overlay.h"

#include <algorithm>
#include <cmath>

#include "maths.h"

namespace pf::capture {

namespace {

using namespace colours;

constexpr int kStripHeight = 40;
constexpr size_t kTailFrames = 15;
constexpr double kGate = 3.035;  ///< sqrt of the chi-squared bound 9.21 of two degrees of freedom at 0.99

double zoom_of(const pf_camera_t& camera) { return camera.width <= 480 ? 2.0 : 1.0; }

int even(double value) { return 2 * static_cast<int>(std::lround(0.5 * value)); }

Colour state_colour(pf_state_t state) {
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

Colour track_colour(const pf_track_t& track) {
  switch (track.status) {
    case PF_TRACK_INLIER:
      return track.kind == PF_FEATURE_POINT ? kPoint : kInverseDepth;
    case PF_TRACK_OUTLIER:
      return kOutlier;
    case PF_TRACK_MISSED:
      return kMissed;
    default:
      return kNew;
  }
}

std::string format(const char* how, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), how, value);
  return text;
}

}  // namespace

Overlay::Overlay(const Session& session, const std::string& title)
    : session_(session),
      title_(title),
      zoom_(zoom_of(session.config().camera)),
      image_width_(even(zoom_ * session.config().camera.width)),
      image_height_(std::max(360, even(zoom_ * session.config().camera.height))),
      panel_width_(even(std::clamp(0.64 * image_height_, 280.0, 480.0))),
      canvas_(image_width_ + panel_width_, image_height_ + kStripHeight),
      map_(session) {}

void Overlay::add(const FrameView& view) {
  for (const pf_track_t& track : view.tracks) {
    if (track.status == PF_TRACK_INLIER || track.status == PF_TRACK_NEW) {
      Tail& tail = tails_[track.id];
      if (tail.last_frame + 1 != view.index) {
        tail.pixels.clear();
      }
      tail.pixels.emplace_back(track.measured_px[0], track.measured_px[1]);
      if (tail.pixels.size() > kTailFrames) {
        tail.pixels.pop_front();
      }
      tail.last_frame = view.index;
    }
  }
  for (auto it = tails_.begin(); it != tails_.end();) {
    it = it->second.last_frame != view.index ? tails_.erase(it) : std::next(it);
  }
  time_line_.push_back(state_colour(view.report.state));
  map_.add(view);
}

const Canvas& Overlay::draw(const FrameView& view) {
  cairo_t* pen = canvas_.pen();
  canvas_.rectangle(0, 0, canvas_.width(), canvas_.height(), kGround);
  cairo_save(pen);
  cairo_rectangle(pen, 0, 0, image_width_, image_height_);
  cairo_clip(pen);
  draw_image(view.image);
  if (view.has_pose) {
    draw_target();
  }
  draw_tracks(view);
  cairo_restore(pen);
  map_.draw(canvas_, view, image_width_, 0, panel_width_, panel_width_);
  draw_numbers(view, image_width_, panel_width_, panel_width_);
  draw_strip(view);
  return canvas_;
}

void Overlay::draw_image(const pf_image_t& image) {
  const int stride = cairo_format_stride_for_width(CAIRO_FORMAT_RGB24, image.width);
  grey_.resize(static_cast<size_t>(stride) * static_cast<size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    const uint8_t* in = image.pixels + static_cast<ptrdiff_t>(y) * image.stride;
    unsigned char* out = grey_.data() + static_cast<ptrdiff_t>(y) * stride;
    for (int x = 0; x < image.width; ++x) {
      // A little darker than it is, so that the drawing stands out.
      const auto level = static_cast<unsigned char>((in[x] * 218) >> 8);
      out[4 * x] = out[4 * x + 1] = out[4 * x + 2] = level;
      out[4 * x + 3] = 255;
    }
  }
  cairo_surface_t* surface =
      cairo_image_surface_create_for_data(grey_.data(), CAIRO_FORMAT_RGB24, image.width, image.height, stride);
  cairo_t* pen = canvas_.pen();
  cairo_save(pen);
  cairo_scale(pen, zoom_, zoom_);
  cairo_set_source_surface(pen, surface, 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(pen), zoom_ > 1.0 ? CAIRO_FILTER_BILINEAR : CAIRO_FILTER_NEAREST);
  cairo_paint(pen);
  cairo_restore(pen);
  cairo_surface_destroy(surface);
}

/// Outline of the known rectangle where the pose puts it, in short pieces because lenses bend lines.
void Overlay::draw_target() {
  const pf_target_t* target = session_.target();
  if (target == nullptr || target->kind != PF_TARGET_RECTANGLE) {
    return;
  }
  constexpr int kPieces = 10;
  constexpr double kCorners[5][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}};
  cairo_t* pen = canvas_.pen();
  cairo_new_path(pen);
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i <= kPieces; ++i) {
      const double s = static_cast<double>(i) / kPieces;
      const double p_W[3] = {target->width * ((1.0 - s) * kCorners[side][0] + s * kCorners[side + 1][0]),
                             target->height * ((1.0 - s) * kCorners[side][1] + s * kCorners[side + 1][1]), 0.0};
      double pixel[2];
      if (pf_project_point(session_.slam(), p_W, pixel, nullptr) != PF_OK) {
        cairo_new_path(pen);
        return;
      }
      cairo_line_to(pen, zoom_ * (pixel[0] + 0.5), zoom_ * (pixel[1] + 0.5));
    }
  }
  canvas_.colour(kTarget, 0.9);
  cairo_set_line_width(pen, 1.5);
  cairo_stroke(pen);
}

void Overlay::draw_tracks(const FrameView& view) {
  cairo_t* pen = canvas_.pen();
  const auto at = [&](double pixel) { return zoom_ * (pixel + 0.5); };
  for (const pf_track_t& track : view.tracks) {
    const auto found = tails_.find(track.id);
    if (found == tails_.end()) {
      continue;
    }
    const auto& pixels = found->second.pixels;
    for (size_t i = 1; i < pixels.size(); ++i) {
      canvas_.colour(track_colour(track), 0.65 * static_cast<double>(i) / static_cast<double>(pixels.size()));
      cairo_set_line_width(pen, 1.6);
      canvas_.line(at(pixels[i - 1].first), at(pixels[i - 1].second), at(pixels[i].first), at(pixels[i].second));
    }
  }
  for (const pf_track_t& track : view.tracks) {
    const Colour colour = track_colour(track);
    if (track.status != PF_TRACK_NEW) {
      const Ellipse e = ellipse_of(track.covariance_px[0], track.covariance_px[1], track.covariance_px[3]);
      canvas_.colour(colour, track.status == PF_TRACK_INLIER ? 0.75 : 0.9);
      cairo_set_line_width(pen, 1.1);
      canvas_.ellipse(at(track.predicted_px[0]), at(track.predicted_px[1]), zoom_ * kGate * e.a, zoom_ * kGate * e.b,
                      e.angle);
    }
    const double x = at(track.status == PF_TRACK_MISSED ? track.predicted_px[0] : track.measured_px[0]);
    const double y = at(track.status == PF_TRACK_MISSED ? track.predicted_px[1] : track.measured_px[1]);
    canvas_.colour(colour);
    cairo_set_line_width(pen, 1.4);
    if (track.status == PF_TRACK_INLIER) {
      canvas_.dot(x, y, 2.4);
    } else if (track.status == PF_TRACK_NEW) {
      cairo_rectangle(pen, x - 4.0, y - 4.0, 8.0, 8.0);
      cairo_stroke(pen);
    } else if (track.status == PF_TRACK_OUTLIER) {
      canvas_.line(x - 3.5, y - 3.5, x + 3.5, y + 3.5);
      canvas_.line(x - 3.5, y + 3.5, x + 3.5, y - 3.5);
    } else {
      canvas_.line(x - 2.5, y, x + 2.5, y);
      canvas_.line(x, y - 2.5, x, y + 2.5);
    }
  }
}

void Overlay::draw_numbers(const FrameView& view, double x, double y, double width) {
  const double left = x + 14.0;
  const double right = x + width - 14.0;
  double row = y + 22.0;
  const double room = image_height_ - y;
  const double step = std::clamp((room - 16.0) / 9.0, 14.0, 22.0);
  const double size = step < 17.0 ? 11.0 : 12.5;
  int counts[5] = {0, 0, 0, 0, 0};
  int points = 0;
  for (const pf_track_t& track : view.tracks) {
    counts[track.status <= 4 ? track.status : 0] += 1;
    points += track.status == PF_TRACK_INLIER && track.kind == PF_FEATURE_POINT ? 1 : 0;
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
  put(kInverseDepth, "measured, inverse depth", std::to_string(counts[PF_TRACK_INLIER] - points));
  put(kOutlier, "found, but disagrees", std::to_string(counts[PF_TRACK_OUTLIER]));
  put(kMissed, "looked for, not found", std::to_string(counts[PF_TRACK_MISSED]));
  put(kNew, "new", std::to_string(counts[PF_TRACK_NEW]));
  const auto note = [&](const char* name, const std::string& value) {
    if (row > image_height_ - 4.0) {
      return;
    }
    canvas_.colour(kDim);
    canvas_.text(left, row, name, size);
    canvas_.text(right - canvas_.text_width(value, size), row, value, size);
    row += step;
  };
  note("features in map / state", std::to_string(view.report.features) + " / " + std::to_string(view.report.state_dim));
  if (view.has_pose) {
    const double* c = view.pose.covariance;
    const bool metric = session_.target() != nullptr;
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
  canvas_.rectangle(0, top, width, kStripHeight, {0.045, 0.055, 0.072});
  const std::string state = state_name(view.report.state);
  const Colour badge = state_colour(view.report.state);
  const double badge_width = canvas_.text_width(state, 13.0, true) + 20.0;
  canvas_.rectangle(10.0, top + 6.0, badge_width, 20.0, badge);
  canvas_.colour({0.03, 0.04, 0.05});
  canvas_.text(20.0, top + 20.5, state, 13.0, true);
  std::string text = "frame " + std::to_string(view.index + 1) + " / " + std::to_string(view.count);
  if (view.status == PF_NOTE_UNUSABLE) {
    text += "   image has no usable content";
  }
  canvas_.colour(kText);
  canvas_.text(badge_width + 24.0, top + 20.5, text, 13.0);
  const double used = badge_width + 24.0 + canvas_.text_width(text, 13.0);
  const double title_width = canvas_.text_width(title_, 13.0);
  if (used + 30.0 + title_width < width) {
    canvas_.colour(kDim);
    canvas_.text(width - title_width - 14.0, top + 20.5, title_, 13.0);
  }
  // Time line: one column per frame, in the colour of its state.
  const double count = static_cast<double>(std::max<int64_t>(view.count, 1));
  canvas_.rectangle(0, top + kStripHeight - 6.0, width, 6.0, kGrid);
  for (size_t i = 0; i < time_line_.size(); ++i) {
    const double x = width * static_cast<double>(i) / count;
    canvas_.rectangle(x, top + kStripHeight - 6.0, std::max(1.0, width / count), 6.0, time_line_[i], 0.9);
  }
}

}  // namespace pf::capture
