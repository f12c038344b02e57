#include "sim/render.h"

#include <algorithm>
#include <cmath>

namespace pf::sim {
namespace {

constexpr float kBackground = 90;
constexpr float kGrazing = 1e-4f;  // cosine from which on a surface is seen

std::size_t index(int a) { return static_cast<std::size_t>(a); }

}  // namespace

bool inside_shape(Shape shape, float u, float v, float w, float h) {
  if (u < 0 || v < 0 || u > w || v > h) return false;
  if (shape == Shape::kRectangle) return true;
  // A head on shoulders that taper down.
  const float x = u / w - 0.5f, y = v / h;
  if (y < 0.15f) return x * x / (0.16f * 0.16f) + (y - 0.08f) * (y - 0.08f) / (0.08f * 0.08f) < 1;
  const float half = y < 0.2f ? 0.10f + 8.0f * (y - 0.15f) : 0.5f - 0.2f * (y - 0.2f);
  return std::fabs(x) < std::min(half, 0.5f);
}

Renderer::Renderer(const pf_camera_t& camera, int samples)
    : width_(camera.width),
      height_(camera.height),
      samples_(samples),
      tiles_x_((camera.width + kTile - 1) / kTile),
      tiles_y_((camera.height + kTile - 1) / kTile),
      pixel_angle_(1.0 / std::min(camera.fx, camera.fy)),
      rays_(index(width_) * index(height_) * index(samples * samples)),
      centre_rays_(index(width_) * index(height_)),
      tiles_(index(tiles_x_) * index(tiles_y_)) {
  // Asking the model is expensive, so it is asked at the pixels' centres only, and at one more all around the image.
  const int lattice_width = width_ + 2;
  std::vector<Vec3> lattice(index(lattice_width) * index(height_ + 2));
  const auto at = [&](int i, int j) -> Vec3& { return lattice[index(j + 1) * index(lattice_width) + index(i + 1)]; };
  const auto ask = [&](int i, int j) {
    const double pixel[2] = {static_cast<double>(i), static_cast<double>(j)};
    double ray[3] = {0, 0, 1};
    const bool given = pf_camera_unproject(&camera, pixel, ray) == PF_OK;
    at(i, j) = {ray[0], ray[1], ray[2]};
    return given;
  };
  for (int j = 0; j < height_; ++j)
    for (int i = 0; i < width_; ++i) ok_ = ask(i, j) && ok_;
  // Around the image there may be no rays; the last two go on straight then.
  for (int i = 0; i < width_; ++i) {
    if (!ask(i, -1)) at(i, -1) = at(i, 0) * 2 - at(i, 1);
    if (!ask(i, height_)) at(i, height_) = at(i, height_ - 1) * 2 - at(i, height_ - 2);
  }
  for (int j = -1; j <= height_; ++j) {
    if (!ask(-1, j)) at(-1, j) = at(0, j) * 2 - at(1, j);
    if (!ask(width_, j)) at(width_, j) = at(width_ - 1, j) * 2 - at(width_ - 2, j);
  }
  // In between, to second order from the neighbours: what is left out is of the order of (1 / (4 f))^3 radian.
  for (int j = 0; j < height_; ++j)
    for (int i = 0; i < width_; ++i) {
      const std::size_t pixel = index(j) * index(width_) + index(i);
      const Vec3 c = at(i, j), dx = (at(i + 1, j) - at(i - 1, j)) * 0.5, dy = (at(i, j + 1) - at(i, j - 1)) * 0.5;
      const Vec3 dxx = at(i + 1, j) + at(i - 1, j) - c * 2, dyy = at(i, j + 1) + at(i, j - 1) - c * 2;
      const Vec3 dxy = (at(i + 1, j + 1) - at(i - 1, j + 1) - at(i + 1, j - 1) + at(i - 1, j - 1)) * 0.25;
      centre_rays_[pixel] = c;
      const double angle = 0.5 * (dx.norm() + dy.norm());
      for (int b = 0; b < samples; ++b)
        for (int a = 0; a < samples; ++a) {
          const double x = (a + 0.5) / samples - 0.5, y = (b + 0.5) / samples - 0.5;
          const Vec3 r = c + dx * x + dy * y + dxx * (0.5 * x * x) + dyy * (0.5 * y * y) + dxy * (x * y);
          rays_[pixel * index(samples * samples) + index(b * samples + a)] = {
              static_cast<float>(r.x), static_cast<float>(r.y), static_cast<float>(r.z),
              static_cast<float>(angle / samples)};
        }
    }
  for (int ty = 0; ty < tiles_y_; ++ty)
    for (int tx = 0; tx < tiles_x_; ++tx) {
      const int i0 = tx * kTile, i1 = std::min(width_, i0 + kTile) - 1;
      const int j0 = ty * kTile, j1 = std::min(height_, j0 + kTile) - 1;
      const auto corner = [&](int i, int j) { return centre_rays_[index(j) * index(width_) + index(i)]; };
      const Vec3 c[4] = {corner(i0, j0), corner(i1, j0), corner(i1, j1), corner(i0, j1)};
      Tile& tile = tiles_[index(ty) * index(tiles_x_) + index(tx)];
      tile.slack = 1.5 * pixel_angle_;
      for (int k = 0; k < 4; ++k) {
        const Vec3 n = c[k].cross(c[(k + 1) % 4]);
        tile.edge[k] = n.norm() > 0 ? n.unit() : Vec3{};
      }
      for (int j = j0; j <= j1; ++j)
        for (int i = i0; i <= i1; ++i)
          for (const Vec3& edge : tile.edge)
            tile.slack = std::max(tile.slack, 1.5 * pixel_angle_ - edge.dot(corner(i, j)));
    }
}

void Renderer::cull(const Scene& scene, const Pose& pose, double extra_slack, int tile_row,
                    std::vector<std::vector<int>>& lists) const {
  const Mat3 R_CW = pose.R_WC.transposed();
  lists.assign(index(tiles_x_), {});
  for (std::size_t k = 0; k < scene.quads.size(); ++k) {
    const Quad& q = scene.quads[k];
    // Seen from behind (with a margin for rows that are taken from elsewhere).
    if (q.normal_W().dot(q.corner_W - pose.p_WC) < -2.0 * extra_slack) continue;
    Vec3 vertex[4];
    double length[4];
    for (int i = 0; i < 4; ++i) {
      vertex[i] = R_CW * (q.at(i == 1 || i == 2 ? q.width : 0, i >= 2 ? q.height : 0) - pose.p_WC);
      length[i] = vertex[i].norm();
    }
    for (int tx = 0; tx < tiles_x_; ++tx) {
      const Tile& tile = tiles_[index(tile_row) * index(tiles_x_) + index(tx)];
      bool outside = false;
      for (const Vec3& edge : tile.edge) {
        bool all = true;
        for (int i = 0; i < 4 && all; ++i) all = edge.dot(vertex[i]) < -(tile.slack + extra_slack) * length[i];
        outside = outside || all;
      }
      if (!outside) lists[index(tx)].push_back(static_cast<int>(k));
    }
  }
}

float Renderer::look_once(const Scene& scene, const std::vector<View>& views, const std::vector<int>& list,
                          const Ray& ray) {
  float best = 1e30f, best_u = 0, best_v = 0, best_cos = 1;
  int hit = -1;
  for (const int k : list) {
    const View& w = views[index(k)];
    const float c = w.R[6] * ray.x + w.R[7] * ray.y + w.R[8] * ray.z;
    if (w.o[2] >= 0 || c < kGrazing) continue;
    const float t = -w.o[2] / c;
    if (t >= best) continue;
    const float u = w.o[0] + t * (w.R[0] * ray.x + w.R[1] * ray.y + w.R[2] * ray.z);
    const float v = w.o[1] + t * (w.R[3] * ray.x + w.R[4] * ray.y + w.R[5] * ray.z);
    if (u < 0 || v < 0 || u > w.width || v > w.height) continue;
    if (scene.quads[index(k)].shape != Shape::kRectangle &&
        !inside_shape(scene.quads[index(k)].shape, u, v, w.width, w.height))
      continue;
    best = t;
    best_u = u;
    best_v = v;
    best_cos = c;
    hit = k;
  }
  if (hit < 0) return kBackground;
  // The footprint of a slanted surface is longer one way than the other; the mean of the two is used.
  return scene.quads[index(hit)].texture->sample(best_u, best_v, best * ray.angle / std::sqrt(best_cos));
}

Four Renderer::look(const Scene& scene, const std::vector<View>& views, const std::vector<int>& list, const Ray* rays) {
  const Four x = {rays[0].x, rays[1].x, rays[2].x, rays[3].x}, y = {rays[0].y, rays[1].y, rays[2].y, rays[3].y};
  const Four z = {rays[0].z, rays[1].z, rays[2].z, rays[3].z};
  Four best = four(1e30f), best_u = four(0.0f), best_v = four(0.0f), best_cos = four(1.0f);
  FourInts hit = four(-1);
  for (const int k : list) {
    const View& w = views[index(k)];
    if (w.o[2] >= 0) continue;
    const Four c = w.R[6] * x + w.R[7] * y + w.R[8] * z;
    const Four t = -w.o[2] / c;
    FourInts nearer = (c >= four(kGrazing)) & (t < best);
    if (!any(nearer)) continue;
    const Four u = w.o[0] + t * (w.R[0] * x + w.R[1] * y + w.R[2] * z);
    const Four v = w.o[1] + t * (w.R[3] * x + w.R[4] * y + w.R[5] * z);
    nearer &= (u >= four(0.0f)) & (v >= four(0.0f)) & (u <= four(w.width)) & (v <= four(w.height));
    if (scene.quads[index(k)].shape != Shape::kRectangle)
      for (int lane = 0; lane < 4; ++lane)
        if (nearer[lane] != 0 && !inside_shape(scene.quads[index(k)].shape, u[lane], v[lane], w.width, w.height))
          nearer[lane] = 0;
    best = nearer ? t : best;
    best_u = nearer ? u : best_u;
    best_v = nearer ? v : best_v;
    best_cos = nearer ? c : best_cos;
    hit = nearer ? four(k) : hit;
  }
  const Four root = {std::sqrt(best_cos[0]), std::sqrt(best_cos[1]), std::sqrt(best_cos[2]), std::sqrt(best_cos[3])};
  const Four footprint = best * Four{rays[0].angle, rays[1].angle, rays[2].angle, rays[3].angle} / root;
  if (hit[0] >= 0 && all_equal(hit)) return scene.quads[index(hit[0])].texture->sample(best_u, best_v, footprint);
  const auto grey = [&](int k) {
    return hit[k] < 0 ? kBackground : scene.quads[index(hit[k])].texture->sample(best_u[k], best_v[k], footprint[k]);
  };
  return Four{grey(0), grey(1), grey(2), grey(3)};
}

void Renderer::render(const Scene& scene, const std::vector<Pose>& row_poses, float weight,
                      std::vector<float>& sum) const {
  const bool rolling = row_poses.size() > 1;
  const std::size_t quads = scene.quads.size();
  std::vector<View> views(quads);
  const auto look_from = [&](const Pose& pose) {
    for (std::size_t k = 0; k < quads; ++k) {
      const Quad& q = scene.quads[k];
      const Mat3 R_QW = Mat3::columns(q.u_W, q.v_W, q.normal_W()).transposed();
      const Mat3 R = R_QW * pose.R_WC;
      const Vec3 o = R_QW * (pose.p_WC - q.corner_W);
      for (int i = 0; i < 9; ++i) views[k].R[i] = static_cast<float>(R.m[index(i)]);
      views[k].o[0] = static_cast<float>(o.x);
      views[k].o[1] = static_cast<float>(o.y);
      views[k].o[2] = static_cast<float>(o.z);
      views[k].width = static_cast<float>(q.width);
      views[k].height = static_cast<float>(q.height);
    }
  };
  if (!rolling) look_from(row_poses.front());

  const int per_pixel = samples_ * samples_;
  const float share = weight / static_cast<float>(per_pixel);
  std::vector<std::vector<int>> lists;
  for (int ty = 0; ty < tiles_y_; ++ty) {
    const int j1 = std::min(height_, (ty + 1) * kTile);
    double moved = 0;
    const Pose& middle = rolling ? row_poses[index((ty * kTile + j1) / 2)] : row_poses.front();
    if (rolling)
      for (int j = ty * kTile; j < j1; ++j) {
        const Pose& p = row_poses[index(j)];
        moved = std::max(moved,
                         rotation_log(middle.R_WC.transposed() * p.R_WC).norm() + 20 * (p.p_WC - middle.p_WC).norm());
      }
    cull(scene, middle, moved, ty, lists);
    for (int j = ty * kTile; j < j1; ++j) {
      if (rolling) look_from(row_poses[index(j)]);
      for (int i = 0; i < width_; ++i) {
        const std::vector<int>& list = lists[index(i / kTile)];
        const std::size_t at = index(j) * index(width_) + index(i);
        const Ray* ray = &rays_[at * index(per_pixel)];
        float grey = 0;
        int s = 0;
        for (; s + 4 <= per_pixel && !one_by_one; s += 4) {
          const Four seen = look(scene, views, list, ray + s);
          for (int k = 0; k < 4; ++k) grey += seen[k];
        }
        for (; s < per_pixel; ++s) grey += look_once(scene, views, list, ray[s]);
        sum[at] += share * grey;
      }
    }
  }
}

void Renderer::truth(const Scene& scene, const Pose& pose, std::vector<float>* depth,
                     std::vector<std::int32_t>* quad) const {
  if (depth) depth->assign(centre_rays_.size(), 0.0f);
  if (quad) quad->assign(centre_rays_.size(), -1);
  struct Facing {
    Vec3 normal;
    double distance;  // of the camera's centre [m]
    std::size_t quad;
  };
  std::vector<Facing> facing;
  for (std::size_t k = 0; k < scene.quads.size(); ++k) {
    const Vec3 n = scene.quads[k].normal_W();
    const double distance = n.dot(scene.quads[k].corner_W - pose.p_WC);
    if (distance > 0) facing.push_back({n, distance, k});
  }
  for (std::size_t at = 0; at < centre_rays_.size(); ++at) {
    const Vec3 ray = pose.R_WC * centre_rays_[at];
    double best = 1e30;
    for (const auto& [n, distance, k] : facing) {
      const Quad& q = scene.quads[k];
      const double c = n.dot(ray);
      if (c < 1e-4 || distance >= best * c) continue;
      const double t = distance / c;
      const Vec3 p = pose.p_WC + ray * t - q.corner_W;
      if (!inside_shape(q.shape, static_cast<float>(p.dot(q.u_W)), static_cast<float>(p.dot(q.v_W)),
                        static_cast<float>(q.width), static_cast<float>(q.height)))
        continue;
      best = t;
      if (depth) (*depth)[at] = static_cast<float>(t * centre_rays_[at].z);
      if (quad) (*quad)[at] = static_cast<std::int32_t>(k);
    }
  }
}

}  // namespace pf::sim
