#include "bundle/bundle_terms.h"
#include "bundle/pose_rows.h"
#include "bundle/row_column.h"
#include "geometry/camera_distortion.h"

/// The pixels of BundleTerms, where an adjustment spends most of its time.

namespace pf {
namespace {

using blocks::Columns;
using blocks::Pair;
using blocks::PoseRows;

/// A direction's pixel, and its derivative by the direction in the camera.
struct Projection {
  bool is_pinhole;  ///< with the four slopes that are not zero alone
  Vec2 pixel;
  Mat23 J;
  Vec4 slope = Vec4::Zero();

  explicit Projection(bool pinhole) : is_pinhole(pinhole) {}
  bool of(const Camera& camera, const Vec3& d_C) {
    return is_pinhole ? project_pinhole(camera, d_C, &pixel, &slope) : project(camera, d_C, &pixel, &J);
  }
  /// J v.
  Vec2 along(const Vec3& v_C) const {
    return is_pinhole ? Vec2(slope(0) * v_C.x() + slope(1) * v_C.z(), slope(2) * v_C.y() + slope(3) * v_C.z())
                      : Vec2(J.lazyProduct(v_C));
  }
  /// J R_CW.
  Columns in_W(const Mat3& R_CW) const {
    Columns columns;
    if (is_pinhole) {
      for (int m = 0; m < 3; ++m)
        columns.at[m] = Pair{slope(0), slope(2)} * blocks::load(&R_CW(0, m)) + Pair{slope(1), slope(3)} * R_CW(2, m);
    } else {
      const Mat23 J_W = J.lazyProduct(R_CW);
      for (int m = 0; m < 3; ++m) columns.at[m] = blocks::load(&J_W(0, m));
    }
    return columns;
  }
};

/// One pixel of a point, with its derivatives.
struct PixelTerm {
  int point, free_pose, free_host;
  Vec2 r;
  Scalar weight;
  Columns J_z_d;                   ///< by the direction d in W
  Pair J_rho;                      ///< by the point's inverse depth
  PoseRows J_C, J_H;               ///< by the pose and by the host, where they are free
  Vec2 by_readout = Vec2::Zero();  ///< by the readout of the pose's rows
};

/// H, b and W of one pose.
inline void add_pose(const PixelTerm& term, const PoseRows& J, int free_pose, const NormalEquations& to) {
  const int column = to.pose_column(free_pose);
  blocks::add_square(J, term.weight, to.H + column * (to.ld + 1), to.ld);
  blocks::add_column(J, term.r.x(), term.r.y(), term.weight, to.b + column);
  blocks::add_column(J, term.J_rho[0], term.J_rho[1], term.weight, to.pose_row(term.point, free_pose));
}

/// Blocks of the pose, of the host, and of both, in the lower half of the triangle.
inline void add_poses(const Vec3& d, const Vec3& ray_W, Scalar rho, PixelTerm* term, const NormalEquations& to) {
  if (term->free_pose >= 0) {
    term->J_C = blocks::pose_rows(term->J_z_d, d, -rho);
    add_pose(*term, term->J_C, term->free_pose, to);
  }
  if (term->free_host >= 0) {
    const Columns negative = {-term->J_z_d.at[0], -term->J_z_d.at[1], -term->J_z_d.at[2]};
    term->J_H = blocks::pose_rows(negative, ray_W, -rho);
    add_pose(*term, term->J_H, term->free_host, to);
  }
  if (term->free_pose < 0 || term->free_host < 0) return;
  const int pose = to.pose_column(term->free_pose), host = to.pose_column(term->free_host);
  if (term->free_pose > term->free_host)
    blocks::add_block(term->J_C, term->J_H, term->weight, to.H + pose * to.ld + host, to.ld);
  else
    blocks::add_block(term->J_H, term->J_C, term->weight, to.H + host * to.ld + pose, to.ld);
}

/// Blocks of the lens, and of the lens with poses and point.
inline void add_lens(const PixelTerm& term, LensJacobian J_lens, const LensRows& rows, const NormalEquations& to) {
  J_lens.col(kReadoutParameter) += term.by_readout;
  const int first = to.plane_columns;
  Scalar* w = to.lens_row(term.point);
  for (int a = 0; a < to.lens_columns; ++a) {
    const Vec2 by_a = term.weight * J_lens.col(rows.parameter[a]);
    Scalar* row = to.H + (first + a) * to.ld + first;
    for (int k = 0; k <= a; ++k) row[k] += by_a.dot(J_lens.col(rows.parameter[k]));
    to.b[first + a] += by_a.dot(term.r);
    w[a] += by_a.x() * term.J_rho[0] + by_a.y() * term.J_rho[1];
    const auto in = [&](int free_pose) { return to.H + to.pose_column(free_pose) * to.ld + first + a; };
    if (term.free_pose >= 0) blocks::add_lens_column(term.J_C, by_a, in(term.free_pose), to.ld);
    if (term.free_host >= 0) blocks::add_lens_column(term.J_H, by_a, in(term.free_host), to.ld);
  }
}

inline Mat23 matrix_of(const Columns& columns) {
  Mat23 J;
  for (int m = 0; m < 3; ++m) J.col(m) = Vec2(columns.at[m][0], columns.at[m][1]);
  return J;
}

/// The residual becomes that by the camera's readout.
inline void take_readout(const Camera& camera, const BundleLens& lens, int pose, const Mat3& R_CW, const Mat23& J,
                         const Vec3& d, Scalar rho, const BundlePixel& measured, PixelTerm* term) {
  const ViewOfRows view = {R_CW, lens.rates[pose], lens.readout_before};
  term->by_readout = readout_column(camera, view, measured.pixel().y(), J, d, rho);
  term->r -= (camera.readout - lens.readout_before) * term->by_readout;
}

}  // namespace

/// Adds a point's pixels to H_pp and b, and to its row of W, D and g. Fixed poses have neither columns nor Jacobians.
template <bool kCostAlone>
void BundleTerms::add_pixels(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, int point,
                             Sums* sums) {
  const int host = host_of(bundle, point);
  const Mat3 R_WH = R_CW_[host].transpose();
  const Vec3 ray_W = R_WH.lazyProduct(bundle.ray[point]);
  const Vec3 p_H = bundle.pose[host].p_W;
  const Scalar rho = bundle.rho[point];
  const bool is_pinhole = camera.model == static_cast<int>(CameraModel::kPinhole);
  const bool has_lens = equations.lens_columns > 0, has_readout = has_lens && bundle.lens->rates != nullptr;
  Scalar D = sums->D, g = sums->g, cost = sums->cost;
  std::uint32_t seen_by = 0;
  Scalar information = Scalar(1) / (options.sigma_px * options.sigma_px);
  PixelTerm term{};  // of a pose or host that is held, nothing else is written
  term.point = point;
  term.free_host = free_[host];
  for (std::uint32_t left = seen(point); left != 0; left &= left - 1) {
    const int c = __builtin_ctz(left);
    const BundlePixel& measured = bundle.pose[c].pixel[point];
    const Mat3& R_CW = R_CW_[c];
    const Vec3 p_HC_W = p_H - bundle.pose[c].p_W;
    const Vec3 d = ray_W + rho * p_HC_W, d_C = R_CW.lazyProduct(d);
    Projection z(is_pinhole);
    if (!z.of(camera, d_C)) {
      cost += options.no_pixel_penalty;
      continue;
    }
    term.r = measured.pixel() - z.pixel;
    if (has_readout) take_readout(camera, *bundle.lens, c, R_CW, matrix_of(z.in_W(R_CW)), d, rho, measured, &term);
    if (options.class_sigma_px != nullptr) {
      const Scalar sigma = options.class_sigma_px[measured.sigma_class];
      information = Scalar(1) / (sigma * sigma);
    }
    cost += huber_cost(term.r.squaredNorm() * information, options.huber, &term.weight);
    if (kCostAlone) continue;
    term.weight *= information;
    term.free_pose = free_[c];
    if (term.free_pose < 0 && term.free_host < 0 && !has_lens) {
      const Vec2 J_rho = z.along(R_CW.lazyProduct(p_HC_W));
      D += term.weight * J_rho.squaredNorm();
      g += term.weight * J_rho.dot(term.r);
      continue;
    }
    const Columns& J = term.J_z_d = z.in_W(R_CW);
    term.J_rho = J.at[0] * p_HC_W.x() + J.at[1] * p_HC_W.y() + J.at[2] * p_HC_W.z();
    add_poses(d, ray_W, rho, &term, equations);
    if (has_lens)
      add_lens(term, bearing_lens_jacobian(camera, d_C, matrix_of(J), *J_ray_W_), bundle.lens->rows, equations);
    if (term.free_pose >= 0) seen_by |= std::uint32_t{1} << term.free_pose;
    if (term.free_host >= 0) seen_by |= std::uint32_t{1} << term.free_host;
    D += term.weight * (term.J_rho[0] * term.J_rho[0] + term.J_rho[1] * term.J_rho[1]);
    g += term.weight * (term.J_rho[0] * term.r.x() + term.J_rho[1] * term.r.y());
  }
  *sums = {cost, D, g, seen_by, false};
}

template void BundleTerms::add_pixels<true>(const Camera&, const AdjustOptions&, const Bundle&, int, Sums*);
template void BundleTerms::add_pixels<false>(const Camera&, const AdjustOptions&, const Bundle&, int, Sums*);

}  // namespace pf
