#include "track/plane_lens.h"

namespace pf {

bool PlaneLens::set_reference(const Camera& camera, const PlanePatch& patch) {
  nodes_ = (patch.side - 2) / kStep + 2;
  for (int j = 0; j < nodes_; ++j)
    for (int i = 0; i < nodes_; ++i) {
      const Vec2 pixel(patch.left + kStep * i, patch.top + kStep * j);
      Vec3 ray;
      if (!unproject(camera, pixel, &ray) || !(ray.z() > Scalar(0))) return false;
      const int at = j * nodes_ + i;
      ray_[at] = Vec2(ray.x() / ray.z(), ray.y() / ray.z());
      const Vec2 pinhole(camera.fx * ray_[at].x() + camera.cx, camera.fy * ray_[at].y() + camera.cy);
      reference_[at].value = (pinhole - pixel).cast<float>();
    }
  bend(reference_);
  return true;
}

bool PlaneLens::set_image(const Camera& camera, const Mat3& H) {
  for (int at = 0; at < nodes_ * nodes_; ++at) {
    const Vec3 p = H * Vec3(ray_[at].x(), ray_[at].y(), 1);
    Vec2 pixel;
    if (!(p.z() > Scalar(0)) || !project(camera, p, &pixel)) return false;
    const Vec2 pinhole(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
    image_[at].value = (pixel - pinhole).cast<float>();
  }
  bend(image_);
  return true;
}

/// Second differences of a cell, the mean of those at its ends; at the border those of the next nodes that have neighbours.
void PlaneLens::bend(Node* node) const {
  const auto second = [&](const Node* row, int k, int step) -> Eigen::Vector2f {
    const int inner = k < 1 ? 1 : k > nodes_ - 2 ? nodes_ - 2 : k;
    const Node* c = row + inner * step;
    return c[step].value - 2.0f * c[0].value + c[-step].value;
  };
  for (int j = 0; j + 1 < nodes_; ++j)
    for (int i = 0; i + 1 < nodes_; ++i) {
      Node& cell = node[j * nodes_ + i];
      cell.xx.setZero();
      cell.yy.setZero();
      if (nodes_ < 3) continue;
      const Node *row = node + j * nodes_, *column = node + i;
      cell.xx = 0.5f * (second(row, i, 1) + second(row, i + 1, 1));
      cell.yy = 0.5f * (second(column, j, nodes_) + second(column, j + 1, nodes_));
    }
}

/// Bilinear, less what the bend of the function between two nodes adds: f(1 - f)/2 times its second difference, in each direction.
Eigen::Vector2f PlaneLens::at(const Node* node, const Cell& cell, float* J) const {
  const Node *at = node + cell.node, *next = at + nodes_;
  const float fx = cell.fx, fy = cell.fy;
  const Eigen::Vector2f &xx = at->xx, &yy = at->yy;
  const Eigen::Vector2f left = at[1].value - at[0].value, lower = next[1].value - next[0].value;
  const Eigen::Vector2f above = at[0].value + fx * left, below = next[0].value + fx * lower;
  if (J != nullptr) {
    const float per_px = 1.0f / static_cast<float>(kStep);
    const Eigen::Vector2f by_x = (left + fy * (lower - left) - (0.5f - fx) * xx) * per_px;
    const Eigen::Vector2f by_y = (below - above - (0.5f - fy) * yy) * per_px;
    J[0] = by_x.x();
    J[1] = by_y.x();
    J[2] = by_x.y();
    J[3] = by_y.y();
  }
  return above + fy * (below - above) - 0.5f * (fx * (1.0f - fx) * xx + fy * (1.0f - fy) * yy);
}

}  // namespace pf
