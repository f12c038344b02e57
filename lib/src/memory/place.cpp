#include "memory/place.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "memory/tuning.h"

namespace pf {

void crop_patch(const SourcePatch& from, PlacePatch* to) {
  constexpr int kSize = PlacePatch::kSize;
  constexpr int kFirst = (SourcePatch::kSize - PlacePatch::kSize) / 2;  // a feature is about in the middle of its patch
  const auto within = [](int x) { return static_cast<std::uint8_t>(std::clamp(x - kFirst, 0, PlacePatch::kSize)); };
  to->centre[0] = from.centre_x[0] - static_cast<float>(kFirst);
  to->centre[1] = from.centre_y[0] - static_cast<float>(kFirst);
  to->begin[0] = within(from.begin_x[0]);
  to->begin[1] = within(from.begin_y[0]);
  to->end[0] = within(from.end_x[0]);
  to->end[1] = within(from.end_y[0]);
  for (int y = 0; y < kSize; ++y)
    std::memcpy(to->pixels + y * kSize, from.pixels[0] + (y + kFirst) * SourcePatch::kSize + kFirst, kSize);
}

void restore_patch(const PlacePatch& from, SourcePatch* to) {
  std::memset(to, 0, sizeof *to);
  to->centre_x[0] = from.centre[0];
  to->centre_y[0] = from.centre[1];
  to->begin_x[0] = from.begin[0];
  to->begin_y[0] = from.begin[1];
  to->end_x[0] = from.end[0];
  to->end_y[0] = from.end[1];
  for (int y = 0; y < PlacePatch::kSize; ++y)
    std::memcpy(to->pixels[0] + y * SourcePatch::kSize, from.pixels + y * PlacePatch::kSize, PlacePatch::kSize);
}

void set_place_point(const Vec3& x_K, const Mat3& covariance_K, const Quat& q_KV, const Vec3& c_K,
                     const SourcePatch& patch, PlacePoint* out) {
  const Scalar rho = 1 / x_K.norm();
  out->rho = static_cast<float>(rho);
  for (int a = 0, n = 0; a < 3; ++a) {
    out->ray_K[a] = static_cast<float>(x_K(a) * rho);
    out->c_K[a] = static_cast<float>(c_K(a));
    out->q_KV[a + 1] = static_cast<float>(q_KV.vec()(a));
    for (int b = 0; b <= a; ++b) out->covariance[n++] = static_cast<float>(covariance_K(a, b));
  }
  out->q_KV[0] = static_cast<float>(q_KV.w());
  crop_patch(patch, &out->patch);
  describe(patch, &out->descriptor);
}

void add_point(const PlacePoint& point, KeptPlace* place) {
  if (place->count < KeptPlace::kMaxPoints) {
    place->point[place->count++] = point;
    return;
  }
  int least = 0;
  for (int i = 1; i < place->count; ++i)
    if (place->point[i].observations < place->point[least].observations) least = i;
  if (point.observations > place->point[least].observations) place->point[least] = point;
}

Scalar median_depth(const KeptPlace& place) {
  Scalar depth[KeptPlace::kMaxPoints];
  for (int i = 0; i < place.count; ++i) depth[i] = 1 / static_cast<Scalar>(place.point[i].rho);
  std::nth_element(depth, depth + place.count / 2, depth + place.count);
  return depth[place.count / 2];
}

Scalar view_distance2(const Quat& q_a, const Vec3& p_a, Scalar depth_a, const Quat& q_b, const Vec3& p_b,
                      Scalar depth_b) {
  using namespace tuning::place;
  const Scalar far = kFarShift * std::min(depth_a, depth_b);
  const Vec3 z_a = q_a * Vec3::UnitZ(), z_b = q_b * Vec3::UnitZ();
  return (p_a - p_b).squaredNorm() / (far * far) + 2 * (1 - z_a.dot(z_b)) / (kFarTurn * kFarTurn);
}

CameraView first_view_of(const KeptPlace& place, const PlacePoint& point) {
  const auto number = [](float x) { return static_cast<Scalar>(x); };
  const Quat q_KV(number(point.q_KV[0]), number(point.q_KV[1]), number(point.q_KV[2]), number(point.q_KV[3]));
  const Vec3 c_K(number(point.c_K[0]), number(point.c_K[1]), number(point.c_K[2]));
  return {(place.q_WK * q_KV).normalized(), place.p_WK + place.q_WK * c_K};
}

Mat3 PlacePoint::covariance_K() const {
  Mat3 C;
  for (int a = 0, n = 0; a < 3; ++a)
    for (int b = 0; b <= a; ++b) C(a, b) = C(b, a) = static_cast<Scalar>(covariance[n++]);
  return C;
}

}  // namespace pf
