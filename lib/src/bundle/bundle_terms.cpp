#include "bundle/bundle_terms.h"

#include <algorithm>

#include "bundle/row_column.h"
#include "bundle/tuning.h"

namespace pf {
namespace {

constexpr int kSeenBits = 16;  ///< of such a mask in one array

RhoPrior rho_prior_of(const AdjustOptions& options, const Bundle& bundle, int point) {
  return bundle.prior == nullptr ? RhoPrior{options.rho_mean, options.rho_sigma} : bundle.prior[point];
}

/// Distance of a point from its plane, with its derivatives.
struct PlaneTerm {
  int free_host, free_plane;
  Mat13 J_plane;
  Mat16 J_H;
  Scalar J_rho, e, weight;
};

void add_host_block(const PlaneTerm& term, int point, const NormalEquations& to) {
  const int column = to.pose_column(term.free_host), ld = to.ld;
  Scalar* w = to.pose_row(point, term.free_host);
  for (int a = 0; a < 6; ++a) {
    for (int f = 0; f <= a; ++f) to.H[(column + a) * ld + column + f] += term.weight * term.J_H(a) * term.J_H(f);
    to.b[column + a] -= term.weight * term.J_H(a) * term.e;
    w[a] += term.weight * term.J_H(a) * term.J_rho;
  }
  for (int a = 0; a < 6 && term.free_plane >= 0; ++a)
    for (int f = 0; f < 3; ++f)
      to.H[(column + a) * ld + 3 * term.free_plane + f] += term.weight * term.J_H(a) * term.J_plane(f);
}

///   e = n . (p_H + R_WH r(c) / rho) - d
void add_lens_block(const PlaneTerm& term, const RayByLens& J_ray_W, const LensRows& rows, Scalar rho, int point,
                    const NormalEquations& to) {
  for (int k = 0; k < to.lens_columns; ++k) {
    const Vec3 n = term.J_H.rightCols<3>().transpose();
    const auto by = [&](int column) { return n.dot(J_ray_W.col(rows.parameter[column])) / rho; };
    const Scalar by_k = term.weight * by(k);
    Scalar* row = to.H + (to.plane_columns + k) * to.ld;
    for (int f = 0; f <= k; ++f) row[to.plane_columns + f] += by_k * by(f);
    for (int f = 0; f < 3 && term.free_plane >= 0; ++f) row[3 * term.free_plane + f] += by_k * term.J_plane(f);
    for (int a = 0; a < 6 && term.free_host >= 0; ++a)
      to.H[(to.pose_column(term.free_host) + a) * to.ld + to.plane_columns + k] += by_k * term.J_H(a);
    to.b[to.plane_columns + k] -= by_k * term.e;
    to.lens_row(point)[k] += by_k * term.J_rho;
  }
}

void add_plane_block(const PlaneTerm& term, int point, const NormalEquations& to) {
  const int column = 3 * term.free_plane;
  Scalar* w = to.plane_row(point);
  for (int a = 0; a < 3; ++a) {
    for (int f = 0; f <= a; ++f)
      to.H[(column + a) * to.ld + column + f] += term.weight * term.J_plane(a) * term.J_plane(f);
    to.b[column + a] -= term.weight * term.J_plane(a) * term.e;
    w[a] += term.weight * term.J_plane(a) * term.J_rho;
  }
}

}  // namespace

bool BundleTerms::layout(Arena& arena, int max_poses, int max_free_poses, int max_points, int max_planes,
                         int max_lens_rows) {
  if (max_poses > kMaxPoses) return false;
  const std::size_t poses = static_cast<std::size_t>(max_poses), points = static_cast<std::size_t>(max_points);
  free_ = arena.take<int>(poses);
  free_plane_ = arena.take<int>(static_cast<std::size_t>(max_planes));
  R_CW_ = arena.take<Mat3>(poses);
  J_ray_W_ = max_lens_rows > 0 ? arena.take<RayByLens>(1) : nullptr;
  seen_ = arena.take<std::uint16_t>(points);
  seen_later_ = max_poses > kSeenBits ? arena.take<std::uint16_t>(points) : nullptr;
  return equations.layout(arena, max_free_poses, max_points, max_planes, max_lens_rows);
}

void BundleTerms::begin(const Bundle& bundle) {
  plane_of_ = bundle.plane_of;
  int free_planes = 0, free_poses = 0;
  for (int j = 0; j < bundle.planes && equations.plane_part > 0; ++j)
    free_plane_[j] = bundle.plane[j].free ? free_planes++ : -1;
  for (int c = 0; c < bundle.poses; ++c) free_[c] = bundle.pose[c].free ? free_poses++ : -1;
  equations.begin(free_planes, bundle.lens == nullptr ? 0 : bundle.lens->rows.count, free_poses);
  for (int i = 0; i < bundle.points; ++i) {
    seen_[i] = 0;
    if (seen_later_ != nullptr) seen_later_[i] = 0;
  }
  for (int c = 0; c < bundle.poses; ++c) {
    const BundlePixel* pixel = bundle.pose[c].pixel;
    std::uint16_t* seen = c < kSeenBits ? seen_ : seen_later_;
    const unsigned bit = 1u << (c % kSeenBits);
    for (int i = 0; i < bundle.points && pixel != nullptr; ++i)
      if (pixel[i].seen && host_of(bundle, i) != c) seen[i] = static_cast<std::uint16_t>(seen[i] | bit);
  }
}

void BundleTerms::set_rotations(const Bundle& bundle) {
  for (int c = 0; c < bundle.poses; ++c) R_CW_[c] = bundle.pose[c].q_WC.toRotationMatrix().transpose();
}

std::uint32_t BundleTerms::seen(int point) const {
  return seen_[point] | (seen_later_ != nullptr ? static_cast<std::uint32_t>(seen_later_[point]) << kSeenBits : 0u);
}

Scalar BundleTerms::cost(const Camera& camera, const AdjustOptions& options, const Bundle& bundle) {
  set_rotations(bundle);
  Scalar sum = add_lens_prior(bundle, true) + add_held_distance(bundle, true);
  for (int i = 0; i < bundle.points; ++i) sum += add_point<true>(camera, options, bundle, i).cost;
  return sum;
}

Scalar BundleTerms::linearise(const Camera& camera, const AdjustOptions& options, const Bundle& bundle,
                              Scalar damping) {
  set_rotations(bundle);
  equations.clear();
  Scalar sum = add_lens_prior(bundle, false) + add_held_distance(bundle, false);
  for (int i = 0; i < bundle.points; ++i) {
    equations.clear_point(i);
    const Sums sums = add_point<false>(camera, options, bundle, i);
    sum += sums.cost;
    equations.eliminate(i, sums.D, sums.g, damping, sums.seen_by, sums.on_plane ? free_plane_of(i) : -1);
  }
  return sum;
}

/// Cost and, unless kCostAlone, derivatives of what is measured and known of a point.
template <bool kCostAlone>
BundleTerms::Sums BundleTerms::add_point(const Camera& camera, const AdjustOptions& options, const Bundle& bundle,
                                         int point) {
  Sums sums = {Scalar(0), Scalar(0), Scalar(0), 0, false};
  const RhoPrior prior = rho_prior_of(options, bundle, point);
  if (prior.sigma > Scalar(0)) {
    const Scalar e = prior.mean - bundle.rho[point];
    sums.D = Scalar(1) / (prior.sigma * prior.sigma) *
             (bundle.rho[point] < Scalar(0) ? Scalar(1) + options.behind_weight : Scalar(1));
    sums.g = sums.D * e;
    sums.cost = sums.g * e;
  }
  if (equations.lens_columns > 0 && !set_ray(bundle, point, kCostAlone ? nullptr : J_ray_W_)) {
    for (std::uint32_t left = seen(point); left != 0; left &= left - 1) sums.cost += options.no_pixel_penalty;
    if (bundle.plane_of != nullptr && bundle.plane_of[point] >= 0) sums.cost += options.no_pixel_penalty;
    return sums;
  }
  add_pixels<kCostAlone>(camera, options, bundle, point, &sums);
  if (bundle.plane_of != nullptr) add_plane<kCostAlone>(options, bundle, point, &sums);
  return sums;
}

/// Adds the distance from its plane of a point that has one.
template <bool kCostAlone>
void BundleTerms::add_plane(const AdjustOptions& options, const Bundle& bundle, int point, Sums* sums) {
  const int index = bundle.plane_of[point];
  if (index < 0) return;
  const BundlePlane& plane = bundle.plane[index];
  const Scalar rho = bundle.rho[point];
  if (!(rho > tuning::adjust::kMinPlaneRho)) {
    sums->cost += options.no_pixel_penalty;
    return;
  }
  const int host = host_of(bundle, point);
  PlaneTerm term;
  const Vec3 ray_W = R_CW_[host].transpose() * bundle.ray[point], &p_H = bundle.pose[host].p_W;
  term.e = bundle.rho_before != nullptr
               ? relative_plane_distance(plane, ray_W, p_H, rho, bundle.rho_before[point], &term.J_plane, &term.J_H,
                                         &term.J_rho)
               : bearing_plane_distance(plane, ray_W, p_H, rho, &term.J_plane, &term.J_H, &term.J_rho);
  const Scalar information = Scalar(1) / (plane.roughness * plane.roughness);
  sums->cost += huber_cost(term.e * term.e * information, options.huber, &term.weight);
  if (kCostAlone) return;
  term.weight *= information;
  sums->D += term.weight * term.J_rho * term.J_rho;
  sums->g -= term.weight * term.J_rho * term.e;
  term.free_host = free_[host];
  term.free_plane = free_plane_of(point);
  if (term.free_host >= 0) {
    add_host_block(term, point, equations);
    sums->seen_by |= std::uint32_t{1} << term.free_host;
  }
  if (equations.lens_columns > 0) add_lens_block(term, *J_ray_W_, bundle.lens->rows, rho, point, equations);
  if (term.free_plane >= 0) {
    add_plane_block(term, point, equations);
    sums->on_plane = true;
  }
}

bool BundleTerms::set_ray(const Bundle& bundle, int point, RayByLens* J_ray_W) const {
  const BundleLens& lens = *bundle.lens;
  const HostPixel& host = lens.host_pixel[point];
  if (J_ray_W != nullptr) J_ray_W->setZero();
  if (!host.given) return true;
  Mat32 J_ray_z;
  const Vec2 by_readout = lens.rates != nullptr ? host_column(bundle, point) : Vec2(Vec2::Zero());
  const Vec2 pixel = host.pixel - (lens.camera->readout - lens.readout_before) * by_readout;
  if (!unproject(*lens.camera, pixel, &lens.ray[point], J_ray_W != nullptr ? &J_ray_z : nullptr)) return false;
  if (J_ray_W == nullptr) return true;
  RayByLens J_ray = ray_lens_jacobian(*lens.camera, lens.ray[point], J_ray_z);
  J_ray.col(kReadoutParameter) -= J_ray_z.lazyProduct(by_readout);
  *J_ray_W = R_CW_[host_of(bundle, point)].transpose().lazyProduct(J_ray);
  return true;
}

Vec2 BundleTerms::host_column(const Bundle& bundle, int point) const {
  const BundleLens& lens = *bundle.lens;
  const int host = host_of(bundle, point);
  const ViewOfRows view = {R_CW_[host], lens.rates[host], lens.readout_before};
  return readout_column(*lens.camera, view, lens.host_pixel[point].pixel, bundle.rho[point]);
}

Scalar BundleTerms::add_lens_prior(const Bundle& bundle, bool cost_alone) {
  const int rows = equations.lens_columns, first = equations.plane_columns;
  if (rows == 0) return Scalar(0);
  Scalar e[kLensParameters], sum = 0;
  lens_difference(bundle.lens->rows, bundle.lens->prior, *bundle.lens->camera, e);
  for (int a = 0; a < rows; ++a) {
    const Scalar* information = bundle.lens->prior_information + a * rows;
    Scalar gradient = 0;
    for (int k = 0; k < rows; ++k) gradient += information[k] * e[k];
    sum += e[a] * gradient;
    if (cost_alone) continue;
    for (int k = 0; k <= a; ++k) equations.H[(first + a) * equations.ld + first + k] += information[k];
    equations.b[first + a] -= gradient;
  }
  return sum;
}

Scalar BundleTerms::add_held_distance(const Bundle& bundle, bool cost_alone) {
  if (bundle.held == nullptr) return Scalar(0);
  const BundleDistance& held = *bundle.held;
  const Vec3 apart = bundle.pose[held.pose].p_W - held.from_W;
  const Scalar distance = apart.norm(), e = (distance - held.distance) / held.sigma;
  if (cost_alone || !(distance > Scalar(0))) return e * e;
  const Vec3 J = apart / (distance * held.sigma);
  const int column = equations.pose_column(free_[held.pose]) + 3;
  for (int a = 0; a < 3; ++a) {
    for (int k = 0; k <= a; ++k) equations.H[(column + a) * equations.ld + column + k] += J(a) * J(k);
    equations.b[column + a] -= J(a) * e;
  }
  return e * e;
}

}  // namespace pf
