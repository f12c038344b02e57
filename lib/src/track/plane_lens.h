#pragma once

#include "geometry/camera.h"
#include "vision/plane_patch.h"

namespace pf {

/// What a lens adds to the pixels of a pinhole with the same focal lengths and centre, over a patch: exact at nodes 8 px apart in the
/// patch and interpolated between them to second order. Nothing for a pinhole.
class PlaneLens {
 public:
  static constexpr int kStep = 8;  ///< [px] of level 0
  static constexpr int kMaxNodes = PlanePatch::kMaxSide / kStep + 1;

  static bool is_pinhole(const Camera& camera) {
    return static_cast<CameraModel>(camera.model) == CameraModel::kPinhole;
  }

  /// Pixel x of the patch's image -> pixel of the pinhole, less x. False where the lens has no ray.
  bool set_reference(const Camera& camera, const PlanePatch& patch);
  /// Pixel of the pinhole that a ray H (m, 1) has -> pixel of the image, less that one. Needs set_reference with the same patch.
  /// False where a node does not project.
  bool set_image(const Camera& camera, const Mat3& H);

  struct Cell {
    int node;      ///< of the smallest coordinates
    float fx, fy;  ///< place in the cell
  };
  /// Of a place in the patch, from the centre of its first pixel [px of level 0].
  Cell cell_of(float x, float y) const {
    const int i = index_of(x), j = index_of(y);
    return {j * nodes_ + i, x / kStep - static_cast<float>(i), y / kStep - static_cast<float>(j)};
  }
  /// Interpolated; J (null to skip) its derivative by the place, row by row.
  Eigen::Vector2f reference_at(const Cell& cell, float* J = nullptr) const { return at(reference_, cell, J); }
  Eigen::Vector2f image_at(const Cell& cell) const { return at(image_, cell, nullptr); }

 private:
  int index_of(float x) const {
    const int i = static_cast<int>(x) / kStep;
    return i < nodes_ - 2 ? i : nodes_ - 2;
  }
  /// At a node: the value, and of the cell that begins there the second differences in x and in y.
  struct Node {
    Eigen::Vector2f value, xx, yy;
  };
  void bend(Node* node) const;
  Eigen::Vector2f at(const Node* node, const Cell& cell, float* J) const;

  int nodes_ = 2;                    ///< in each direction
  Vec2 ray_[kMaxNodes * kMaxNodes];  ///< of the reference, at depth 1
  Node reference_[kMaxNodes * kMaxNodes], image_[kMaxNodes * kMaxNodes];
};

}  // namespace pf
