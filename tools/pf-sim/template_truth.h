#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "planefold_platform/sim.h"
#include "sim/linear.h"

namespace pfsim {

/// What the pixels of a template show, and what its mask should say.
class TemplateTruth {
 public:
  TemplateTruth(const pf_sim_t* sim, const pf_camera_t& camera);

  /// Looks at a frame in which templates begin, or are judged.
  void look(const pf_pose_t& pose);

  struct Patch {
    pf_pose_t pose = {};  ///< of the frame in which it began
    int left = 0, top = 0, side = 0;
    std::vector<float> depth;           ///< along z [m]; 0: nothing
    std::vector<std::int32_t> surface;  ///< one number for all that lie in a plane; -1: nothing
    bool straddles = false;             ///< two surfaces with at least 12 pixels each
  };
  /// Of the frame that look() saw. Pixels outside of the image show nothing.
  Patch cut(const double centre_px[2], int side) const;

  struct Agreement {
    int pixels = 0;
    double mask = 0, all_on = 0, surface = 0;  ///< shares of pixels that are right
    int visible_pixels = 0;
    double visible = 0;
  };
  /// Of the frame that look() saw. A pixel is on the plane if its place is in it within 1 px of where the dominant plane puts it. The
  /// dominant plane is that of the template's surfaces, with at least 12 pixels, which the feature's point is nearest to.
  ///
  /// mask     a pixel is right where the mask's probability of 1/2 says so
  /// all_on   likewise with all pixels on
  /// surface  the mask against the number of the surface alone
  /// visible  as mask, of pixels whose place is not hidden by something nearer
  /// pixels 0: there is no such plane
  Agreement judge(const Patch& patch, const pf_template_t& mask, const double p_W[3]) const;

 private:
  std::int32_t plane_of(std::int32_t surface) const;
  bool is_hidden(const pf::sim::Vec3& p_W, const double pixel[2]) const;

  const pf_sim_t* sim_;
  pf_camera_t camera_;
  pf_pose_t pose_ = {};
  std::vector<float> depth_;
  std::vector<std::int32_t> surface_;
  std::vector<std::array<double, 4>> planes_;  ///< n and d of each surface
  std::vector<std::int32_t> same_;             ///< first surface in the same plane
};

}  // namespace pfsim
