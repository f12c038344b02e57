#ifndef PLANEFOLD_CAPTURE_PLAN_H
#define PLANEFOLD_CAPTURE_PLAN_H

#include <planefold/planefold.h>
#include <planefold_platform/walls.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "maths.h"

namespace pf::capture {

/// The walls of a plan that the run was given: how they get into the map, and what has become of them (lib/docs/walls.md).
class Plan {
 public:
  /// No path: no walls. false: error is one line.
  bool open(const std::string& path, std::string& error);
  bool empty() const { return walls_.count == 0; }
  int32_t count() const { return walls_.count; }

  /// Adds the walls to a context that was started, and says where gravity goes if the file does. false: error is one line.
  bool add_to(pf_slam_t* slam, std::string& error);

  /// For report.json: of each wall how far it has gone from the plan, and how well it is known now.
  nlohmann::ordered_json to_json(const pf_slam_t* slam) const;

  /// Corners in W, as the plan has them.
  std::vector<std::vector<Vec3>> outlines() const;

 private:
  pf_walls_t walls_{};
  std::vector<uint32_t> id_;  ///< of each wall in the map
};

}  // namespace pf::capture

#endif
