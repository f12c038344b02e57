#include "map_panel.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pf::capture {

namespace {

using namespace colours;

/// The signed world axis nearest to a direction, leaving out one index.
Vec3 nearest_axis(const Vec3& direction, int without) {
  int best = without == 0 ? 1 : 0;
  for (int i = 0; i < 3; ++i) {
    if (i != without &&
        std::fabs(direction[static_cast<size_t>(i)]) > std::fabs(direction[static_cast<size_t>(best)])) {
      best = i;
    }
  }
  Vec3 axis{};
  axis[static_cast<size_t>(best)] = direction[static_cast<size_t>(best)] < 0.0 ? -1.0 : 1.0;
  return axis;
}

Vec3 vec(const double p[3]) { return {p[0], p[1], p[2]}; }

/// Covariance of the two coordinates along a and b of a 3x3 block with the given row stride.
std::array<double, 3> project(const double* c, int stride, const Vec3& a, const Vec3& b) {
  std::array<double, 3> out{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      const double value = c[i * static_cast<size_t>(stride) + j];
      out[0] += a[i] * value * a[j];
      out[1] += a[i] * value * b[j];
      out[2] += b[i] * value * b[j];
    }
  }
  return out;
}

Colour plane_in(const FrameView& view, uint32_t id) {
  const PlaneColour c = colour_of_plane(view, id);
  return {c.r, c.g, c.b};
}

/// The classes of planes and their colours, in the lower right corner.
void draw_legend(const Canvas& canvas, double right, double bottom) {
  constexpr double kRow = 15.0, kSwatch = 9.0, kSize = 11.0;
  double width = 0.0;
  for (const PlaneClass& one : kPlaneClasses) width = std::max(width, canvas.text_width(one.name, kSize));
  const double height = kRow * static_cast<double>(std::size(kPlaneClasses));
  const double x = std::round(right - width - kSwatch - 20.0), y = std::round(bottom - height - 10.0);
  canvas.rectangle(x, y, right - x - 5.0, height + 6.0, kGround, 0.8);
  double row = y + 6.0;
  for (const PlaneClass& one : kPlaneClasses) {
    canvas.rectangle(x + 5.0, row, kSwatch, kSwatch, {one.colour.r, one.colour.g, one.colour.b});
    canvas.colour(kText);
    canvas.text(x + kSwatch + 10.0, row + kSwatch, one.name, kSize);
    row += kRow;
  }
}

}  // namespace

void MapPanel::choose_axes(const pf_pose_t& pose) {
  const Vec3 down = nearest_axis(rotation_column(pose.q_WC, 1), -1);
  const int taken = down[0] != 0.0 ? 0 : down[1] != 0.0 ? 1 : 2;
  forward_ = nearest_axis(rotation_column(pose.q_WC, 2), taken);
  right_ = cross(down, forward_);
  has_axes_ = true;
}

void MapPanel::add(const FrameView& view) {
  if (!view.has_pose) {
    path_.clear();
    since_ = 0;
    stride_ = 1;
    has_axes_ = false;
    has_window_ = false;
    return;
  }
  if (!has_axes_) {
    choose_axes(view.pose);
  }
  remember(vec(view.pose.p_WC));
  const Window wanted = fit(view);
  // The view follows slowly, and opens faster than it closes: a map that jumps cannot be read.
  const double share = !has_window_ ? 1.0 : wanted.half > window_.half ? 0.3 : 0.1;
  window_.right += share * (wanted.right - window_.right);
  window_.forward += share * (wanted.forward - window_.forward);
  window_.half *= std::pow(wanted.half / window_.half, share);
  has_window_ = true;
  // The camera stays in sight, however fast the map changes.
  const double room = 0.85 * window_.half;
  const double right = dot(right_, path_.back());
  const double forward = dot(forward_, path_.back());
  window_.right = std::clamp(window_.right, right - room, right + room);
  window_.forward = std::clamp(window_.forward, forward - room, forward + room);
}

/// Every second place of a long path is forgotten, and then every second one passed over.
void MapPanel::remember(const Vec3& place) {
  if (path_.size() >= kMaxPath) {
    for (size_t i = 0; i < kMaxPath / 2; ++i) {
      path_[i] = path_[2 * i];
    }
    path_.resize(kMaxPath / 2);
    stride_ *= 2;
  }
  // The last place is always the newest; it stays where it is stride_ frames after the one before.
  if (since_ == 0 || path_.empty()) {
    path_.push_back(place);
  } else {
    path_.back() = place;
  }
  since_ = (since_ + 1) % stride_;
}

MapPanel::Window MapPanel::fit(const FrameView& view) const {
  double low[2] = {1e300, 1e300};
  double high[2] = {-1e300, -1e300};
  const auto take = [&](double right, double forward) {
    low[0] = std::min(low[0], right);
    high[0] = std::max(high[0], right);
    low[1] = std::min(low[1], forward);
    high[1] = std::max(high[1], forward);
  };
  for (const Vec3& p : path_) {
    take(dot(right_, p), dot(forward_, p));
  }
  std::vector<double> rights;
  std::vector<double> forwards;
  const Vec3 camera = vec(view.pose.p_WC);
  for (const pf_feature_t& f : view.features) {
    const Vec3 p = vec(f.p_W);
    const Vec3 ray = {p[0] - camera[0], p[1] - camera[1], p[2] - camera[2]};
    if (largest_sigma(f.covariance) < 0.6 * std::sqrt(dot(ray, ray))) {
      rights.push_back(dot(right_, p));
      forwards.push_back(dot(forward_, p));
    }
  }
  if (rights.size() >= 4) {
    std::sort(rights.begin(), rights.end());
    std::sort(forwards.begin(), forwards.end());
    const size_t cut = rights.size() / 12;
    take(rights[cut], forwards[cut]);
    take(rights[rights.size() - 1 - cut], forwards[forwards.size() - 1 - cut]);
  }
  Window window;
  window.right = 0.5 * (low[0] + high[0]);
  window.forward = 0.5 * (low[1] + high[1]);
  window.half = std::clamp(0.6 * std::max(high[0] - low[0], high[1] - low[1]), 1e-3, 1e6);
  return window;
}

void MapPanel::draw(const Canvas& canvas, const FrameView& view, double x, double y, double width, double height) {
  cairo_t* pen = canvas.pen();
  cairo_save(pen);
  cairo_rectangle(pen, x, y, width, height);
  cairo_clip(pen);
  canvas.rectangle(x, y, width, height, {0.055, 0.067, 0.088});
  if (has_window_) {
    const double pixels = 0.5 * std::min(width, height) / window_.half;
    const auto place = [&](const Vec3& p) {
      return std::array<double, 2>{x + 0.5 * width + pixels * (dot(right_, p) - window_.right),
                                   y + 0.5 * height - pixels * (dot(forward_, p) - window_.forward)};
    };
    draw_scale(canvas, x, y, width, height, pixels);
    for (const PlaneView& plane : view.planes) {
      const Colour colour = plane_in(view, plane.id);
      cairo_new_path(pen);
      for (const Vec3& corner : plane.outline) {
        const auto at = place(corner);
        cairo_line_to(pen, at[0], at[1]);
      }
      cairo_close_path(pen);
      canvas.colour(colour, 0.2);
      cairo_fill_preserve(pen);
      canvas.colour(colour, 0.9);
      cairo_set_line_width(pen, 1.6);
      cairo_stroke(pen);
    }
    std::map<uint32_t, bool> measured;
    for (const pf_match_t& track : view.tracks) {
      measured[track.id] = track.status == PF_MATCH_INLIER;
    }
    for (const pf_feature_t& f : view.features) {
      const auto at = place(vec(f.p_W));
      const auto found = measured.find(f.id);
      const bool inlier = found != measured.end() && found->second;
      const Colour colour = f.is_target != 0                     ? kTarget
                            : !inlier                            ? kDim
                            : f.plane != 0                       ? plane_in(view, f.plane)
                            : f.kind == PF_FEATURE_INVERSE_DEPTH ? kInverseDepth
                                                                 : kPoint;
      const auto c = project(f.covariance, 3, right_, forward_);
      const Ellipse e = ellipse_of(c[0], c[1], c[2]);
      const double faint = pixels * e.a > 40.0 ? 0.5 : 1.0;
      canvas.colour(colour, faint * (inlier ? 0.38 : 0.22));
      cairo_set_line_width(pen, 1.0);
      canvas.ellipse(at[0], at[1], std::min(pixels * e.a, 4.0 * width), pixels * e.b, -e.angle);
      canvas.colour(colour, inlier ? 1.0 : 0.75);
      canvas.dot(at[0], at[1], inlier ? 2.2 : 1.6);
    }
    canvas.colour(kPath, 0.85);
    cairo_set_line_width(pen, 1.4);
    cairo_new_path(pen);
    for (const Vec3& p : path_) {
      const auto at = place(p);
      cairo_line_to(pen, at[0], at[1]);
    }
    cairo_stroke(pen);
    if (view.has_pose) {
      draw_camera(canvas, view, place(vec(view.pose.p_WC)), pixels);
    }
  }
  canvas.rectangle(x + 4.0, y + 5.0, canvas.text_width("map from above", 12.0) + 16.0, 21.0, {0.055, 0.067, 0.088},
                   0.8);
  canvas.colour(kDim);
  canvas.text(x + 12.0, y + 20.0, "map from above", 12.0);
  if (view.has_gravity) draw_legend(canvas, x + width, y + height);
  cairo_restore(pen);
  canvas.rectangle(x, y, 1.0, height, kGrid);
  canvas.rectangle(x, y + height - 1.0, width, 1.0, kGrid);
}

void MapPanel::draw_camera(const Canvas& canvas, const FrameView& view, const std::array<double, 2>& at,
                           double pixels_per_unit) const {
  cairo_t* pen = canvas.pen();
  const pf_camera_t& camera = session_.config().camera;
  const double half_width = 0.5 * camera.width / camera.fx;
  const Vec3 x_C = rotation_column(view.pose.q_WC, 0);
  const Vec3 z_C = rotation_column(view.pose.q_WC, 2);
  cairo_new_path(pen);
  cairo_move_to(pen, at[0], at[1]);
  for (double side : {-half_width, half_width}) {
    const Vec3 corner = {z_C[0] + side * x_C[0], z_C[1] + side * x_C[1], z_C[2] + side * x_C[2]};
    cairo_line_to(pen, at[0] + 20.0 * dot(right_, corner), at[1] - 20.0 * dot(forward_, corner));
  }
  cairo_close_path(pen);
  canvas.colour(kNew, 0.22);
  cairo_fill_preserve(pen);
  canvas.colour(kNew);
  cairo_set_line_width(pen, 1.4);
  cairo_stroke(pen);
  const auto c = project(view.pose.covariance + 21, 6, right_, forward_);
  const Ellipse e = ellipse_of(c[0], c[1], c[2]);
  cairo_set_line_width(pen, 1.2);
  canvas.colour(kNew, 0.9);
  canvas.ellipse(at[0], at[1], 3.0 * pixels_per_unit * e.a, 3.0 * pixels_per_unit * e.b, -e.angle);
}

void MapPanel::draw_scale(const Canvas& canvas, double x, double y, double width, double height,
                          double pixels_per_unit) const {
  // The longest of 1, 2, 5 times a power of ten that takes less than a third of the panel.
  const double most = width / 3.0 / pixels_per_unit;
  double length = std::pow(10.0, std::floor(std::log10(most)));
  length *= most / length >= 5.0 ? 5.0 : most / length >= 2.0 ? 2.0 : 1.0;
  const double pixels = length * pixels_per_unit;
  canvas.colour(kGrid);
  cairo_set_line_width(canvas.pen(), 1.0);
  const double middle_x = x + 0.5 * width - pixels_per_unit * window_.right;
  const double middle_y = y + 0.5 * height + pixels_per_unit * window_.forward;
  for (double gx = middle_x - pixels * std::floor((middle_x - x) / pixels); gx < x + width; gx += pixels) {
    canvas.line(gx, y, gx, y + height);
  }
  for (double gy = middle_y - pixels * std::floor((middle_y - y) / pixels); gy < y + height; gy += pixels) {
    canvas.line(x, gy, x + width, gy);
  }
  char text[48];
  std::snprintf(text, sizeof(text), session_.is_metric() ? "%g m" : "%g first depths", length);
  canvas.colour(kDim);
  cairo_set_line_width(canvas.pen(), 2.0);
  canvas.line(x + 12.0, y + height - 12.0, x + 12.0 + pixels, y + height - 12.0);
  canvas.text(x + 12.0, y + height - 18.0, text, 11.0);
}

}  // namespace pf::capture
