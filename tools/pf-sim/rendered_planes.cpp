#include "rendered_planes.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "plane_error.h"

namespace pfsim {

using pf::sim::Vec3;

namespace {

constexpr int kStride = 2;             // pixels
constexpr double kCell = 0.05;         // [m]
constexpr double kMatchDeg = 6;        // a plane that is further off is no estimate of the surface
constexpr double kMatchOff = 0.06;     // likewise [m]
constexpr double kExplained = 16.27;   // NEES that one right plane in a thousand exceeds, 3 degrees of freedom
constexpr double kExplainedDeg = 20;   // however uncertain: a plane that is further off says nothing of the surface
constexpr double kMatchOverlap = 0.3;  // of its outline must lie on what was seen of it
constexpr double kDegree = 3.14159265358979323846 / 180;

std::int64_t key_of(int i, int j) { return (static_cast<std::int64_t>(i) << 32) ^ static_cast<std::uint32_t>(j); }

Vec3 vec(const double* p) { return {p[0], p[1], p[2]}; }

Vec3 column(const double R[9], int c) { return {R[c], R[3 + c], R[6 + c]}; }

bool inside(const pf_plane_t& plane, double x, double y) {
  for (int k = 0; k < plane.outline_count; ++k) {
    const double* a = plane.outline_P[k];
    const double* b = plane.outline_P[(k + 1) % plane.outline_count];
    if ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) < 0) return false;
  }
  return plane.outline_count >= 3;
}

Vec3 middle_of(const pf_plane_t& plane) {
  Vec3 middle = vec(plane.p_WP);
  for (int k = 0; k < plane.outline_count; ++k) {
    const double* p = plane.outline_P[k];
    middle += (column(plane.R_WP, 0) * p[0] + column(plane.R_WP, 1) * p[1]) * (1.0 / plane.outline_count);
  }
  return middle;
}

}  // namespace

SurfaceWatch::SurfaceWatch(const pf_sim_t* sim, const pf_camera_t& camera)
    : sim_(sim),
      width_(camera.width),
      height_(camera.height),
      depth_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
      surface_at_(depth_.size()) {
  for (int y = 0; y < height_; y += kStride)
    for (int x = 0; x < width_; x += kStride) {
      const double pixel[2] = {static_cast<double>(x), static_cast<double>(y)};
      double ray[3];
      const bool ok = pf_camera_unproject(&camera, pixel, ray) == PF_OK && ray[2] > 0;
      ray_C_.push_back(ok ? vec(ray) * (1 / ray[2]) : Vec3{});
    }
  Surface s;
  double n[3];
  for (int k = 0; k < PlanesVerdict::kMost && pf_sim_surface(sim, k, n, &s.d) == PF_OK; ++k) {
    s.n = vec(n);
    const Vec3 aside = std::fabs(s.n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    s.u = s.n.cross(aside).unit();
    s.v = s.n.cross(s.u);
    surfaces_.push_back(s);
  }
}

void SurfaceWatch::look(const pf_pose_t& truth, double seconds) {
  pf_sim_depth(sim_, &truth, depth_.data(), surface_at_.data());
  const pf::sim::Mat3 R_WC = pf::sim::rotation_of(truth.q_WC);
  const Vec3 p_WC = vec(truth.p_WC);
  std::vector<Cells> now(surfaces_.size());
  std::size_t ray = 0;
  for (int y = 0; y < height_; y += kStride)
    for (int x = 0; x < width_; x += kStride, ++ray) {
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
      const std::int32_t k = surface_at_[at];
      if (k < 0 || static_cast<std::size_t>(k) >= surfaces_.size() || !(depth_[at] > 0)) continue;
      const Surface& s = surfaces_[static_cast<std::size_t>(k)];
      const Vec3 p = p_WC + R_WC * ray_C_[ray] * static_cast<double>(depth_[at]);
      const int i = static_cast<int>(std::floor(s.u.dot(p) / kCell)),
                j = static_cast<int>(std::floor(s.v.dot(p) / kCell));
      now[static_cast<std::size_t>(k)][key_of(i, j)] = static_cast<float>(seconds);
    }
  for (std::size_t k = 0; k < now.size(); ++k)
    for (const auto& [key, time] : now[k]) surfaces_[k].cells[key] += time;
}

/// Cell by cell of the surface, seen along its normal.
void SurfaceWatch::overlap(const pf_plane_t& plane, const Surface& s, PlaneVerdict* verdict) const {
  const Vec3 x = column(plane.R_WP, 0), y = column(plane.R_WP, 1), n = vec(plane.normal_W), o = vec(plane.p_WP);
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  for (int k = 0; k < plane.outline_count; ++k) {
    const Vec3 p = o + x * plane.outline_P[k][0] + y * plane.outline_P[k][1];
    const double at[2] = {s.u.dot(p), s.v.dot(p)};
    for (int a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], at[a]);
      high[a] = std::max(high[a], at[a]);
    }
  }
  int all = 0, beyond = 0, seen = 0, covered = 0;
  const auto holds = [&](int i, int j) {
    const Vec3 foot = s.n * s.d + s.u * ((i + 0.5) * kCell) + s.v * ((j + 0.5) * kCell);
    const Vec3 p = foot + s.n * (n.dot(o - foot) / n.dot(s.n));
    return inside(plane, x.dot(p - o), y.dot(p - o));
  };
  const auto cell = [](double v) { return static_cast<int>(std::floor(v / kCell)); };
  for (int i = cell(low[0]); i <= cell(high[0]); ++i)
    for (int j = cell(low[1]); j <= cell(high[1]); ++j)
      if (holds(i, j)) {
        ++all;
        beyond += s.cells.count(key_of(i, j)) == 0;
      }
  for (const auto& [key, time] : s.cells)
    if (static_cast<double>(time) >= kSeenSeconds) {
      ++seen;
      covered += holds(static_cast<int>(key >> 32), static_cast<int>(static_cast<std::int32_t>(key & 0xffffffff)));
    }
  verdict->covered = static_cast<float>(covered / std::max(1.0, static_cast<double>(seen)));
  verdict->overstep = static_cast<float>(beyond / std::max(1.0, static_cast<double>(seen)));
  // Nothing of it on the surface: not this one.
  if (all == 0 || all - beyond < kMatchOverlap * all) verdict->surface = -1;
}

/// A plane of the map against one surface, wherever that is.
PlaneVerdict SurfaceWatch::compare(const pf_plane_t& plane, std::size_t k) const {
  const Surface& s = surfaces_[k];
  const Vec3 n = vec(plane.normal_W), middle = middle_of(plane);
  PlaneVerdict one;
  one.id = static_cast<std::int32_t>(plane.id);
  one.points = plane.points;
  one.area_m2 = static_cast<float>(plane.area);
  one.surface = static_cast<std::int32_t>(k);
  const double sine = n.cross(s.n).norm();
  one.normal_deg = static_cast<float>(std::atan2(sine, std::fabs(n.dot(s.n))) / kDegree);
  one.offset_m = static_cast<float>(std::fabs(s.n.dot(middle) - s.d));
  const double side = n.dot(s.n) < 0 ? -1 : 1;
  one.nees = static_cast<float>(normalised_plane_error(plane, s.n * side, s.d * side));
  return one;
}

PlaneVerdict SurfaceWatch::judge_one(const pf_plane_t& plane) const {
  PlaneVerdict best;
  best.id = static_cast<std::int32_t>(plane.id);
  best.points = plane.points;
  best.area_m2 = static_cast<float>(plane.area);
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    PlaneVerdict one = compare(plane, k);
    const bool is_near =
        one.normal_deg <= static_cast<float>(kMatchDeg) && one.offset_m <= static_cast<float>(kMatchOff);
    const bool is_explained = one.nees >= 0 && one.nees <= static_cast<float>(kExplained) &&
                              one.normal_deg <= static_cast<float>(kExplainedDeg);
    if (!is_near && !is_explained) continue;
    overlap(plane, surfaces_[k], &one);
    if (one.surface < 0) continue;
    if (!is_near)
      best.explained_by = one.surface;
    else if (best.surface < 0 || one.offset_m < best.offset_m)
      best = one;
  }
  if (best.surface >= 0) best.explained_by = -1;
  return best;
}

PlanesVerdict SurfaceWatch::judge(const pf_slam_t* slam) const {
  PlanesVerdict out;
  std::vector<pf_plane_t> planes(PlanesVerdict::kMost);
  std::size_t count = 0;
  if (pf_get_planes(slam, planes.data(), planes.size(), &count) < 0) count = 0;
  for (std::size_t k = 0; k < std::min(count, planes.size()); ++k)
    if (planes[k].outline_count >= 3) out.plane[out.planes++] = judge_one(planes[k]);  // without points it says nothing
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    SurfaceVerdict& s = out.surface[out.surfaces++];
    s.surface = static_cast<std::int32_t>(k);
    const double cells =
        static_cast<double>(std::count_if(surfaces_[k].cells.begin(), surfaces_[k].cells.end(),
                                          [](const auto& c) { return static_cast<double>(c.second) >= kSeenSeconds; }));
    s.seen_m2 = static_cast<float>(cells * kCell * kCell);
    for (int p = 0; p < out.planes; ++p) s.planes += out.plane[p].surface == s.surface;
  }
  return out;
}

}  // namespace pfsim
