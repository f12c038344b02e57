#include "print_target.h"

#include <cairo-pdf.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include "markers.h"

namespace pf::calibrate {

namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
constexpr double kPixelsPerMm = 10.0;
constexpr double kMarginMm = 8.0;  ///< most printers leave less than this blank

struct FreeSurface {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct FreePen {
  void operator()(cairo_t* pen) const { cairo_destroy(pen); }
};

void draw_squares(cairo_t* pen, const Board& board, double left_mm, double top_mm) {
  const double square_mm = 1000.0 * board.square_m;
  for (int y = 0; y < board.rows; ++y) {
    for (int x = y % 2; x < board.columns; x += 2) {
      cairo_rectangle(pen, left_mm + x * square_mm, top_mm + y * square_mm, square_mm, square_mm);
    }
  }
  cairo_fill(pen);
}

/// The dark modules of all markers as one path, so that no seams show between them.
void draw_markers(cairo_t* pen, const Board& board, double left_mm, double top_mm) {
  const double square_mm = 1000.0 * board.square_m, marker_mm = kMarkerShare * square_mm;
  for (int number = 0; number < board.markers(); ++number) {
    const cv::Mat modules = marker_modules(board, number);
    const cv::Point square = square_of_marker(board, number);
    const double module_mm = marker_mm / modules.cols, margin_mm = 0.5 * (square_mm - marker_mm);
    const double x0 = left_mm + square.x * square_mm + margin_mm, y0 = top_mm + square.y * square_mm + margin_mm;
    for (int y = 0; y < modules.rows; ++y) {
      for (int x = 0, end = 0; x < modules.cols; x = end + 1) {
        for (end = x; end < modules.cols && modules.at<uchar>(y, end) == 0; ++end) {
        }
        if (end > x) {
          cairo_rectangle(pen, x0 + x * module_mm, y0 + y * module_mm, (end - x) * module_mm, module_mm);
        }
      }
    }
  }
  cairo_fill(pen);
}

void draw_ruler(cairo_t* pen, const Board& board, double page_width_mm, double y_mm) {
  char text[200];
  const std::string markers = board.target == Target::kCharuco ? std::string(", ") + dictionary_name(board) : "";
  std::snprintf(text, sizeof(text),
                "--target %s --board %s%s    print at 100 %%; this line is 100 mm long:", target_name(board.target),
                board_text(board).c_str(), markers.c_str());
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

bool is_png(const std::string& path) { return path.size() >= 4 && path.compare(path.size() - 4, 4, ".png") == 0; }

void draw_page(cairo_t* pen, const Board& board, double width_mm, double height_mm) {
  const double left_mm = 0.5 * (width_mm - 1000.0 * board.width_m());
  const double top_mm = 0.5 * (height_mm - 1000.0 * board.height_m());
  cairo_set_source_rgb(pen, 0.0, 0.0, 0.0);
  draw_squares(pen, board, left_mm, top_mm);
  if (board.target == Target::kCharuco) {
    draw_markers(pen, board, left_mm, top_mm);
  }
  draw_ruler(pen, board, width_mm, height_mm - 6.0);
}

/// cairo's own text where it failed, else null.
const char* write_pdf(const Board& board, double width_mm, double height_mm, const std::string& path) {
  const std::unique_ptr<cairo_surface_t, FreeSurface> surface(
      cairo_pdf_surface_create(path.c_str(), width_mm * kPointsPerMm, height_mm * kPointsPerMm));
  const std::unique_ptr<cairo_t, FreePen> pen(cairo_create(surface.get()));
  cairo_scale(pen.get(), kPointsPerMm, kPointsPerMm);
  draw_page(pen.get(), board, width_mm, height_mm);
  cairo_show_page(pen.get());
  cairo_surface_finish(surface.get());
  const cairo_status_t status = cairo_surface_status(surface.get());
  return status == CAIRO_STATUS_SUCCESS ? nullptr : cairo_status_to_string(status);
}

const char* write_png(const Board& board, double width_mm, double height_mm, const std::string& path) {
  const std::unique_ptr<cairo_surface_t, FreeSurface> surface(cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, static_cast<int>(width_mm * kPixelsPerMm), static_cast<int>(height_mm * kPixelsPerMm)));
  const std::unique_ptr<cairo_t, FreePen> pen(cairo_create(surface.get()));
  cairo_set_source_rgb(pen.get(), 1.0, 1.0, 1.0);
  cairo_paint(pen.get());
  cairo_scale(pen.get(), kPixelsPerMm, kPixelsPerMm);
  draw_page(pen.get(), board, width_mm, height_mm);
  const cairo_status_t status = cairo_surface_write_to_png(surface.get(), path.c_str());
  return status == CAIRO_STATUS_SUCCESS ? nullptr : cairo_status_to_string(status);
}

}  // namespace

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

bool print_target(const Board& board, const std::string& page, const std::string& path, std::string& error) {
  double width_mm = 0.0, height_mm = 0.0;
  if (!page_size(page, width_mm, height_mm)) {
    error = "page '" + page + "': is none that is known";
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
  std::error_code failed;
  if (std::filesystem::exists(std::filesystem::symlink_status(path, failed))) {
    error = "'" + path + "' exists and is left as it is; give another name, or remove it";
    return false;
  }
  const char* failure =
      is_png(path) ? write_png(board, width_mm, height_mm, path) : write_pdf(board, width_mm, height_mm, path);
  if (failure != nullptr) {
    error = path + ": cannot be written (" + failure + "); check the folder and the space on its disk";
    return false;
  }
  return true;
}

}  // namespace pf::calibrate
