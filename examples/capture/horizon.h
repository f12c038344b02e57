#ifndef PLANEFOLD_CAPTURE_HORIZON_H
#define PLANEFOLD_CAPTURE_HORIZON_H

#include "canvas.h"
#include "view.h"

namespace pf::capture {

/// Draws the horizon, where all level directions end, and an arrow towards which gravity points, in the corner below; nothing where
/// gravity is not known.
///
/// zoom    screen pixels per image pixel
/// height  of the drawn frame [px of the screen]
void draw_horizon(const Canvas& canvas, const FrameView& view, double zoom, double height);

}  // namespace pf::capture

#endif
