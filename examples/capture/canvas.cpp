#include "canvas.h"

#include <algorithm>
#include <cmath>

namespace pf::capture {

namespace {

constexpr double kMinAxis = 1e-3, kMaxAxis = 1e5;  ///< px, of an ellipse

}  // namespace

Canvas::Canvas(int width, int height)
    : width_(width),
      height_(height),
      surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)),
      pen_(cairo_create(surface_.get())) {}

const unsigned char* Canvas::pixels() const {
  cairo_surface_flush(surface_.get());
  return cairo_image_surface_get_data(surface_.get());
}

bool Canvas::save_png(const std::string& path) const {
  return cairo_surface_write_to_png(surface_.get(), path.c_str()) == CAIRO_STATUS_SUCCESS;
}

void Canvas::rectangle(double x, double y, double w, double h, const Colour& c, double alpha) const {
  colour(c, alpha);
  cairo_rectangle(pen(), x, y, w, h);
  cairo_fill(pen());
}

void Canvas::line(double x0, double y0, double x1, double y1) const {
  cairo_move_to(pen(), x0, y0);
  cairo_line_to(pen(), x1, y1);
  cairo_stroke(pen());
}

void Canvas::dot(double x, double y, double radius) const {
  cairo_new_path(pen());
  cairo_arc(pen(), x, y, radius, 0.0, 2.0 * M_PI);
  cairo_fill(pen());
}

void Canvas::ellipse(double x, double y, double a, double b, double angle) const {
  cairo_new_path(pen());
  cairo_save(pen());
  cairo_translate(pen(), x, y);
  cairo_rotate(pen(), angle);
  // Cairo splits an arc into more pieces the larger it is, without end, and refuses infinity for good.
  const auto drawable = [](double axis) { return axis > kMinAxis ? std::min(axis, kMaxAxis) : kMinAxis; };
  cairo_scale(pen(), drawable(a), drawable(b));
  cairo_arc(pen(), 0.0, 0.0, 1.0, 0.0, 2.0 * M_PI);
  cairo_restore(pen());
  cairo_stroke(pen());
}

void Canvas::text(double x, double y, const std::string& text, double size, bool bold) const {
  cairo_select_font_face(pen(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen(), size);
  cairo_move_to(pen(), x, y);
  cairo_show_text(pen(), text.c_str());
}

double Canvas::text_width(const std::string& text, double size, bool bold) const {
  cairo_select_font_face(pen(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen(), size);
  cairo_text_extents_t extents;
  cairo_text_extents(pen(), text.c_str(), &extents);
  return extents.x_advance;
}

}  // namespace pf::capture
