#include "plane_drawing.h"

#include <algorithm>
#include <cmath>

#include "rows.h"

namespace pf::capture {

namespace {

constexpr int kPieces = 8;            // of each edge: lenses bend lines
constexpr double kMostReach = 4.0;    // tangent of the widest angle that is drawn
constexpr double kSmallestArea = 60;  // of a drawing that still gets its number [px²]
constexpr double kPlaneWidth = 1.8;   // of outlines [px]
constexpr double kWallWidth = 3.0;    // of a wall, where it is now
constexpr double kPlanWidth = 1.0;    // of a wall, where the plan has it

/// Where a plane is drawn.
class Pen {
 public:
  Pen(const Canvas& canvas, const FrameView& view, const pf_camera_t& camera, double zoom)
      : canvas_(canvas), view_(view), camera_(camera), zoom_(zoom) {
    // The widest rays of the image's edge, and a little more.
    for (int i = 0; i <= 8; ++i) {
      const double s = i / 8.0;
      const double w = camera.width;
      const double h = camera.height;
      const double edge[4][2] = {{s * w, 0.0}, {s * w, h}, {0.0, s * h}, {w, s * h}};
      for (const auto& pixel : edge) {
        double ray[3];
        const bool has_ray = pf_camera_unproject(&camera, pixel, ray) == PF_OK && ray[2] > 0.0;
        for (int k = 0; k < 2; ++k) {
          const double reach = has_ray ? 1.05 * std::fabs(ray[k] / ray[2]) : kMostReach;
          reach_[k] = std::clamp(reach, reach_[k], kMostReach);
        }
      }
    }
  }

  std::vector<Vec3> visible(const std::vector<Vec3>& outline) const {
    return visible_part(outline, view_.pose.q_WC, view_.pose.p_WC, reach_);
  }

  /// A line through points in C, in pieces.
  void path(const std::vector<Vec3>& points, bool closed) const {
    cairo_new_path(canvas_.pen());
    const size_t edges = points.empty() ? 0 : closed ? points.size() : points.size() - 1;
    for (size_t e = 0; e < edges; ++e) {
      const Vec3& a = points[e];
      const Vec3& b = points[(e + 1) % points.size()];
      for (int i = e == 0 ? 0 : 1; i <= kPieces; ++i) {
        const double s = static_cast<double>(i) / kPieces;
        const Vec3 p_C = {a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])};
        double pixel[2];
        if (project_row(camera_, view_.pose, p_C, pixel)) {
          cairo_line_to(canvas_.pen(), zoom_ * (pixel[0] + 0.5), zoom_ * (pixel[1] + 0.5));
        }
      }
    }
    if (closed) {
      cairo_close_path(canvas_.pen());
    }
  }

 private:
  const Canvas& canvas_;
  const FrameView& view_;
  const pf_camera_t& camera_;
  double zoom_;
  double reach_[2] = {0.0, 0.0};
};

/// The step of the grid: 1, 2 or 5 times a power of ten, with 4 to 10 cells across.
double grid_step(double area) {
  const double wanted = std::sqrt(area) / 6.0;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double part = wanted / power;
  return power * (part >= 5.0 ? 5.0 : part >= 2.0 ? 2.0 : 1.0);
}

void draw_plane(const Canvas& canvas, const Pen& pen, const PlaneView& plane, const PlaneColour& c, bool metric) {
  const std::vector<Vec3> corners = pen.visible(plane.outline);
  if (corners.size() < 3) {
    return;
  }
  const Colour colour{c.r, c.g, c.b};
  cairo_t* cairo = canvas.pen();
  pen.path(corners, true);
  canvas.colour(colour, 0.24);
  cairo_fill_preserve(cairo);
  double x0, y0, x1, y1;
  cairo_path_extents(cairo, &x0, &y0, &x1, &y1);
  canvas.colour(colour, 0.95);
  cairo_set_line_width(cairo, plane.is_wall ? kWallWidth : kPlaneWidth);
  cairo_stroke(cairo);
  const double area = plane.area();
  if (area > 0.0) {
    const std::vector<Vec3> lines = grid_lines(plane, grid_step(area));
    canvas.colour(colour, 0.38);
    cairo_set_line_width(cairo, 0.8);
    for (size_t i = 0; i + 1 < lines.size(); i += 2) {
      // A line is a polygon without width.
      const std::vector<Vec3> line = pen.visible({lines[i], lines[i + 1]});
      if (line.size() >= 2) {
        pen.path({line[0], line[1]}, false);
        cairo_stroke(cairo);
      }
    }
  }
  if ((x1 - x0) * (y1 - y0) > kSmallestArea) {
    char text[64];
    const int length = std::snprintf(text, sizeof(text), "%u: %d points", plane.id, plane.points);
    if (metric) {
      std::snprintf(text + length, sizeof(text) - static_cast<size_t>(length), ", %.2g m\xc2\xb2", area);
    }
    std::string words(text);
    if (plane.is_wall) words = (plane.rejected ? "rejected wall " : "wall ") + words;
    if (std::string(plane.orientation) != "unknown") {
      words += std::string(", ") + plane.orientation;
      std::replace(words.begin(), words.end(), '_', ' ');
    }
    const double width = canvas.text_width(words, 11.0, true);
    double left, top, right, bottom;
    cairo_clip_extents(cairo, &left, &top, &right, &bottom);
    const double x = std::clamp(0.5 * (x0 + x1 - width), left + 4.0, std::max(left + 4.0, right - width - 4.0));
    const double y = std::clamp(0.5 * (y0 + y1), top + 14.0, std::max(top + 14.0, bottom - 6.0));
    canvas.rectangle(x - 3.0, y - 11.0, width + 6.0, 15.0, colours::kGround, 0.6);
    canvas.colour(colours::kText);
    canvas.text(x, y, words, 11.0, true);
  }
}

}  // namespace

void draw_planes(const Canvas& canvas, const FrameView& view, const pf_camera_t& camera, double zoom, bool metric,
                 const std::vector<std::vector<Vec3>>& plan) {
  if (!view.has_pose) {
    return;
  }
  const Pen pen(canvas, view, camera, zoom);
  // Far ones first, so that what is nearer lies over them.
  std::vector<const PlaneView*> order;
  for (const PlaneView& plane : view.planes) {
    order.push_back(&plane);
  }
  const auto distance = [&](const PlaneView* plane) {
    const Vec3 m = plane->middle();
    const Vec3 r = {m[0] - view.pose.p_WC[0], m[1] - view.pose.p_WC[1], m[2] - view.pose.p_WC[2]};
    return dot(r, r);
  };
  std::sort(order.begin(), order.end(),
            [&](const PlaneView* a, const PlaneView* b) { return distance(a) > distance(b); });
  for (const PlaneView* plane : order) {
    draw_plane(canvas, pen, *plane, colour_of_plane(view, plane->id), metric);
  }
  for (const std::vector<Vec3>& wall : plan) {
    const std::vector<Vec3> corners = pen.visible(wall);
    if (corners.size() < 3) continue;
    pen.path(corners, true);
    canvas.colour(colours::kText, 0.8);
    cairo_set_line_width(canvas.pen(), kPlanWidth);
    cairo_stroke(canvas.pen());
  }
}

}  // namespace pf::capture
