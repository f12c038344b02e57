#ifndef PLANEFOLD_CAPTURE_PLAN_H
#define PLANEFOLD_CAPTURE_PLAN_H

#include <planefold/planefold.h>
#include <planefold_platform/walls.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "maths.h"
#include "rejections.h"
#include "view.h"

namespace pf::capture {

/// The walls of a plan that the run was given: how they get into the map, and what has become of them (lib/docs/theory/walls.md).
class Plan {
 public:
  /// No path: no walls. tell_depths: nothing else says how far away the first features are. false: error is one line.
  bool open(const std::string& path, bool tell_depths, std::string& error);
  bool empty() const { return walls_.count == 0; }
  int32_t count() const { return walls_.count; }

  /// Adds the walls to a context that was started, and says where gravity goes if the file does. false: error is one line.
  bool add_to(pf_slam_t* slam, std::string& error);

  /// One line about a wall whose middle the camera sees from its back side, with no other wall before it: the plan has it the wrong way
  /// round, or lacks what hides it. Once for each wall; or, at the first pose, that no wall is in view that could tell depths. false: there
  /// is none.
  bool take_notice(const FrameView& view, const pf_camera_t& camera, std::string& line);

  /// Walls that the pictures contradict, or that went with the map.
  void add_rejections(const pf_slam_t* slam, std::vector<Rejection>& rejections) const;

  /// For report.json: of each wall how far it has gone from the plan, and how well it is known now.
  nlohmann::ordered_json to_json(const pf_slam_t* slam) const;

  /// Corners in W, as the plan has them.
  std::vector<std::vector<Vec3>> outlines() const;

 private:
  pf_walls_t walls_{};
  std::vector<uint32_t> id_;  ///< of each wall in the map
  std::vector<bool> told_;    ///< of each wall, that it is seen from behind
  bool must_see_wall_ = false;
  bool told_size_ = false;  ///< of walls that are too large
};

}  // namespace pf::capture

#endif
