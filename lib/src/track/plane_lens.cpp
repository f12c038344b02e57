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
      reference_[at] = (pinhole - pixel).cast<float>();
    }
  return true;
}

bool PlaneLens::set_image(const Camera& camera, const Mat3& H) {
  for (int at = 0; at < nodes_ * nodes_; ++at) {
    const Vec3 p = H * Vec3(ray_[at].x(), ray_[at].y(), 1);
    Vec2 pixel;
    if (!(p.z() > Scalar(0)) || !project(camera, p, &pixel)) return false;
    const Vec2 pinhole(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
    image_[at] = (pixel - pinhole).cast<float>();
  }
  return true;
}

/// Bilinear, less what the bend of the function between two nodes adds: f(1 - f)/2 times its second difference, in each direction.
Eigen::Vector2f PlaneLens::at(const Eigen::Vector2f* node, const Cell& cell, float* J) const {
  const int i = cell.node % nodes_, j = cell.node / nodes_;
  const Eigen::Vector2f* at = node + cell.node;
  const auto bend = [this](const Eigen::Vector2f* from, int index, int step) {
    // At the nodes of both ends, or at the next ones that have neighbours.
    const auto second = [&](int k) -> Eigen::Vector2f {
      const int inner = k < 1 ? 1 : k > nodes_ - 2 ? nodes_ - 2 : k;
      const Eigen::Vector2f* c = from + (inner - index) * step;
      return c[step] - 2.0f * c[0] + c[-step];
    };
    if (nodes_ < 3) return Eigen::Vector2f(0.0f, 0.0f);
    return Eigen::Vector2f(0.5f * (second(index) + second(index + 1)));
  };
  const float fx = cell.fx, fy = cell.fy;
  const Eigen::Vector2f xx = bend(at, i, 1), yy = bend(at, j, nodes_);
  const Eigen::Vector2f left = at[1] - at[0], lower = at[nodes_ + 1] - at[nodes_];
  const Eigen::Vector2f above = at[0] + fx * left, below = at[nodes_] + fx * lower;
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
