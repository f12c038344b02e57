#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "outputs.h"

namespace pf::calibrate {

namespace {

constexpr double kEnlarged = 50.0;
constexpr double kFooter = 46.0;

struct FreeSurface {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct FreePen {
  void operator()(cairo_t* pen) const { cairo_destroy(pen); }
};

/// Cells without a corner stay dark: there the calibration extrapolates.
void draw_cells(cairo_t* pen, const std::vector<View>& views, cv::Size image) {
  const auto counts = count_corners(views, image);
  const double most = std::max(1, *std::max_element(counts.begin(), counts.end()));
  const double width = static_cast<double>(image.width) / kCellsAcross;
  const double height = static_cast<double>(image.height) / kCellsDown;
  for (int y = 0; y < kCellsDown; ++y) {
    for (int x = 0; x < kCellsAcross; ++x) {
      const int count = counts[static_cast<size_t>(y * kCellsAcross + x)];
      if (count == 0) {
        continue;
      }
      const double level = 0.25 + 0.35 * std::sqrt(count / most);
      cairo_set_source_rgb(pen, 0.12 * level, 0.55 * level, 0.75 * level);
      cairo_rectangle(pen, x * width + 0.5, y * height + 0.5, width - 1.0, height - 1.0);
      cairo_fill(pen);
    }
  }
}

void draw_residuals(cairo_t* pen, const std::vector<FittedView>& views) {
  for (const FittedView& fitted : views) {
    for (size_t i = 0; i < fitted.residuals.size(); ++i) {
      const cv::Point2f& at = fitted.view.corners[i];
      const cv::Point2f& by = fitted.residuals[i];
      cairo_set_source_rgb(pen, 1.0, 0.78, 0.35);
      cairo_move_to(pen, at.x, at.y);
      cairo_line_to(pen, at.x + kEnlarged * by.x, at.y + kEnlarged * by.y);
      cairo_stroke(pen);
      cairo_set_source_rgb(pen, 0.95, 0.95, 0.95);
      cairo_arc(pen, at.x, at.y, 1.1, 0.0, 6.2832);
      cairo_fill(pen);
    }
  }
}

}  // namespace

bool draw_coverage(const std::string& path, const Fit& fit, std::string& error) {
  const cv::Size image(fit.camera.width, fit.camera.height);
  const std::unique_ptr<cairo_surface_t, FreeSurface> surface(cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, std::max(image.width, 480), image.height + static_cast<int>(kFooter)));
  const std::unique_ptr<cairo_t, FreePen> pen(cairo_create(surface.get()));
  cairo_set_source_rgb(pen.get(), 0.07, 0.08, 0.10);
  cairo_paint(pen.get());
  std::vector<View> views;
  for (const FittedView& fitted : fit.views) {
    views.push_back(fitted.view);
  }
  draw_cells(pen.get(), views, image);
  cairo_set_line_width(pen.get(), 0.8);
  draw_residuals(pen.get(), fit.views);

  char text[200];
  cairo_select_font_face(pen.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen.get(), 13.0);
  cairo_set_source_rgb(pen.get(), 0.90, 0.92, 0.95);
  std::snprintf(text, sizeof(text), "%zu views, %.0f %% of the picture, reprojection error %.3f px", fit.views.size(),
                100.0 * covered_share(views, image), fit.rms_px);
  cairo_move_to(pen.get(), 8.0, image.height + 18.0);
  cairo_show_text(pen.get(), text);
  std::snprintf(text, sizeof(text),
                "dots: corners   lines: their distance from the fit, %.0f times enlarged   dark: never seen",
                kEnlarged);
  cairo_move_to(pen.get(), 8.0, image.height + 37.0);
  cairo_show_text(pen.get(), text);
  if (cairo_surface_write_to_png(surface.get(), path.c_str()) != CAIRO_STATUS_SUCCESS) {
    error = path + ": cannot be written; check the folder and the space on its disk";
    return false;
  }
  return true;
}

}  // namespace pf::calibrate
