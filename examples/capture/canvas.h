#ifndef PLANEFOLD_CAPTURE_CANVAS_H
#define PLANEFOLD_CAPTURE_CANVAS_H

#include <cairo.h>

#include <memory>
#include <string>

namespace pf::capture {

struct Colour {
  double r, g, b;
};

/// One colour for one meaning, on the image and on the map.
namespace colours {
constexpr Colour kPoint{0.21, 0.86, 0.50};         ///< inlier, 3-D point
constexpr Colour kInverseDepth{0.30, 0.68, 1.00};  ///< inlier, inverse depth
constexpr Colour kOutlier{1.00, 0.33, 0.33};
constexpr Colour kMissed{1.00, 0.70, 0.22};
constexpr Colour kNew{1.00, 0.95, 0.45};
constexpr Colour kTarget{0.93, 0.42, 0.88};
constexpr Colour kText{0.90, 0.92, 0.95};
constexpr Colour kDim{0.52, 0.57, 0.64};
constexpr Colour kGround{0.075, 0.090, 0.115};
constexpr Colour kGrid{0.16, 0.19, 0.23};
constexpr Colour kPath{0.98, 0.98, 0.98};
}  // namespace colours

/// A picture in memory and the pen on it: BGRX bytes, which is what the film and the window take.
class Canvas {
 public:
  Canvas(int width, int height);

  cairo_t* pen() const { return pen_.get(); }
  int width() const { return width_; }
  int height() const { return height_; }
  int stride() const { return cairo_image_surface_get_stride(surface_.get()); }
  /// Finished pixels.
  const unsigned char* pixels() const;
  bool save_png(const std::string& path) const;

  void colour(const Colour& c, double alpha = 1.0) const { cairo_set_source_rgba(pen(), c.r, c.g, c.b, alpha); }
  void rectangle(double x, double y, double w, double h, const Colour& c, double alpha = 1.0) const;
  void line(double x0, double y0, double x1, double y1) const;
  void dot(double x, double y, double radius) const;
  /// Outline of an ellipse with half axes a, b; angle of a from x towards y.
  void ellipse(double x, double y, double a, double b, double angle) const;
  void text(double x, double y, const std::string& text, double size, bool bold = false) const;
  double text_width(const std::string& text, double size, bool bold = false) const;

 private:
  struct FreeSurface {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  };
  struct FreePen {
    void operator()(cairo_t* pen) const { cairo_destroy(pen); }
  };
  int width_, height_;
  std::unique_ptr<cairo_surface_t, FreeSurface> surface_;
  std::unique_ptr<cairo_t, FreePen> pen_;
};

}  // namespace pf::capture

#endif
