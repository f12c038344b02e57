#include "filter_slam/planes/own_places.h"

#include <algorithm>
#include <cmath>

#include "filter_slam/planes/tuning.h"
#include "model/camera_at.h"

namespace pf {
namespace {

using namespace tuning::own_places;

Vec3 vector(const float v[3]) {
  return Vec3(static_cast<Scalar>(v[0]), static_cast<Scalar>(v[1]), static_cast<Scalar>(v[2]));
}

void put_vector(const Vec3& v, float out[3]) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

}  // namespace

bool OwnPlaces::layout(Arena& arena, int max_features) {
  own_ = arena.take<Own>(static_cast<std::size_t>(max_features));
  return arena.ok();
}

void OwnPlaces::init() {
  for (int i = 0; i < map_.features.capacity(); ++i) own_[i] = Own();
}

void OwnPlaces::begin(int feature, std::uint32_t plane) {
  Own& own = own_[feature];
  const Vec3 p_W = filter_.point(map_.features[feature].slot);
  own = Own();
  own.id = map_.features[feature].id;
  own.plane = plane;
  put_vector(p_W, own.place_W);
  put_vector(p_W - camera_at(filter_.state(), Scalar(0)).p_W, own.ray_W);
}

void OwnPlaces::update() {
  const State& state = filter_.state();
  for (int i = 0; i < map_.features.capacity(); ++i) {
    const bool folded = map_.features.used(i) && state.block[map_.features[i].slot].kind == BlockKind::kPlanePoint;
    const std::uint32_t plane = folded ? map_.planes.id_at(state.plane_of(map_.features[i].slot)) : 0;
    if (plane == 0) {
      const bool goes_on = own_[i].plane != 0 && map_.planes.entry_of(own_[i].plane) < 0;
      if (!goes_on || !map_.features.used(i)) own_[i] = Own();
      if (own_[i].plane != 0) own_[i].N = -1;
    } else if (is_lost(i) || own_[i].plane != plane || own_[i].id != map_.features[i].id) {
      if (map_.features[i].last_seen_ns == frame_.report.t_ns) begin(i, plane);
    }
  }
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier || own_[match.feature].plane == 0) continue;
    if (is_lost(match.feature)) continue;
    add(match, camera_of_row(state, filter_.lens(), match.measured.y()));
  }
}

void OwnPlaces::end_with_planes() {
  for (int i = 0; i < map_.features.capacity(); ++i)
    if (!is_lost(i) && map_.planes.entry_of(own_[i].plane) < 0) own_[i].plane = 0;
}

std::uint32_t OwnPlaces::lost_plane(int feature) const {
  const Own& own = own_[feature];
  return is_lost(feature) && own.id == map_.features[feature].id ? own.plane : 0;
}

void OwnPlaces::give_up(std::uint32_t plane) {
  for (int i = 0; i < map_.features.capacity(); ++i)
    if (is_lost(i) && own_[i].plane == plane) own_[i] = Own();
}

void OwnPlaces::add(const Match& match, const CameraAt& camera) {
  Own& own = own_[match.feature];
  const Vec3 x = vector(own.place_W), ray = vector(own.ray_W);
  const Scalar range = ray.norm();
  const Vec3 d = ray / range;
  const Scalar N = static_cast<Scalar>(own.N), b = static_cast<Scalar>(own.b), limit = kMaxMove * range;
  const Scalar s = N * range * range > kTold ? std::clamp(b / N, -limit, limit) : Scalar(0);
  Vec2 z;
  Mat23 J_z_p;
  const Mat3 R_CW = camera.q_WC.conjugate().toRotationMatrix();
  if (!project(filter_.lens(), Vec3(R_CW * (x + s * d - camera.p_W)), &z, &J_z_p)) return;
  const Vec2 r = match.measured - z, J = J_z_p * (R_CW * d);
  if (r.squaredNorm() > kElsewhere * kElsewhere) {  // the world has been given another place
    own.plane = 0;
    return;
  }
  own.N += static_cast<float>(J.squaredNorm());
  own.b += static_cast<float>(J.dot(r + J * s));
}

void OwnPlaces::scale(Scalar s) {
  for (int i = 0; i < map_.features.capacity(); ++i) {
    Own& own = own_[i];
    put_vector(s * vector(own.place_W), own.place_W);
    put_vector(s * vector(own.ray_W), own.ray_W);
    if (is_lost(i)) continue;
    own.N /= static_cast<float>(s * s);
    own.b /= static_cast<float>(s);
  }
}

void OwnPlaces::forget(int plane_slot) {
  filter_.state().for_each_planar(plane_slot, [&](int slot) { own_[filter_.state().block[slot].owner].plane = 0; });
}

bool OwnPlaces::depth(int feature, Scalar* farther, Scalar* variance, Vec3* ray_W) const {
  const Own& own = own_[feature];
  if (own.plane == 0 || own.id != map_.features[feature].id || !(own.N > 0)) return false;
  const Scalar N = static_cast<Scalar>(own.N);
  *ray_W = vector(own.ray_W);
  *farther = static_cast<Scalar>(own.b) / N;
  *variance = 1 / N;
  return std::isfinite(*farther) && std::isfinite(*variance);
}

bool OwnPlaces::find(int feature, const Vec3& n_W, Vec3* p_W, Scalar* variance) const {
  const Own& own = own_[feature];
  if (own.plane == 0 || own.id != map_.features[feature].id || !(own.N > 0)) return false;
  const Vec3 d = vector(own.ray_W).normalized();
  const Scalar slant = n_W.dot(d), N = static_cast<Scalar>(own.N);
  *p_W = vector(own.place_W) + d * (static_cast<Scalar>(own.b) / N);
  *variance = slant * slant / N;
  return std::isfinite(*variance) && *variance > Scalar(0);
}

}  // namespace pf
