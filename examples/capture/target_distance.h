#ifndef PLANEFOLD_CAPTURE_TARGET_DISTANCE_H
#define PLANEFOLD_CAPTURE_TARGET_DISTANCE_H

#include <planefold/planefold.h>

#include <string>

namespace pf::capture {

/// One line where a target puts the camera so far away that its lengths are hardly metres, with what to type; else "".
/// start  as the user gave it: "rectangle:183x129" or "target:FILE"
/// pose   of a tracked frame
std::string doubt_of_target(const pf_target_t& target, const std::string& start, const pf_pose_t& pose);

}  // namespace pf::capture

#endif
