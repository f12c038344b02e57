#include <cmath>

#include "api/checks.h"
#include "api/context.h"

namespace {

using pf::Scalar;

/// Of R R^T from the identity, for matrices whose entries were rounded to a few digits.
constexpr double kMaxSkew = 1e-4;

/// The rotation nearest to one that is right to kMaxSkew, by its first and third columns. False: no rotation.
bool rotation_from(const double* R, pf::Mat3* out) {
  double largest = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      double dot = i == j ? -1.0 : 0.0;
      for (int k = 0; k < 3; ++k) dot += R[3 * k + i] * R[3 * k + j];
      largest = std::fmax(largest, std::fabs(dot));
    }
  if (!(largest <= kMaxSkew)) return false;
  const double x[3] = {R[0], R[3], R[6]}, y[3] = {R[1], R[4], R[7]}, z[3] = {R[2], R[5], R[8]};
  const pf::Vec3 e1 = pf::vec3(x), e2 = pf::vec3(y), e3 = pf::vec3(z).normalized();
  if (!(e1.cross(e2).dot(e3) > Scalar(0))) return false;
  out->col(2) = e3;
  out->col(0) = (e1 - e3 * e3.dot(e1)).normalized();
  out->col(1) = e3.cross(out->col(0));
  return true;
}

/// A convex polygon, counter-clockwise, with the origin inside. False: it is none.
bool outline_from(const double (*uv)[2], int count, pf::PlaneOutline* out) {
  out->count = count;
  for (int i = 0; i < count; ++i) out->uv[i] = pf::Vec2(static_cast<Scalar>(uv[i][0]), static_cast<Scalar>(uv[i][1]));
  // Every vertex is one of the convex hull, and to the left of every edge: so they are in its order, once around.
  pf::PlaneOutline hull;
  pf::extend_outline(&hull, out->uv, count);
  if (hull.count != count || !pf::outline_contains(*out, pf::Vec2::Zero())) return false;
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < count; ++k) {
      const int next = (i + 1) % count;
      if (k != i && k != next && !(pf::twice_area(out->uv[i], out->uv[next], out->uv[k]) > Scalar(0))) return false;
    }
  return true;
}

pf_status_t prior_from(const pf_wall_prior_t& prior, pf::PlanePrior* out) {
  if (!pf::finite(prior.R_WP, 9) || !pf::finite(prior.p_WP, 3) || !pf::finite(prior.covariance, 9) ||
      !pf::finite(&prior.roughness, 1))
    return PF_ERROR_NONFINITE;
  if (prior.outline_count < 3 || prior.outline_count > PF_OUTLINE_MAX) return PF_ERROR_RANGE;
  for (int i = 0; i < prior.outline_count; ++i) {
    if (!pf::finite(prior.outline_P[i], 2)) return PF_ERROR_NONFINITE;
    if (!pf::within(prior.outline_P[i], 2, pf::kMaxMetres)) return PF_ERROR_RANGE;
  }
  if (!rotation_from(prior.R_WP, &out->frame.R_WP) || !pf::within(prior.p_WP, 3, pf::kMaxMetres)) return PF_ERROR_RANGE;
  if (!pf::is_covariance(prior.covariance, 3)) return PF_ERROR_RANGE;
  if (!outline_from(prior.outline_P, prior.outline_count, &out->outline)) return PF_ERROR_RANGE;
  if (!(prior.roughness == 0.0 || (prior.roughness >= 1e-6 && prior.roughness <= 1.0)) || prior.two_sided > 1u)
    return PF_ERROR_RANGE;
  out->frame.o_W = pf::vec3(prior.p_WP);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out->covariance(i, j) = static_cast<Scalar>(prior.covariance[3 * i + j]);
  out->roughness = static_cast<Scalar>(prior.roughness);
  out->two_sided = prior.two_sided == 1u;
  return PF_OK;
}

}  // namespace

pf_status_t pf_add_wall(pf_slam_t* slam, const pf_wall_prior_t* prior, uint32_t* id) {
  PF_BEGIN_CHANGE(slam);
  if (prior == nullptr || id == nullptr) return PF_ERROR_NULL;
  pf::PlanePrior wall;
  const pf_status_t status = prior_from(*prior, &wall);
  if (status != PF_OK) return status;
  std::uint32_t added = 0;
  const pf::Status done = slam->session.add_wall(wall, &added);
  if (done == pf::Status::kOk) *id = added;
  return in_call.end(done);
}
