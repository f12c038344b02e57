#pragma once

#include <planefold/planefold.h>

#include <CLI/CLI.hpp>
#include <string>

namespace pfsim {

/// Which motion model the library has in an experiment: --motion, and its noise where another than the default is asked for.
struct MotionOption {
  std::string name = "velocity";
  double linear = 0, angular = 0;  ///< 0: the library's

  void add_to(CLI::App& command) {
    command.add_option("--motion", name, "velocity or acceleration: what stays the same between frames")
        ->check(CLI::IsMember({"velocity", "acceleration"}))
        ->capture_default_str();
    command.add_option(
        "--linear-density", linear,
        "white acceleration [m/s^2/sqrt(Hz)], or white jerk [m/s^3/sqrt(Hz)] with --motion acceleration");
    command.add_option("--angular-density", angular, "white angular acceleration [rad/s^2/sqrt(Hz)]");
  }
  void apply(pf_config_t& config) const {
    const bool accelerates = name == "acceleration";
    config.motion.model = accelerates ? PF_MOTION_CONSTANT_ACCELERATION : PF_MOTION_CONSTANT_VELOCITY;
    double& density = accelerates ? config.motion.linear_jerk_density : config.motion.linear_acceleration_density;
    if (linear > 0) density = linear;
    if (angular > 0) config.motion.angular_acceleration_density = angular;
  }
};

}  // namespace pfsim
