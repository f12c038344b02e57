#include "template_truth.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace pfsim {
namespace {

using pf::sim::Mat3;
using pf::sim::Vec3;

constexpr int kMinPixels = 12;    // of a surface that counts
constexpr double kSamePlace = 1;  // [px]
constexpr double kSamePlane = 1e-3;
constexpr double kNearer = 0.98;  // what hides a place, of its depth

Vec3 vec(const double p[3]) { return {p[0], p[1], p[2]}; }

bool ray_at_depth_1(const pf_camera_t& camera, double u, double v, Vec3* ray) {
  const double pixel[2] = {u, v};
  double r[3];
  if (pf_camera_unproject(&camera, pixel, r) != PF_OK || !(r[2] > 0)) return false;
  *ray = vec(r) * (1 / r[2]);
  return true;
}

bool pixel_of(const pf_camera_t& camera, const pf_pose_t& pose, const Vec3& p_W, double pixel[2]) {
  const Vec3 p = pf::sim::rotation_of(pose.q_WC).transposed() * (p_W - vec(pose.p_WC));
  const double p_C[3] = {p.x, p.y, p.z};
  return pf_camera_project(&camera, p_C, pixel) == PF_OK;
}

}  // namespace

TemplateTruth::TemplateTruth(const pf_sim_t* sim, const pf_camera_t& camera) : sim_(sim), camera_(camera) {
  const std::size_t size = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  depth_.resize(size);
  surface_.resize(size);
  double n[3], d;
  for (std::int32_t k = 0; pf_sim_surface(sim, k, n, &d) == PF_OK; ++k) {
    const auto is_same = [&](const std::array<double, 4>& other) {
      return std::abs(other[0] - n[0]) + std::abs(other[1] - n[1]) + std::abs(other[2] - n[2]) +
                 std::abs(other[3] - d) <
             kSamePlane;
    };
    const auto first = std::find_if(planes_.begin(), planes_.end(), is_same);
    same_.push_back(static_cast<std::int32_t>(first - planes_.begin()));
    planes_.push_back({n[0], n[1], n[2], d});
  }
}

void TemplateTruth::look(const pf_pose_t& pose) {
  pose_ = pose;
  pf_sim_depth(sim_, &pose, depth_.data(), surface_.data());
}

std::int32_t TemplateTruth::plane_of(std::int32_t surface) const {
  return surface < 0 ? -1 : same_[static_cast<std::size_t>(surface)];
}

TemplateTruth::Patch TemplateTruth::cut(const double centre_px[2], int side) const {
  Patch patch;
  patch.pose = pose_;
  patch.side = side;
  patch.left = static_cast<int>(std::lround(centre_px[0])) - side / 2;
  patch.top = static_cast<int>(std::lround(centre_px[1])) - side / 2;
  std::map<std::int32_t, int> pixels;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const int x = patch.left + i, y = patch.top + j;
      const bool inside = x >= 0 && y >= 0 && x < camera_.width && y < camera_.height;
      const std::size_t at =
          inside ? static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) + static_cast<std::size_t>(x)
                 : 0;
      patch.depth.push_back(inside ? depth_[at] : 0);
      patch.surface.push_back(inside ? plane_of(surface_[at]) : -1);
      if (patch.surface.back() >= 0) ++pixels[patch.surface.back()];
    }
  patch.straddles =
      std::count_if(pixels.begin(), pixels.end(), [](const auto& one) { return one.second >= kMinPixels; }) >= 2;
  return patch;
}

/// Whether the frame that look() saw shows something nearer at a place's pixel.
bool TemplateTruth::is_hidden(const Vec3& p_W, const double pixel[2]) const {
  const long x = std::lround(pixel[0]), y = std::lround(pixel[1]);
  if (x < 0 || y < 0 || x >= camera_.width || y >= camera_.height) return true;
  const double z = (pf::sim::rotation_of(pose_.q_WC).transposed() * (p_W - vec(pose_.p_WC))).z;
  const double seen = static_cast<double>(depth_[static_cast<std::size_t>(y * camera_.width + x)]);
  return seen > 0 && seen < kNearer * z;
}

TemplateTruth::Agreement TemplateTruth::judge(const Patch& patch, const pf_template_t& mask,
                                              const double p_W[3]) const {
  const Mat3 R_WK = pf::sim::rotation_of(patch.pose.q_WC);
  const Vec3 c_W = vec(patch.pose.p_WC);
  const double depth = (R_WK.transposed() * (vec(p_W) - c_W)).z;
  std::map<std::int32_t, int> pixels;
  for (const std::int32_t surface : patch.surface) ++pixels[surface];
  Vec3 ray;
  if (!ray_at_depth_1(camera_, patch.left + patch.side / 2, patch.top + patch.side / 2, &ray)) return {};
  // Depth along z where a ray of the first view meets a plane; 0: nowhere.
  const auto depth_on = [&](std::int32_t surface, const Vec3& along) {
    const auto& plane = planes_[static_cast<std::size_t>(surface)];
    const Vec3 n{plane[0], plane[1], plane[2]};
    const double slope = n.dot(R_WK * along), height = plane[3] - n.dot(c_W);
    return slope * height > 0 ? height / slope : 0.0;
  };
  std::int32_t dominant = -1;
  double nearest = 0;
  for (const auto& [surface, count] : pixels) {
    if (surface < 0 || count < kMinPixels) continue;
    const double z = depth_on(surface, ray);
    if (!(z > 0)) continue;
    const double off = std::abs(std::log(z / std::max(depth, 1e-6)));
    if (dominant < 0 || off < nearest) nearest = off, dominant = surface;
  }
  if (dominant < 0) return {};
  Agreement out;
  for (int at = 0; at < patch.side * patch.side; ++at) {
    const std::size_t k = static_cast<std::size_t>(at);
    double true_px[2], plane_px[2];
    if (patch.surface[k] < 0 || mask.mask[k] == 0 ||
        !ray_at_depth_1(camera_, patch.left + at % patch.side, patch.top + at / patch.side, &ray))
      continue;
    const double z = depth_on(dominant, ray);
    const Vec3 place_W = c_W + R_WK * (ray * patch.depth[k]);
    if (!(z > 0) || !pixel_of(camera_, pose_, place_W, true_px) ||
        !pixel_of(camera_, pose_, c_W + R_WK * (ray * z), plane_px))
      continue;
    const bool on = std::hypot(true_px[0] - plane_px[0], true_px[1] - plane_px[1]) <= kSamePlace;
    const bool says = mask.mask[k] >= 128;
    ++out.pixels;
    out.mask += says == on;
    out.all_on += on;
    out.surface += says == (patch.surface[k] == dominant);
    if (is_hidden(place_W, true_px)) continue;
    ++out.visible_pixels;
    out.visible += says == on;
  }
  if (out.pixels > 0) {
    out.mask /= out.pixels;
    out.all_on /= out.pixels;
    out.surface /= out.pixels;
  }
  if (out.visible_pixels > 0) out.visible /= out.visible_pixels;
  return out;
}

}  // namespace pfsim
