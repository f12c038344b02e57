#include "print_target.h"

#include <cairo-pdf.h>

#include <cstdio>
#include <memory>
#include <utility>

namespace pf::calibrate {

namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
constexpr double kMarginMm = 8.0;  ///< most printers leave less than this blank

struct FreeSurface {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct FreePen {
  void operator()(cairo_t* pen) const { cairo_destroy(pen); }
};

bool page_size(const std::string& page, double& width_mm, double& height_mm) {
  if (page == "a4") {
    width_mm = 210.0, height_mm = 297.0;
  } else if (page == "a3") {
    width_mm = 297.0, height_mm = 420.0;
  } else if (page == "letter") {
    width_mm = 215.9, height_mm = 279.4;
  } else {
    char rest = 0;
    return std::sscanf(page.c_str(), "%lfx%lf%c", &width_mm, &height_mm, &rest) == 2 && width_mm >= 50.0 &&
           height_mm >= 50.0 && width_mm <= 5000.0 && height_mm <= 5000.0;
  }
  return true;
}

void draw_squares(cairo_t* pen, const Board& board, double left_mm, double top_mm) {
  const double square_mm = 1000.0 * board.square_m;
  for (int y = 0; y < board.rows; ++y) {
    for (int x = y % 2; x < board.columns; x += 2) {
      cairo_rectangle(pen, left_mm + x * square_mm, top_mm + y * square_mm, square_mm, square_mm);
    }
  }
  cairo_fill(pen);
}

void draw_ruler(cairo_t* pen, const Board& board, double page_width_mm, double y_mm) {
  char text[160];
  std::snprintf(text, sizeof(text), "--board %dx%d:%g    print at 100 %%; this line is 100 mm long:", board.columns,
                board.rows, board.square_m);
  cairo_select_font_face(pen, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen, 2.6);
  cairo_text_extents_t extents;
  cairo_text_extents(pen, text, &extents);
  const bool beside = page_width_mm > extents.x_advance + 104.0 + 2.0 * kMarginMm;
  const double left = beside ? page_width_mm - kMarginMm - 100.0 : 0.5 * (page_width_mm - 100.0);
  cairo_move_to(pen, beside ? left - 3.0 - extents.x_advance : left, beside ? y_mm + 0.9 : y_mm - 1.8);
  cairo_show_text(pen, text);
  cairo_set_line_width(pen, 0.2);
  for (int tick = 0; tick <= 10; ++tick) {
    const double half = tick % 5 == 0 ? 1.5 : 0.8;
    cairo_move_to(pen, left + 10.0 * tick, y_mm - half);
    cairo_line_to(pen, left + 10.0 * tick, y_mm + half);
  }
  cairo_move_to(pen, left, y_mm);
  cairo_line_to(pen, left + 100.0, y_mm);
  cairo_stroke(pen);
}

}  // namespace

bool print_target(const Board& board, const std::string& page, const std::string& path, std::string& error) {
  double width_mm = 0.0, height_mm = 0.0;
  if (!page_size(page, width_mm, height_mm)) {
    error = "page '" + page + "': write a4, a3, letter, or WIDTHxHEIGHT in millimetres";
    return false;
  }
  if ((board.width_m() > board.height_m()) != (width_mm > height_mm)) {
    std::swap(width_mm, height_mm);
  }
  const double left = 0.5 * (width_mm - 1000.0 * board.width_m());
  const double top = 0.5 * (height_mm - 1000.0 * board.height_m());
  if (left < kMarginMm || top < kMarginMm + 4.0) {
    char text[200];
    std::snprintf(text, sizeof(text),
                  "a board of %.0f x %.0f mm does not fit on %.0f x %.0f mm with its white margin; take smaller or "
                  "fewer squares, or a larger --page",
                  1000.0 * board.width_m(), 1000.0 * board.height_m(), width_mm, height_mm);
    error = text;
    return false;
  }
  const std::unique_ptr<cairo_surface_t, FreeSurface> surface(
      cairo_pdf_surface_create(path.c_str(), width_mm * kPointsPerMm, height_mm * kPointsPerMm));
  const std::unique_ptr<cairo_t, FreePen> pen(cairo_create(surface.get()));
  cairo_scale(pen.get(), kPointsPerMm, kPointsPerMm);
  draw_squares(pen.get(), board, left, top);
  draw_ruler(pen.get(), board, width_mm, height_mm - 6.0);
  cairo_show_page(pen.get());
  cairo_surface_finish(surface.get());
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) {
    error = path + ": cannot be written: " + cairo_status_to_string(cairo_surface_status(surface.get()));
    return false;
  }
  return true;
}

}  // namespace pf::calibrate
