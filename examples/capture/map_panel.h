#ifndef PLANEFOLD_CAPTURE_MAP_PANEL_H
#define PLANEFOLD_CAPTURE_MAP_PANEL_H

#include <array>
#include <map>
#include <vector>

#include "canvas.h"
#include "maths.h"
#include "session.h"
#include "view.h"

namespace pf::capture {

/// The map from above: points with their 1-sigma ellipses, the path, the camera with the 3-sigma ellipse of its position.
///
/// "Above" is fixed at the first pose: of the world's axes, the one nearest to the camera's y axis points down, and the one
/// nearest to its z axis points up on the page, so that left is left whichever way the world's axes run.
class MapPanel {
 public:
  explicit MapPanel(const Session& session) : session_(session) {}

  void add(const FrameView& view);
  void draw(const Canvas& canvas, const FrameView& view, double x, double y, double width, double height);

 private:
  struct Window {
    double right = 0.0, forward = 0.0, half = 1.0;  ///< what the panel shows: centre and half side, in W
  };

  static constexpr size_t kMaxPath = 8192;

  void remember(const Vec3& place);
  void choose_axes(const pf_pose_t& pose);
  Window fit(const FrameView& view) const;
  void draw_scale(const Canvas& canvas, double x, double y, double width, double height, double pixels_per_unit) const;
  void draw_camera(const Canvas& canvas, const FrameView& view, const std::array<double, 2>& at,
                   double pixels_per_unit) const;

  const Session& session_;
  bool has_axes_ = false;
  Vec3 right_{}, forward_{};
  std::vector<Vec3> path_;  ///< every stride_-th place, and the newest
  int64_t stride_ = 1, since_ = 0;
  Window window_;
  bool has_window_ = false;
};

}  // namespace pf::capture

#endif
