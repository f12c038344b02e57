#ifndef PLANEFOLD_CAPTURE_ANCHORS_H
#define PLANEFOLD_CAPTURE_ANCHORS_H

#include <planefold/planefold.h>

#include <string>
#include <vector>

#include "view.h"

namespace pf::capture {

/// Sets an anchor where the ray of a pixel of the last frame meets a plane. line: what has become of it, for the user.
void set_anchor(pf_slam_t* slam, const double pixel[2], bool metric, std::string& line);

std::vector<pf_anchor_t> read_anchors(const pf_slam_t* slam);

/// Rows of anchors.csv: every anchor of the map in which the camera is, in every frame.
constexpr const char* kAnchorsHeader = "frame,id,map,plane,qw,qx,qy,qz,px,py,pz";
void put_anchors(std::string& rows, const FrameView& view);

}  // namespace pf::capture

#endif
