#include "overlay.h"

#include <algorithm>
#include <cmath>

#include "horizon.h"
#include "maths.h"
#include "plane_drawing.h"
#include "rows.h"
#include "text_file.h"

namespace pf::capture {

namespace {

using namespace colours;

constexpr size_t kTailFrames = 15;
constexpr size_t kMaxColumns = 4096;  ///< of the time line

/// Tracking, starting, coasting, lost.
bool is_worse(int32_t a, int32_t b) {
  const auto rank = [](int32_t state) {
    return state == PF_STATE_TRACKING ? 0 : state == PF_STATE_STARTING ? 1 : state == PF_STATE_COASTING ? 2 : 3;
  };
  return rank(a) < rank(b);
}
constexpr double kGate = 3.035;  ///< sqrt of the chi-squared bound 9.21 of two degrees of freedom at 0.99

double zoom_of(const pf_camera_t& camera) { return camera.width <= 480 ? 2.0 : 1.0; }

int even(double value) { return 2 * static_cast<int>(std::lround(0.5 * value)); }

Colour track_colour(const pf_match_t& track) {
  switch (track.status) {
    case PF_MATCH_INLIER:
      return track.kind == PF_FEATURE_INVERSE_DEPTH ? kInverseDepth : kPoint;
    case PF_MATCH_OUTLIER:
      return kOutlier;
    case PF_MATCH_MISSED:
      return kMissed;
    default:
      return kNew;
  }
}

}  // namespace

Overlay::Overlay(const Session& session, const std::string& title)
    : session_(session),
      title_(title),
      zoom_(zoom_of(session.config().camera)),
      image_width_(even(zoom_ * session.config().camera.width)),
      image_height_(std::max(360, even(zoom_ * session.config().camera.height))),
      panel_width_(even(std::clamp(0.64 * image_height_, 280.0, 480.0))),
      canvas_(image_width_ + panel_width_, image_height_ + kOverlayStripHeight),
      map_(session) {}

void Overlay::add(const FrameView& view) {
  for (const pf_match_t& track : view.tracks) {
    if (track.status == PF_MATCH_INLIER || track.status == PF_MATCH_NEW) {
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
  remember_state(view.report.state);
  map_.add(view);
}

/// Columns of twice as many frames, where there are more of them than a picture has pixels.
void Overlay::remember_state(int32_t state) {
  if (frames_ % column_frames_ == 0) {
    if (time_line_.size() == kMaxColumns) {
      for (size_t i = 0; i < kMaxColumns / 2; ++i) {
        time_line_[i] = std::max(time_line_[2 * i], time_line_[2 * i + 1], is_worse);
      }
      time_line_.resize(kMaxColumns / 2);
      column_frames_ *= 2;
    }
    time_line_.push_back(state);
  } else {
    time_line_.back() = std::max(time_line_.back(), state, is_worse);
  }
  ++frames_;
}

const Canvas& Overlay::draw(const FrameView& view) {
  cairo_t* pen = canvas_.pen();
  canvas_.rectangle(0, 0, canvas_.width(), canvas_.height(), kGround);
  cairo_save(pen);
  cairo_rectangle(pen, 0, 0, image_width_, image_height_);
  cairo_clip(pen);
  draw_image(view.image);
  draw_planes(canvas_, view, view.camera, zoom_, session_.is_metric(), session_.plan().outlines());
  if (view.has_pose) {
    draw_target(view);
  }
  draw_patches(view);
  draw_tracks(view);
  draw_hits(view);
  draw_anchors(view);
  draw_horizon(canvas_, view, zoom_, zoom_ * view.image.height);
  cairo_restore(pen);
  map_.draw(canvas_, view, image_width_, 0, panel_width_, panel_width_);
  draw_numbers(view, image_width_, panel_width_, panel_width_);
  draw_strip(view);
  return canvas_;
}

bool Overlay::pixel_at(const double place[2], double pixel[2]) const {
  const pf_camera_t& camera = session_.config().camera;
  pixel[0] = place[0] / zoom_ - 0.5;
  pixel[1] = place[1] / zoom_ - 0.5;
  return pixel[0] >= -0.5 && pixel[1] >= -0.5 && pixel[0] < camera.width - 0.5 && pixel[1] < camera.height - 0.5;
}

/// What was pointed at: a cross where it is now, and what it was.
void Overlay::draw_hits(const FrameView& view) {
  for (const Hit& hit : view.hits) {
    double pixel[2];
    const Vec3 p_C = to_camera(view.pose, {hit.at.p_W[0], hit.at.p_W[1], hit.at.p_W[2]});
    if (!view.has_pose || p_C[2] <= 0.0 || !project_row(view.camera, view.pose, p_C, pixel)) {
      continue;
    }
    const double x = zoom_ * (pixel[0] + 0.5);
    const double y = zoom_ * (pixel[1] + 0.5);
    canvas_.colour(kPath);
    cairo_set_line_width(canvas_.pen(), 2.0);
    canvas_.line(x - 9.0, y, x + 9.0, y);
    canvas_.line(x, y - 9.0, x, y + 9.0);
    const std::string text = describe(hit, session_.is_metric());
    const double width = canvas_.text_width(text, 11.0, true);
    const double left = std::clamp(x + 12.0, 2.0, std::max(2.0, image_width_ - width - 4.0));
    canvas_.rectangle(left - 3.0, y - 20.0, width + 6.0, 15.0, kGround, 0.7);
    canvas_.colour(kPath);
    canvas_.text(left, y - 9.0, text, 11.0, true);
  }
}

/// Axes of the anchors of this map, x, y and z in red, green and blue, of a tenth of their distance, and their ids.
void Overlay::draw_anchors(const FrameView& view) {
  constexpr double kLength = 0.1;
  constexpr Colour kAxes[] = {{1.0, 0.3, 0.3}, {0.3, 1.0, 0.4}, {0.4, 0.6, 1.0}};
  const auto place = [&](const Vec3& p_W, double at[2]) {
    double pixel[2];
    const Vec3 p_C = to_camera(view.pose, p_W);
    if (p_C[2] <= 0.0 || !project_row(view.camera, view.pose, p_C, pixel)) {
      return false;
    }
    at[0] = zoom_ * (pixel[0] + 0.5);
    at[1] = zoom_ * (pixel[1] + 0.5);
    return true;
  };
  for (const pf_anchor_t& anchor : view.anchors) {
    const Vec3 origin_W{anchor.p_WA[0], anchor.p_WA[1], anchor.p_WA[2]};
    double from[2];
    if (!view.has_pose || anchor.map_id != view.report.map_id || !place(origin_W, from)) {
      continue;
    }
    const double length = kLength * to_camera(view.pose, origin_W)[2];
    cairo_set_line_width(canvas_.pen(), 2.5);
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 along = rotation_column(anchor.q_WA, axis);
      double to[2];
      if (place({origin_W[0] + length * along[0], origin_W[1] + length * along[1], origin_W[2] + length * along[2]},
                to)) {
        canvas_.colour(kAxes[axis]);
        canvas_.line(from[0], from[1], to[0], to[1]);
      }
    }
    std::string text;
    append(text, "anchor %u", anchor.id);
    const double width = canvas_.text_width(text, 11.0, true);
    const double left = std::clamp(from[0] + 8.0, 2.0, std::max(2.0, image_width_ - width - 4.0));
    canvas_.rectangle(left - 3.0, from[1] + 5.0, width + 6.0, 15.0, kGround, 0.7);
    canvas_.colour(kText);
    canvas_.text(left, from[1] + 16.0, text, 11.0, true);
  }
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
void Overlay::draw_target(const FrameView& view) {
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
      const Vec3 p_W = {target->width * ((1.0 - s) * kCorners[side][0] + s * kCorners[side + 1][0]),
                        target->height * ((1.0 - s) * kCorners[side][1] + s * kCorners[side + 1][1]), 0.0};
      double pixel[2];
      if (!project_row(view.camera, view.pose, to_camera(view.pose, p_W), pixel)) {
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

/// Outlines of patches of walls, in the colours of matches; those out of view are not drawn.
void Overlay::draw_patches(const FrameView& view) {
  cairo_t* pen = canvas_.pen();
  for (const pf_patch_t& patch : view.patches) {
    if (patch.status == 0) {
      continue;
    }
    const Colour colour = patch.status == PF_MATCH_INLIER    ? kPoint
                          : patch.status == PF_MATCH_OUTLIER ? kOutlier
                          : patch.status == PF_MATCH_MISSED  ? kMissed
                                                             : kNew;
    cairo_new_path(pen);
    for (const auto& corner : patch.corners_px) {
      cairo_line_to(pen, zoom_ * (corner[0] + 0.5), zoom_ * (corner[1] + 0.5));
    }
    cairo_close_path(pen);
    canvas_.colour(colour, 0.9);
    cairo_set_line_width(pen, patch.status == PF_MATCH_INLIER ? 2.4 : 1.2);
    cairo_stroke(pen);
  }
}

void Overlay::draw_tracks(const FrameView& view) {
  cairo_t* pen = canvas_.pen();
  std::map<uint32_t, uint32_t> plane_of;
  for (const pf_feature_t& feature : view.features) {
    if (feature.plane != 0) {
      plane_of[feature.id] = feature.plane;
    }
  }
  const auto colour_of = [&](const pf_match_t& track) {
    const auto plane = plane_of.find(track.id);
    if (track.status != PF_MATCH_INLIER || plane == plane_of.end()) {
      return track_colour(track);
    }
    const PlaneColour c = colour_of_plane(view, plane->second);
    return Colour{c.r, c.g, c.b};
  };
  const auto at = [&](double pixel) { return zoom_ * (pixel + 0.5); };
  for (const pf_match_t& track : view.tracks) {
    const auto found = tails_.find(track.id);
    if (found == tails_.end()) {
      continue;
    }
    const auto& pixels = found->second.pixels;
    for (size_t i = 1; i < pixels.size(); ++i) {
      canvas_.colour(colour_of(track), 0.65 * static_cast<double>(i) / static_cast<double>(pixels.size()));
      cairo_set_line_width(pen, 1.6);
      canvas_.line(at(pixels[i - 1].first), at(pixels[i - 1].second), at(pixels[i].first), at(pixels[i].second));
    }
  }
  for (const pf_match_t& track : view.tracks) {
    const Colour colour = colour_of(track);
    if (track.status != PF_MATCH_NEW) {
      const Ellipse e = ellipse_of(track.covariance_px[0], track.covariance_px[1], track.covariance_px[3]);
      canvas_.colour(colour, track.status == PF_MATCH_INLIER ? 0.75 : 0.9);
      cairo_set_line_width(pen, 1.1);
      canvas_.ellipse(at(track.predicted_px[0]), at(track.predicted_px[1]), zoom_ * kGate * e.a, zoom_ * kGate * e.b,
                      e.angle);
    }
    const double x = at(track.status == PF_MATCH_MISSED ? track.predicted_px[0] : track.measured_px[0]);
    const double y = at(track.status == PF_MATCH_MISSED ? track.predicted_px[1] : track.measured_px[1]);
    canvas_.colour(colour);
    cairo_set_line_width(pen, 1.4);
    if (track.status == PF_MATCH_INLIER) {
      canvas_.dot(x, y, 2.4);
    } else if (track.status == PF_MATCH_NEW) {
      cairo_rectangle(pen, x - 4.0, y - 4.0, 8.0, 8.0);
      cairo_stroke(pen);
    } else if (track.status == PF_MATCH_OUTLIER) {
      canvas_.line(x - 3.5, y - 3.5, x + 3.5, y + 3.5);
      canvas_.line(x - 3.5, y + 3.5, x + 3.5, y - 3.5);
    } else {
      canvas_.line(x - 2.5, y, x + 2.5, y);
      canvas_.line(x, y - 2.5, x, y + 2.5);
    }
  }
}

}  // namespace pf::capture
