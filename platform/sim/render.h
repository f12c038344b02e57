#pragma once

#include <cstdint>
#include <vector>

#include "planefold/planefold.h"
#include "sim/scene.h"

namespace pf::sim {

/// Draws scenes by casting precomputed rays: `samples` x `samples` a pixel, each with a footprint of its own share of the
/// pixel. Tiles of the image keep short lists of what can be seen in them.
class Renderer {
 public:
  /// False from `ok` when the camera model has no ray for some pixel of the image.
  Renderer(const pf_camera_t& camera, int samples);
  bool ok() const { return ok_; }

  /// Add the grey levels of one view, times `weight`, to `sum` (width x height).
  /// row_poses: one pose for the whole image, or one for each row (rolling readout).
  void render(const Scene& scene, const std::vector<Pose>& row_poses, float weight, std::vector<float>& sum) const;

  bool one_by_one = false;  ///< samples by themselves, not by fours: the same to the bit, and slower

  /// Exact depth along z_C [m] (0: nothing) and index of the quad (-1: nothing) at the centres of the pixels.
  void truth(const Scene& scene, const Pose& pose, std::vector<float>* depth, std::vector<std::int32_t>* quad) const;

 private:
  struct Ray {
    float x, y, z;  // unit, in C
    float angle;    // to the next sample [rad]
  };
  struct Tile {
    Vec3 edge[4];  // normals of the four planes that hold the tile's rays
    double slack;  // every ray has edge . ray >= -slack
  };
  /// Camera in the frame of a quad: ray and centre.
  struct View {
    float R[9];
    float o[3];
    float width, height;
  };

  /// Grey level along a ray, and along four of them: the same to the bit.
  static float look_once(const Scene& scene, const std::vector<View>& views, const std::vector<int>& list,
                         const Ray& ray);
  static Four look(const Scene& scene, const std::vector<View>& views, const std::vector<int>& list, const Ray* rays);

  void cull(const Scene& scene, const Pose& pose, double extra_slack, int tile_row,
            std::vector<std::vector<int>>& lists) const;

  static constexpr int kTile = 16;

  int width_, height_, samples_;
  int tiles_x_, tiles_y_;
  bool ok_ = true;
  double pixel_angle_;
  std::vector<Ray> rays_;
  std::vector<Vec3> centre_rays_;
  std::vector<Tile> tiles_;
};

/// Whether (u, v) of a quad of size w x h belongs to the shape.
bool inside_shape(Shape shape, float u, float v, float w, float h);

}  // namespace pf::sim
