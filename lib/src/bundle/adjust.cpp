#include "bundle/adjust.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "bundle/tuning.h"
#include "geometry/camera_distortion.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {
namespace {

using namespace tuning::adjust;

constexpr int kSeenBits = 16;  ///< of such a mask in one array

int host_of(const Bundle& bundle, int point) { return bundle.host == nullptr ? 0 : bundle.host[point]; }

RhoPrior prior_of(const AdjustOptions& options, const Bundle& bundle, int point) {
  return bundle.prior == nullptr ? RhoPrior{options.rho_mean, options.rho_sigma} : bundle.prior[point];
}

const Camera& camera_of(const Camera& camera, const Bundle& bundle) {
  return bundle.lens == nullptr ? camera : *bundle.lens->camera;
}

bool is_finite(const BundlePose& pose) { return pose.q_WC.coeffs().allFinite() && pose.p_W.allFinite(); }

/// Two numbers in one register. What is computed with them is what single numbers would give, to the last bit.
typedef Scalar Pair __attribute__((vector_size(2 * sizeof(Scalar))));

inline Pair load(const Scalar* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}
inline void store(Scalar* to, Pair pair) { std::memcpy(to, &pair, sizeof pair); }
inline Pair twice(Scalar v) { return Pair{v, v}; }

/// Columns of a 2x3 Jacobian.
struct Columns {
  Pair at[3];
};

/// Two rows of a Jacobian by (theta, p), two columns in one register.
struct PoseRows {
  Pair x[3], y[3];
};

/// [J [v]x, scale J]. -J gives the rows of the host with -scale.
inline PoseRows pose_rows(const Columns& J, const Vec3& v, Scalar scale) {
  const Pair c[6] = {J.at[1] * v.z() - J.at[2] * v.y(),
                     J.at[2] * v.x() - J.at[0] * v.z(),
                     J.at[0] * v.y() - J.at[1] * v.x(),
                     scale * J.at[0],
                     scale * J.at[1],
                     scale * J.at[2]};
  PoseRows rows;
  for (int k = 0; k < 3; ++k) {
    rows.x[k] = Pair{c[2 * k][0], c[2 * k + 1][0]};
    rows.y[k] = Pair{c[2 * k][1], c[2 * k + 1][1]};
  }
  return rows;
}

/// H += weight AᵀB in the first 2 kPairs columns of rows 2 k and 2 k + 1.
template <int kPairs>
inline void add_two_rows(const PoseRows& A, const PoseRows& B, Scalar weight, int k, Scalar* H, int ld) {
  for (int a = 0; a < 2; ++a) {
    const Pair x = twice(A.x[k][a]), y = twice(A.y[k][a]);
    Scalar* row = H + (2 * k + a) * ld;
    for (int e = 0; e < kPairs; ++e) store(row + 2 * e, load(row + 2 * e) + weight * (x * B.x[e] + y * B.y[e]));
  }
}

/// H += weight AᵀB, six by six.
inline void add_block(const PoseRows& A, const PoseRows& B, Scalar weight, Scalar* H, int ld) {
  add_two_rows<3>(A, B, weight, 0, H, ld);
  add_two_rows<3>(A, B, weight, 1, H, ld);
  add_two_rows<3>(A, B, weight, 2, H, ld);
}

/// H += weight JᵀJ: the lower triangle, and one number to the right of it in every other row.
inline void add_square(const PoseRows& J, Scalar weight, Scalar* H, int ld) {
  add_two_rows<1>(J, J, weight, 0, H, ld);
  add_two_rows<2>(J, J, weight, 1, H, ld);
  add_two_rows<3>(J, J, weight, 2, H, ld);
}

/// b += weight Jᵀr.
inline void add_column(const PoseRows& J, Scalar r_x, Scalar r_y, Scalar weight, Scalar* b) {
  for (int e = 0; e < 3; ++e) store(b + 2 * e, load(b + 2 * e) + weight * (J.x[e] * r_x + J.y[e] * r_y));
}

/// H += Jᵀ v, six rows in one column.
inline void add_lens_column(const PoseRows& J, const Vec2& v, Scalar* H, int ld) {
  for (int a = 0; a < 6; ++a, H += ld) *H += J.x[a / 2][a % 2] * v.x() + J.y[a / 2][a % 2] * v.y();
}

/// H -= t wᵀ.
inline void subtract_block(const Scalar (&t)[6], const Scalar* w, Scalar* H, int ld) {
  const Pair row[3] = {load(w), load(w + 2), load(w + 4)};
  for (int a = 0; a < 6; ++a, H += ld)
    for (int e = 0; e < 3; ++e) store(H + 2 * e, load(H + 2 * e) - t[a] * row[e]);
}
template <int kRows, int kColumns>
inline void subtract_small(const Scalar (&t)[6], const Scalar* w, Scalar* H, int ld) {
  Scalar row[kColumns];
  for (int e = 0; e < kColumns; ++e) row[e] = w[e];
  for (int a = 0; a < kRows; ++a, H += ld)
    for (int e = 0; e < kColumns; ++e) H[e] -= t[a] * row[e];
}

}  // namespace

/// Without a branch: which pixels are outliers cannot be predicted. sqrt(h h) is h, and 2 h r - h² <= r².
Scalar huber_cost(Scalar r2, Scalar huber, Scalar* weight) {
  const Scalar r = std::sqrt(std::max(r2, huber * huber));
  *weight = huber / r;
  return std::min(r2, Scalar(2) * huber * r - huber * huber);
}

bool project_bearing(const Camera& camera, const Mat3& R_WC, const Vec3& ray_W, const Vec3& p_HC_W, Scalar rho,
                     Vec2* pixel, Mat26* J_z_C, Mat26* J_z_H, Vec2* J_z_rho) {
  const Mat3 R_CW = R_WC.transpose();
  const Vec3 d = ray_W + rho * p_HC_W;
  if (J_z_C == nullptr) return project(camera, R_CW.lazyProduct(d), pixel);
  Mat23 J_z_d_C;
  if (!project(camera, R_CW.lazyProduct(d), pixel, &J_z_d_C)) return false;
  const Mat23 J_z_d = J_z_d_C.lazyProduct(R_CW);
  J_z_C->leftCols<3>() = J_z_d.lazyProduct(hat(d));
  J_z_C->rightCols<3>() = -rho * J_z_d;
  if (J_z_H != nullptr) {
    J_z_H->leftCols<3>() = -J_z_d.lazyProduct(hat(ray_W));
    J_z_H->rightCols<3>() = rho * J_z_d;
  }
  if (J_z_rho != nullptr) *J_z_rho = J_z_d.lazyProduct(p_HC_W);
  return true;
}

Scalar bearing_plane_distance(const BundlePlane& plane, const Vec3& ray_W, const Vec3& p_H, Scalar rho,
                              Mat13* J_e_plane, Mat16* J_e_H, Scalar* J_e_rho) {
  const Vec3 q = ray_W / rho;
  Mat13 n;
  const Scalar e = plane_distance(plane.frame, plane.x, p_H + q, J_e_plane, &n);
  if (J_e_H != nullptr) {
    J_e_H->leftCols<3>() = q.cross(n.transpose()).transpose();
    J_e_H->rightCols<3>() = n;
  }
  if (J_e_rho != nullptr) *J_e_rho = -n.dot(q) / rho;
  return e;
}

Scalar relative_plane_distance(const BundlePlane& plane, const Vec3& ray_W, const Vec3& p_H, Scalar rho,
                               Scalar rho_before, Mat13* J_e_plane, Mat16* J_e_H, Scalar* J_e_rho) {
  const Scalar e = bearing_plane_distance(plane, ray_W, p_H, rho, J_e_plane, J_e_H, J_e_rho);
  const Scalar ratio = rho / rho_before;
  if (J_e_plane != nullptr) *J_e_plane *= ratio;
  if (J_e_H != nullptr) *J_e_H *= ratio;
  if (J_e_rho != nullptr) *J_e_rho = ratio * *J_e_rho + e / rho_before;
  return ratio * e;
}

bool BundleAdjuster::layout(Arena& arena, int max_poses, int max_free_poses, int max_points, int max_planes,
                            int max_lens_rows) {
  if (max_poses > kMaxPoses) return false;
  ld_ = 3 * max_planes + max_lens_rows + 6 * max_free_poses;
  plane_part_ = max_planes > 0 ? 3 : 0;
  w_ld_ = plane_part_ + max_lens_rows + 6 * max_free_poses;
  const std::size_t poses = static_cast<std::size_t>(max_poses), points = static_cast<std::size_t>(max_points);
  const std::size_t planes = static_cast<std::size_t>(max_planes), columns = static_cast<std::size_t>(ld_);
  free_ = arena.take<int>(poses);
  free_plane_ = arena.take<int>(planes);
  R_CW_ = arena.take<Mat3>(poses);
  old_pose_ = arena.take<BundlePose>(poses);
  old_plane_ = arena.take<Vec3>(planes);
  old_rho_ = arena.take<Scalar>(points);
  of_lens_ = max_lens_rows > 0 ? arena.take<OfLens>(1) : nullptr;
  seen_ = arena.take<std::uint16_t>(points);
  seen_later_ = max_poses > kSeenBits ? arena.take<std::uint16_t>(points) : nullptr;
  H_ = arena.take<Scalar>(columns * columns);
  b_ = arena.take<Scalar>(columns);
  W_ = arena.take<Scalar>(points * static_cast<std::size_t>(w_ld_));
  D_ = arena.take<Scalar>(points);
  g_ = arena.take<Scalar>(points);
  return arena.ok();
}

std::uint32_t BundleAdjuster::seen(int point) const {
  return seen_[point] | (seen_later_ != nullptr ? static_cast<std::uint32_t>(seen_later_[point]) << kSeenBits : 0u);
}

Scalar BundleAdjuster::rho_step(int point) const {
  if (!(D_[point] > Scalar(0))) return Scalar(0);
  Scalar g = g_[point];
  const Scalar* w = W_ + point * w_ld_;
  const int plane = free_plane_of(point);
  for (int a = 0; a < 3 && plane >= 0; ++a) g -= w[a] * b_[3 * plane + a];
  w += plane_part_;
  const Scalar* dx = b_ + plane_columns_;
  for (int a = 0; a < columns_ - plane_columns_; ++a) g -= w[a] * dx[a];
  return g / D_[point];
}

/// Adds a point's pixels to H_pp and b, and to its row of W, D and g. Fixed poses have neither columns nor Jacobians.
template <bool kCostAlone>
void BundleAdjuster::add_pixels(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, int point,
                                Sums* sums) {
  const int host = host_of(bundle, point), free_host = free_[host];
  const Mat3 R_WH = R_CW_[host].transpose();
  const Vec3 ray_W = R_WH.lazyProduct(bundle.ray[point]);
  const Vec3 p_H = bundle.pose[host].p_W;
  const Scalar rho = bundle.rho[point];
  const bool is_pinhole = camera.model == static_cast<int>(CameraModel::kPinhole);
  Scalar D = sums->D, g = sums->g, cost = sums->cost;
  std::uint32_t seen_by = 0;
  Scalar information = Scalar(1) / (options.sigma_px * options.sigma_px);
  for (std::uint32_t left = seen(point); left != 0; left &= left - 1) {
    const int c = __builtin_ctz(left);
    const BundlePose& pose = bundle.pose[c];
    const BundlePixel& measured = pose.pixel[point];
    const Mat3& R_CW = R_CW_[c];
    const Vec3 p_HC_W = p_H - pose.p_W;
    const Vec3 d = ray_W + rho * p_HC_W;
    const Vec3 d_C = R_CW.lazyProduct(d);
    Vec2 z;
    Mat23 J_z_d_C;
    Vec4 slope = Vec4::Zero();
    if (!(is_pinhole ? project_pinhole(camera, d_C, &z, &slope) : project(camera, d_C, &z, &J_z_d_C))) {
      cost += options.no_pixel_penalty;
      continue;
    }
    const Vec2 r = measured.pixel() - z;
    if (options.class_sigma_px != nullptr) {
      const Scalar sigma = options.class_sigma_px[measured.sigma_class];
      information = Scalar(1) / (sigma * sigma);
    }
    Scalar weight;
    cost += huber_cost(r.squaredNorm() * information, options.huber, &weight);
    if (kCostAlone) continue;
    weight *= information;
    const int free_pose = free_[c];
    if (free_pose < 0 && free_host < 0 && lens_columns_ == 0) {
      const Vec3 p_HC_C = R_CW.lazyProduct(p_HC_W);
      const Vec2 J_rho = is_pinhole ? Vec2(slope(0) * p_HC_C.x() + slope(1) * p_HC_C.z(),
                                           slope(2) * p_HC_C.y() + slope(3) * p_HC_C.z())
                                    : Vec2(J_z_d_C.lazyProduct(p_HC_C));
      D += weight * J_rho.squaredNorm();
      g += weight * J_rho.dot(r);
      continue;
    }
    Columns J_z_d;
    if (is_pinhole) {
      for (int m = 0; m < 3; ++m)
        J_z_d.at[m] = Pair{slope(0), slope(2)} * load(&R_CW(0, m)) + Pair{slope(1), slope(3)} * R_CW(2, m);
    } else {
      const Mat23 J = J_z_d_C.lazyProduct(R_CW);
      for (int m = 0; m < 3; ++m) J_z_d.at[m] = load(&J(0, m));
    }
    const Pair J_rho = J_z_d.at[0] * p_HC_W.x() + J_z_d.at[1] * p_HC_W.y() + J_z_d.at[2] * p_HC_W.z();
    PoseRows J_C, J_H;
    if (free_pose >= 0) {
      J_C = pose_rows(J_z_d, d, -rho);
      const int column = pose_column(free_pose);
      add_square(J_C, weight, H_ + column * (ld_ + 1), ld_);
      add_column(J_C, r.x(), r.y(), weight, b_ + column);
      add_column(J_C, J_rho[0], J_rho[1], weight, pose_part(point, free_pose));
      seen_by |= std::uint32_t{1} << free_pose;
    }
    if (free_host >= 0) {
      for (Pair& column : J_z_d.at) column = -column;
      J_H = pose_rows(J_z_d, ray_W, -rho);
      const int column = pose_column(free_host);
      add_square(J_H, weight, H_ + column * (ld_ + 1), ld_);
      add_column(J_H, r.x(), r.y(), weight, b_ + column);
      add_column(J_H, J_rho[0], J_rho[1], weight, pose_part(point, free_host));
      seen_by |= std::uint32_t{1} << free_host;
    }
    if (free_pose >= 0 && free_host >= 0) {  // in the triangle's lower half
      if (free_pose > free_host)
        add_block(J_C, J_H, weight, H_ + pose_column(free_pose) * ld_ + pose_column(free_host), ld_);
      else
        add_block(J_H, J_C, weight, H_ + pose_column(free_host) * ld_ + pose_column(free_pose), ld_);
    }
    if (lens_columns_ > 0) {
      Mat23 J;
      for (int m = 0; m < 3; ++m) J.col(m) = Vec2(J_z_d.at[m][0], J_z_d.at[m][1]);
      if (free_host >= 0) J = -J;  // the columns were turned for the host
      const LensJacobian J_lens = bearing_lens_jacobian(camera, d_C, J, of_lens_->J_ray_W);
      const std::int8_t* parameter = bundle.lens->rows.parameter;
      Scalar* w = lens_part(point);
      for (int a = 0; a < lens_columns_; ++a) {
        const Vec2 by_a = weight * J_lens.col(parameter[a]);
        Scalar* row = H_ + (plane_columns_ + a) * ld_ + plane_columns_;
        for (int k = 0; k <= a; ++k) row[k] += by_a.dot(J_lens.col(parameter[k]));
        b_[plane_columns_ + a] += by_a.dot(r);
        w[a] += by_a.x() * J_rho[0] + by_a.y() * J_rho[1];
        if (free_pose >= 0) add_lens_column(J_C, by_a, H_ + pose_column(free_pose) * ld_ + plane_columns_ + a, ld_);
        if (free_host >= 0) add_lens_column(J_H, by_a, H_ + pose_column(free_host) * ld_ + plane_columns_ + a, ld_);
      }
    }
    D += weight * (J_rho[0] * J_rho[0] + J_rho[1] * J_rho[1]);
    g += weight * (J_rho[0] * r.x() + J_rho[1] * r.y());
  }
  *sums = {cost, D, g, seen_by, false};
}

/// Adds the distance from its plane of a point that has one.
template <bool kCostAlone>
void BundleAdjuster::add_plane(const AdjustOptions& options, const Bundle& bundle, int point, Sums* sums) {
  const int index = bundle.plane_of[point];
  if (index < 0) return;
  const BundlePlane& plane = bundle.plane[index];
  const Scalar rho = bundle.rho[point];
  if (!(rho > kMinPlaneRho)) {
    sums->cost += options.no_pixel_penalty;
    return;
  }
  const int host = host_of(bundle, point);
  Mat13 J_plane;
  Mat16 J_H;
  Scalar J_rho, weight;
  const Vec3 ray_W = R_CW_[host].transpose() * bundle.ray[point], &p_H = bundle.pose[host].p_W;
  const Scalar e =
      bundle.rho_before != nullptr
          ? relative_plane_distance(plane, ray_W, p_H, rho, bundle.rho_before[point], &J_plane, &J_H, &J_rho)
          : bearing_plane_distance(plane, ray_W, p_H, rho, &J_plane, &J_H, &J_rho);
  const Scalar information = Scalar(1) / (plane.roughness * plane.roughness);
  sums->cost += huber_cost(e * e * information, options.huber, &weight);
  if (kCostAlone) return;
  weight *= information;
  sums->D += weight * J_rho * J_rho;
  sums->g -= weight * J_rho * e;
  const int free_host = free_[host], free_plane = free_plane_of(point);
  if (free_host >= 0) {
    const int column = pose_column(free_host);
    Scalar* w = pose_part(point, free_host);
    for (int a = 0; a < 6; ++a) {
      for (int f = 0; f <= a; ++f) H_[(column + a) * ld_ + column + f] += weight * J_H(a) * J_H(f);
      b_[column + a] -= weight * J_H(a) * e;
      w[a] += weight * J_H(a) * J_rho;
    }
    sums->seen_by |= std::uint32_t{1} << free_host;
    for (int a = 0; a < 6 && free_plane >= 0; ++a)
      for (int f = 0; f < 3; ++f) H_[(column + a) * ld_ + 3 * free_plane + f] += weight * J_H(a) * J_plane(f);
  }
  // e = n . (p_H + R_WH r(c) / rho) - d
  for (int k = 0; k < lens_columns_; ++k) {
    const Vec3 n = J_H.rightCols<3>().transpose();
    const auto by = [&](int column) { return n.dot(of_lens_->J_ray_W.col(bundle.lens->rows.parameter[column])) / rho; };
    const Scalar by_k = weight * by(k);
    Scalar* row = H_ + (plane_columns_ + k) * ld_;
    for (int f = 0; f <= k; ++f) row[plane_columns_ + f] += by_k * by(f);
    for (int f = 0; f < 3 && free_plane >= 0; ++f) row[3 * free_plane + f] += by_k * J_plane(f);
    for (int a = 0; a < 6 && free_host >= 0; ++a)
      H_[(pose_column(free_host) + a) * ld_ + plane_columns_ + k] += by_k * J_H(a);
    b_[plane_columns_ + k] -= by_k * e;
    lens_part(point)[k] += by_k * J_rho;
  }
  if (free_plane >= 0) {
    Scalar* w = W_ + point * w_ld_;
    for (int a = 0; a < 3; ++a) {
      for (int f = 0; f <= a; ++f)
        H_[(3 * free_plane + a) * ld_ + 3 * free_plane + f] += weight * J_plane(a) * J_plane(f);
      b_[3 * free_plane + a] -= weight * J_plane(a) * e;
      w[a] += weight * J_plane(a) * J_rho;
    }
    sums->on_plane = true;
  }
}

/// H -= w wᵀ / D and b -= w g / D, in the blocks that w touches alone.
void BundleAdjuster::eliminate(int point, const Sums& sums) {
  const Scalar D = D_[point], g = g_[point];
  const Scalar* w_plane = W_ + point * w_ld_;
  const int plane_column = sums.on_plane ? 3 * free_plane_of(point) : 0;
  Scalar t[6];
  if (sums.on_plane) {
    for (int a = 0; a < 3; ++a) t[a] = w_plane[a] / D;
    subtract_small<3, 3>(t, w_plane, H_ + plane_column * (ld_ + 1), ld_);
    for (int a = 0; a < 3; ++a) b_[plane_column + a] -= t[a] * g;
  }
  const Scalar* w_lens = lens_part(point);
  for (int a = 0; a < lens_columns_; ++a) {
    const Scalar share = w_lens[a] / D;
    Scalar* row = H_ + (plane_columns_ + a) * ld_;
    for (int f = 0; f < 3 && sums.on_plane; ++f) row[plane_column + f] -= share * w_plane[f];
    for (int k = 0; k <= a; ++k) row[plane_columns_ + k] -= share * w_lens[k];
    b_[plane_columns_ + a] -= share * g;
  }
  for (int f = 0; sums.seen_by >> f != 0; ++f) {
    if ((sums.seen_by >> f & 1) == 0) continue;
    const int column = pose_column(f);
    const Scalar* w = pose_part(point, f);
    for (int a = 0; a < 6; ++a) t[a] = w[a] / D;
    if (sums.on_plane) subtract_small<6, 3>(t, w_plane, H_ + column * ld_ + plane_column, ld_);
    for (int a = 0; a < 6 && lens_columns_ > 0; ++a)
      for (int k = 0; k < lens_columns_; ++k) H_[(column + a) * ld_ + plane_columns_ + k] -= t[a] * w_lens[k];
    for (int k = 0; k <= f; ++k)
      if ((sums.seen_by >> k & 1) != 0) subtract_block(t, pose_part(point, k), H_ + column * ld_ + pose_column(k), ld_);
    for (int a = 0; a < 6; ++a) b_[column + a] -= t[a] * g;
  }
}

/// The bearing of a point's host pixel, and its derivative in W (null to skip). False where the lens has none; the bearing then stays.
bool BundleAdjuster::set_ray(const Bundle& bundle, int point, RayByLens* J_ray_W) const {
  const BundleLens& lens = *bundle.lens;
  const HostPixel& host = lens.host_pixel[point];
  if (J_ray_W != nullptr) J_ray_W->setZero();
  if (!host.given) return true;
  Mat32 J_ray_z;
  if (!unproject(*lens.camera, host.pixel, &lens.ray[point], J_ray_W != nullptr ? &J_ray_z : nullptr)) return false;
  if (J_ray_W != nullptr)
    *J_ray_W = R_CW_[host_of(bundle, point)].transpose().lazyProduct(
        ray_lens_jacobian(*lens.camera, lens.ray[point], J_ray_z));
  return true;
}

Scalar BundleAdjuster::add_lens_prior(const Bundle& bundle, bool cost_alone) {
  if (lens_columns_ == 0) return Scalar(0);
  Scalar e[kLensParameters], sum = 0;
  lens_difference(bundle.lens->rows, bundle.lens->prior, *bundle.lens->camera, e);
  for (int a = 0; a < lens_columns_; ++a) {
    const Scalar* information = bundle.lens->prior_information + a * lens_columns_;
    Scalar gradient = 0;
    for (int k = 0; k < lens_columns_; ++k) gradient += information[k] * e[k];
    sum += e[a] * gradient;
    if (cost_alone) continue;
    for (int k = 0; k <= a; ++k) H_[(plane_columns_ + a) * ld_ + plane_columns_ + k] += information[k];
    b_[plane_columns_ + a] -= gradient;
  }
  return sum;
}

Scalar BundleAdjuster::add_held_distance(const Bundle& bundle, bool cost_alone) {
  if (bundle.held == nullptr) return Scalar(0);
  const BundleDistance& held = *bundle.held;
  const Vec3 apart = bundle.pose[held.pose].p_W - held.from_W;
  const Scalar distance = apart.norm(), e = (distance - held.distance) / held.sigma;
  if (cost_alone || !(distance > Scalar(0))) return e * e;
  const Vec3 J = apart / (distance * held.sigma);
  const int column = pose_column(free_[held.pose]) + 3;
  for (int a = 0; a < 3; ++a) {
    for (int k = 0; k <= a; ++k) H_[(column + a) * ld_ + column + k] += J(a) * J(k);
    b_[column + a] -= J(a) * e;
  }
  return e * e;
}

/// Cost and, unless kCostAlone, derivatives of what is measured and known of a point.
template <bool kCostAlone>
BundleAdjuster::Sums BundleAdjuster::add_point(const Camera& camera, const AdjustOptions& options, const Bundle& bundle,
                                               int point) {
  Sums sums = {Scalar(0), Scalar(0), Scalar(0), 0, false};
  const RhoPrior prior = prior_of(options, bundle, point);
  if (prior.sigma > Scalar(0)) {
    const Scalar e = prior.mean - bundle.rho[point];
    sums.D = Scalar(1) / (prior.sigma * prior.sigma) *
             (bundle.rho[point] < Scalar(0) ? Scalar(1) + options.behind_weight : Scalar(1));
    sums.g = sums.D * e;
    sums.cost = sums.g * e;
  }
  if (lens_columns_ > 0 && !set_ray(bundle, point, kCostAlone ? nullptr : &of_lens_->J_ray_W)) {
    for (std::uint32_t left = seen(point); left != 0; left &= left - 1) sums.cost += options.no_pixel_penalty;
    if (bundle.plane_of != nullptr && bundle.plane_of[point] >= 0) sums.cost += options.no_pixel_penalty;
    return sums;
  }
  add_pixels<kCostAlone>(camera, options, bundle, point, &sums);
  if (bundle.plane_of != nullptr) add_plane<kCostAlone>(options, bundle, point, &sums);
  return sums;
}

void BundleAdjuster::begin(const Bundle& bundle) {
  plane_columns_ = 0;
  plane_of_ = bundle.plane_of;
  for (int j = 0; j < bundle.planes && plane_part_ > 0; ++j) {
    free_plane_[j] = bundle.plane[j].free ? plane_columns_ / 3 : -1;
    plane_columns_ += bundle.plane[j].free ? 3 : 0;
  }
  lens_columns_ = bundle.lens == nullptr ? 0 : bundle.lens->rows.count;
  int free_poses = 0;
  for (int c = 0; c < bundle.poses; ++c) free_[c] = bundle.pose[c].free ? free_poses++ : -1;
  columns_ = pose_column(free_poses);
  PF_ASSERT(columns_ <= ld_);
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

void BundleAdjuster::set_rotations(const Bundle& bundle) {
  for (int c = 0; c < bundle.poses; ++c) R_CW_[c] = bundle.pose[c].q_WC.toRotationMatrix().transpose();
}

Scalar BundleAdjuster::cost(const Camera& camera, const AdjustOptions& options, const Bundle& bundle) {
  set_rotations(bundle);
  Scalar sum = add_lens_prior(bundle, true) + add_held_distance(bundle, true);
  for (int i = 0; i < bundle.points; ++i) sum += add_point<true>(camera, options, bundle, i).cost;
  return sum;
}

/// Returns the cost. H_ becomes S without its own damping, b_ its right side; W_, D_ (damped) and g_ as step() writes
/// them.
Scalar BundleAdjuster::linearise(const Camera& camera, const AdjustOptions& options, const Bundle& bundle,
                                 Scalar damping) {
  set_rotations(bundle);
  for (int a = 0; a < columns_; ++a) {
    std::fill(H_ + a * ld_, H_ + a * ld_ + columns_, Scalar(0));
    b_[a] = Scalar(0);
  }
  Scalar sum = add_lens_prior(bundle, false) + add_held_distance(bundle, false);
  for (int i = 0; i < bundle.points; ++i) {
    std::fill(W_ + i * w_ld_, W_ + i * w_ld_ + plane_part_ + columns_ - plane_columns_, Scalar(0));
    const Sums sums = add_point<false>(camera, options, bundle, i);
    sum += sums.cost;
    D_[i] = sums.D < kMinInformation ? sums.D + damping * kMinInformation : sums.D * (Scalar(1) + damping);
    g_[i] = sums.g;
    if (D_[i] > kNoInformation)
      eliminate(i, sums);
    else
      D_[i] = Scalar(0);
  }
  return sum;
}

bool BundleAdjuster::solve(Scalar damping) {
  for (int a = 0; a < columns_; ++a) H_[a * ld_ + a] += damping * std::abs(H_[a * ld_ + a]) + kRegularisation;
  if (!factor_cholesky(H_, columns_, ld_)) return false;
  solve_cholesky(H_, columns_, ld_, b_);
  return true;
}

bool BundleAdjuster::step(const Camera& camera, const AdjustOptions& options, const Bundle& bundle, Scalar damping) {
  begin(bundle);
  linearise(camera_of(camera, bundle), options, bundle, damping);
  return solve(damping);
}

/// Moves what is free by the step; false when something is then no number.
bool BundleAdjuster::take_step(const Bundle& bundle) {
  bool finite = true;
  const Scalar* dx = b_;
  for (int j = 0; j < bundle.planes && plane_columns_ > 0; ++j) {
    BundlePlane& plane = bundle.plane[j];
    if (!plane.free) continue;
    plane.x += Vec3(dx[0], dx[1], dx[2]);
    finite = finite && plane.x.allFinite();
    dx += 3;
  }
  if (lens_columns_ > 0) {
    move_lens(bundle.lens->rows, dx, bundle.lens->camera);
    finite = finite && check_camera(*bundle.lens->camera) == nullptr;
    dx += lens_columns_;
  }
  for (int c = 0; c < bundle.poses; ++c) {
    BundlePose& pose = bundle.pose[c];
    if (!pose.free) continue;
    pose.q_WC = exp_so3(Vec3(dx[0], dx[1], dx[2])) * pose.q_WC;
    pose.q_WC.normalize();
    pose.p_W += Vec3(dx[3], dx[4], dx[5]);
    finite = finite && is_finite(pose);
    dx += 6;
  }
  for (int i = 0; i < bundle.points; ++i) {
    bundle.rho[i] += rho_step(i);
    finite = finite && std::isfinite(bundle.rho[i]);
  }
  return finite;
}

void BundleAdjuster::keep(const Bundle& bundle) {
  std::copy(bundle.pose, bundle.pose + bundle.poses, old_pose_);
  std::copy(bundle.rho, bundle.rho + bundle.points, old_rho_);
  for (int j = 0, k = 0; j < bundle.planes && plane_columns_ > 0; ++j)
    if (bundle.plane[j].free) old_plane_[k++] = bundle.plane[j].x;
  if (lens_columns_ > 0) of_lens_->old = *bundle.lens->camera;
}

void BundleAdjuster::restore(const Bundle& bundle) {
  std::copy(old_pose_, old_pose_ + bundle.poses, bundle.pose);
  std::copy(old_rho_, old_rho_ + bundle.points, bundle.rho);
  for (int j = 0, k = 0; j < bundle.planes && plane_columns_ > 0; ++j)
    if (bundle.plane[j].free) bundle.plane[j].x = old_plane_[k++];
  if (lens_columns_ > 0) *bundle.lens->camera = of_lens_->old;
  for (int i = 0; i < bundle.points && lens_columns_ > 0; ++i) set_ray(bundle, i, nullptr);
}

/// Where a step is tried, cost and linearisation come together, with the damping of the round that follows if the step is kept; so
/// each pixel is projected once a round, and once more after a step that is not. Where the last gain was near to the bound, the step is
/// probably the last one, and its cost is enough.
Scalar BundleAdjuster::adjust(const Camera& calibration, const AdjustOptions& options, const Bundle& bundle) {
  const Camera& camera = camera_of(calibration, bundle);
  begin(bundle);
  Scalar damping = kFirstDamping;
  Scalar before = linearise(camera, options, bundle, damping);
  bool last = false;
  for (rounds_ = 0; rounds_ < options.max_rounds;) {
    ++rounds_;
    last = last || rounds_ == options.max_rounds;
    keep(bundle);
    const Scalar next = std::max(damping / kDampingDown, kMinDamping);
    Scalar after = before;
    if (solve(damping) && take_step(bundle))
      after = last ? cost(camera, options, bundle) : linearise(camera, options, bundle, next);
    if (after < before) {
      const Scalar gain = before - after, bound = options.small_gain * before;
      before = after;
      damping = next;
      if (gain < bound) break;
      if (last && rounds_ < options.max_rounds) linearise(camera, options, bundle, damping);
      last = gain < kNearlyDone * bound;
    } else {
      restore(bundle);
      damping *= kDampingUp;
      if (damping > kMaxDamping) break;
      if (rounds_ < options.max_rounds) linearise(camera, options, bundle, damping);
    }
  }
  return before;
}

/// S = L Lᵀ with the last pose's rows last: their covariance is (L_22 L_22ᵀ)⁻¹.
bool BundleAdjuster::last_pose_covariance(const Camera& camera, const AdjustOptions& options, const Bundle& bundle,
                                          Mat6* covariance) {
  if (!begin_covariances(camera, options, bundle) || columns_ == pose_column(0)) return false;
  const Scalar* L = H_ + (columns_ - 6) * (ld_ + 1);
  for (int c = 0; c < 6; ++c) {
    Vec6 x = Vec6::Zero();
    x(c) = Scalar(1);
    solve_cholesky(L, 6, ld_, x.data());
    covariance->col(c) = x;
  }
  return true;
}

bool BundleAdjuster::begin_covariances(const Camera& camera, const AdjustOptions& options, const Bundle& bundle) {
  begin(bundle);
  linearise(camera_of(camera, bundle), options, bundle, Scalar(0));
  return columns_ > 0 && factor_cholesky(H_, columns_, ld_);
}

Mat6 BundleAdjuster::pose_covariance(int pose) const {
  Mat6 covariance = Mat6::Zero();
  if (free_[pose] < 0) return covariance;
  const int column = pose_column(free_[pose]);
  for (int c = 0; c < 6; ++c) {
    std::fill(b_, b_ + columns_, Scalar(0));
    b_[column + c] = Scalar(1);
    solve_cholesky(H_, columns_, ld_, b_);
    for (int a = 0; a < 6; ++a) covariance(a, c) = b_[column + a];
  }
  return covariance;
}

Mat3 BundleAdjuster::plane_covariance(int plane) const {
  Mat3 covariance = Mat3::Zero();
  if (plane_columns_ == 0 || free_plane_[plane] < 0) return covariance;
  const int column = 3 * free_plane_[plane];
  for (int c = 0; c < 3; ++c) {
    std::fill(b_, b_ + columns_, Scalar(0));
    b_[column + c] = Scalar(1);
    solve_cholesky(H_, columns_, ld_, b_);
    for (int a = 0; a < 3; ++a) covariance(a, c) = b_[column + a];
  }
  return covariance;
}

void BundleAdjuster::lens_covariance(Scalar* covariance) const {
  for (int c = 0; c < lens_columns_; ++c) {
    std::fill(b_, b_ + columns_, Scalar(0));
    b_[plane_columns_ + c] = Scalar(1);
    solve_cholesky(H_, columns_, ld_, b_);
    for (int a = 0; a < lens_columns_; ++a) covariance[a * lens_columns_ + c] = b_[plane_columns_ + a];
  }
}

/// b_ = factor w.
void BundleAdjuster::spread(int point, Scalar factor) const {
  std::fill(b_, b_ + columns_, Scalar(0));
  const int plane = free_plane_of(point);
  const Scalar* w = W_ + point * w_ld_;
  for (int a = 0; a < 3 && plane >= 0; ++a) b_[3 * plane + a] = factor * w[a];
  for (int a = 0; a < columns_ - plane_columns_; ++a) b_[plane_columns_ + a] = factor * w[plane_part_ + a];
}

/// w . b_.
Scalar BundleAdjuster::gather(int point) const {
  Scalar sum = 0;
  const int plane = free_plane_of(point);
  const Scalar* w = W_ + point * w_ld_;
  for (int a = 0; a < 3 && plane >= 0; ++a) sum += w[a] * b_[3 * plane + a];
  for (int a = 0; a < columns_ - plane_columns_; ++a) sum += w[plane_part_ + a] * b_[plane_columns_ + a];
  return sum;
}

/// With the other unknowns x: drho = -wᵀ dx / D + e, var(e) = 1 / D.
Scalar BundleAdjuster::rho_variance(int point) const {
  const Scalar D = D_[point];
  if (!(D > Scalar(0))) return std::numeric_limits<Scalar>::infinity();
  spread(point, Scalar(1) / D);
  solve_cholesky(H_, columns_, ld_, b_);
  return Scalar(1) / D + gather(point) / D;
}

/// dp = M dx + j e,  M = dp/dx_H + R_WH dr/dc / rho - j wᵀ / D,  j = dp/drho = -q / rho.
bool BundleAdjuster::point_covariance(const Bundle& bundle, int point, Scalar sigma_bearing, Mat3* covariance) const {
  const Scalar D = D_[point], rho = bundle.rho[point];
  if (!(D > Scalar(0)) || !(rho > Scalar(0))) return false;
  const int host = host_of(bundle, point), free_host = free_[host];
  const Vec3 q = bundle.pose[host].q_WC * bundle.ray[point] / rho, j = -q / rho;
  const Mat3 turn = -hat(q);
  RayByLens by_lens = RayByLens::Zero();
  if (lens_columns_ > 0) set_ray(bundle, point, &by_lens);
  const auto by = [&](int row, int k) { return by_lens(row, bundle.lens->rows.parameter[k]) / rho; };
  Mat3 P = j * j.transpose() / D;
  P += sigma_bearing * sigma_bearing * (q.squaredNorm() * Mat3::Identity() - q * q.transpose());
  for (int c = 0; c < 3; ++c) {
    spread(point, -j(c) / D);
    Scalar* of_host = free_host >= 0 ? b_ + pose_column(free_host) : nullptr;
    for (int a = 0; a < 3 && of_host != nullptr; ++a) of_host[a] += turn(c, a);
    if (of_host != nullptr) of_host[3 + c] += Scalar(1);
    for (int k = 0; k < lens_columns_; ++k) b_[plane_columns_ + k] += by(c, k);
    solve_cholesky(H_, columns_, ld_, b_);
    const Scalar along_w = gather(point) / D;
    for (int r = 0; r < 3; ++r) {
      P(r, c) -= j(r) * along_w;
      for (int a = 0; a < 3 && of_host != nullptr; ++a) P(r, c) += turn(r, a) * of_host[a];
      if (of_host != nullptr) P(r, c) += of_host[3 + r];
      for (int k = 0; k < lens_columns_; ++k) P(r, c) += by(r, k) * b_[plane_columns_ + k];
    }
  }
  *covariance = (P + P.transpose()) / 2;
  return true;
}

}  // namespace pf
