#include "horizon.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pf::capture {

namespace {

constexpr int kDirections = 720;        // around the horizon
constexpr double kForward = 0.02;       // cosine from the axis of the widest that is drawn
constexpr double kLongestPiece = 0.25;  // of the width, between neighbours: more is no line
constexpr double kRadius = 22.0;        // of the arrow [px]
constexpr double kDegrees = 57.29577951308232;

/// Gravity in C, of length 1.
Vec3 down_in_camera(const FrameView& view) {
  Vec3 down{};
  double length = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = rotation_column(view.pose.q_WC, i);
    down[i] = axis[0] * view.inertial.gravity_W[0] + axis[1] * view.inertial.gravity_W[1] +
              axis[2] * view.inertial.gravity_W[2];
    length += down[i] * down[i];
  }
  for (double& x : down) x /= std::sqrt(length);
  return down;
}

/// Level directions lie on a great circle about gravity.
void draw_line(const Canvas& canvas, const FrameView& view, double zoom, const Vec3& down) {
  Vec3 across = cross(down, std::fabs(down[2]) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0});
  const double length = std::sqrt(dot(across, across));
  for (double& x : across) x /= length;
  const Vec3 ahead = cross(across, down);
  cairo_t* pen = canvas.pen();
  cairo_new_path(pen);
  double before[2] = {0.0, 0.0};
  bool has_before = false;
  for (int i = 0; i <= kDirections; ++i) {
    const double angle = 2.0 * M_PI * i / kDirections;
    const double c = std::cos(angle), s = std::sin(angle);
    const double d_C[3] = {c * ahead[0] + s * across[0], c * ahead[1] + s * across[1], c * ahead[2] + s * across[2]};
    double pixel[2];
    const bool seen = d_C[2] > kForward && pf_camera_project(&view.camera, d_C, pixel) == PF_OK;
    const double most = kLongestPiece * view.camera.width;
    if (seen && has_before && std::hypot(pixel[0] - before[0], pixel[1] - before[1]) < most)
      cairo_line_to(pen, zoom * (pixel[0] + 0.5), zoom * (pixel[1] + 0.5));
    else if (seen)
      cairo_move_to(pen, zoom * (pixel[0] + 0.5), zoom * (pixel[1] + 0.5));
    has_before = seen;
    if (seen) std::copy_n(pixel, 2, before);
  }
  constexpr double kDashes[2] = {9.0, 5.0};
  canvas.colour(colours::kPath, 0.85);
  cairo_set_line_width(pen, 1.6);
  cairo_set_dash(pen, kDashes, 2, 0.0);
  cairo_stroke(pen);
  cairo_set_dash(pen, nullptr, 0, 0.0);
}

/// As short as gravity points along the view; a ring where it comes towards the camera.
void draw_arrow(const Canvas& canvas, const FrameView& view, double height, const Vec3& down) {
  const double x = kRadius + 12.0, y = height - kRadius - 12.0;
  cairo_t* pen = canvas.pen();
  canvas.colour(colours::kGround, 0.6);
  canvas.dot(x, y, kRadius + 5.0);
  canvas.colour(colours::kPath);
  cairo_set_line_width(pen, 2.2);
  const double flat = std::hypot(down[0], down[1]), length = kRadius * flat;
  const double tip[2] = {x + kRadius * down[0], y + kRadius * down[1]};
  if (length > 3.0) {
    const double along[2] = {down[0] / flat, down[1] / flat};
    canvas.line(x - kRadius * down[0], y - kRadius * down[1], tip[0], tip[1]);
    for (const double side : {-1.0, 1.0})
      canvas.line(tip[0], tip[1], tip[0] - 6.0 * along[0] - side * 4.0 * along[1],
                  tip[1] - 6.0 * along[1] + side * 4.0 * along[0]);
  } else {
    canvas.ellipse(x, y, 5.0, 5.0, 0.0);
    if (down[2] > 0.0) canvas.dot(x, y, 2.0);
  }
  const double sigma = std::sqrt(std::max(0.0, std::max(view.inertial.covariance[0], view.inertial.covariance[9])));
  char text[48];
  std::snprintf(text, sizeof(text), "down, sigma %.2g\xc2\xb0", kDegrees * sigma);
  canvas.rectangle(x + kRadius + 8.0, y - 11.0, canvas.text_width(text, 11.0) + 8.0, 15.0, colours::kGround, 0.6);
  canvas.colour(colours::kText);
  canvas.text(x + kRadius + 12.0, y, text, 11.0);
}

}  // namespace

void draw_horizon(const Canvas& canvas, const FrameView& view, double zoom, double height) {
  if (!view.has_pose || !view.has_inertial || view.inertial.metric == 0) {
    return;
  }
  const Vec3 down = down_in_camera(view);
  draw_line(canvas, view, zoom, down);
  draw_arrow(canvas, view, height, down);
}

}  // namespace pf::capture
