#ifndef PLANEFOLD_CAPTURE_PLANE_DRAWING_H
#define PLANEFOLD_CAPTURE_PLANE_DRAWING_H

#include "canvas.h"
#include "view.h"

namespace pf::capture {

/// Draws the planes of a frame into its picture: filled, with a grid that lies on them, outlined, and with their numbers.
///
/// zoom    screen pixels per image pixel
/// metric  lengths of the world are metres, so that areas can be told
/// plan    corners of walls as a plan has them, in thin lines; the walls themselves, where they are now, get thick ones
void draw_planes(const Canvas& canvas, const FrameView& view, const pf_camera_t& camera, double zoom, bool metric,
                 const std::vector<std::vector<Vec3>>& plan);

}  // namespace pf::capture

#endif
