// The bundle adjuster with planes, priors by point, classes of pixels and a lens, against dense normal equations.
#include "same.h"
#include "support/bounds.h"
#include "support/dense.h"
#include "support/random_window.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr bool kIsFloat = sizeof(Scalar) == 4;

/// Normal equations in double, by (free planes, free poses, rho).
struct DenseSystem {
  Dense H;
  Eigen::VectorXd g;
  std::vector<int> pose, plane;  ///< first columns, -1 where it is fixed
  int first_rho = 0, first_lens = 0;

  explicit DenseSystem(const RandomWindow& w, const BundleLens* lens = nullptr) {
    for (const BundlePlane& p : w.plane) {
      plane.push_back(p.free ? first_rho : -1);
      first_rho += p.free ? 3 : 0;
    }
    first_lens = first_rho;
    const int lens_rows = lens == nullptr ? 0 : lens->rows.count;
    first_rho += lens_rows;
    const Camera& camera = lens == nullptr ? w.camera : *lens->camera;
    for (const BundlePose& p : w.pose) {
      pose.push_back(p.free ? first_rho : -1);
      first_rho += p.free ? 6 : 0;
    }
    const Eigen::Index n = first_rho + static_cast<Eigen::Index>(w.rho.size());
    H = Dense::Zero(n, n);
    g = Eigen::VectorXd::Zero(n);
    for (std::size_t i = 0; i < w.rho.size(); ++i) {
      const auto h = static_cast<std::size_t>(w.host[i]);
      const Eigen::Index own = first_rho + static_cast<Eigen::Index>(i);
      const Vec3 ray_W = w.pose[h].q_WC * w.ray[i];
      RayByLens J_ray_W = RayByLens::Zero();
      Mat32 J_ray_z;
      Vec3 ray;
      if (lens != nullptr && lens->host_pixel[i].given) {
        TEST_ASSERT_TRUE(unproject(camera, lens->host_pixel[i].pixel, &ray, &J_ray_z));
        J_ray_W = w.pose[h].q_WC.toRotationMatrix() * ray_lens_jacobian(camera, ray, J_ray_z);
      }
      for (std::size_t c = 0; c < w.pose.size(); ++c) {
        const BundlePixel& seen = w.pixel[c][i];
        Vec2 z, J_rho;
        Mat26 J_C, J_H;
        if (!seen.seen || c == h ||
            !project_bearing(camera, w.pose[c].q_WC.toRotationMatrix(), ray_W, w.pose[h].p_W - w.pose[c].p_W, w.rho[i],
                             &z, &J_C, &J_H, &J_rho))
          continue;
        Dense J = Dense::Zero(2, n);
        if (pose[c] >= 0) J.middleCols(pose[c], 6) += J_C.cast<double>();
        if (pose[h] >= 0) J.middleCols(pose[h], 6) += J_H.cast<double>();
        J.col(own) = J_rho.cast<double>();
        const Mat3 R_CW = w.pose[c].q_WC.toRotationMatrix().transpose();
        const Vec3 d_C = R_CW * (ray_W + w.rho[i] * (w.pose[h].p_W - w.pose[c].p_W));
        Mat23 J_z_d_C;
        TEST_ASSERT_TRUE(project(camera, d_C, &z, &J_z_d_C));
        const LensJacobian J_lens = bearing_lens_jacobian(camera, d_C, J_z_d_C * R_CW, J_ray_W);
        for (int k = 0; k < lens_rows; ++k) J.col(first_lens + k) = J_lens.col(lens->rows.parameter[k]).cast<double>();
        add(J, (seen.pixel() - z).cast<double>(), static_cast<double>(w.class_sigma[seen.sigma_class]), w);
      }
      if (w.plane_of[i] >= 0) {
        const auto j = static_cast<std::size_t>(w.plane_of[i]);
        Mat13 J_plane;
        Mat16 J_H;
        Scalar J_rho;
        const Scalar e = bearing_plane_distance(w.plane[j], ray_W, w.pose[h].p_W, w.rho[i], &J_plane, &J_H, &J_rho);
        Dense J = Dense::Zero(1, n);
        if (pose[h] >= 0) J.middleCols(pose[h], 6) = J_H.cast<double>();
        if (plane[j] >= 0) J.middleCols(plane[j], 3) = J_plane.cast<double>();
        J(0, own) = static_cast<double>(J_rho);
        Vec3 normal;
        Scalar d;
        plane_normal(w.plane[j].frame, w.plane[j].x, &normal, &d);
        for (int k = 0; k < lens_rows; ++k)
          J(0, first_lens + k) = static_cast<double>(normal.dot(J_ray_W.col(lens->rows.parameter[k])) / w.rho[i]);
        add(J, Eigen::VectorXd::Constant(1, -static_cast<double>(e)), static_cast<double>(w.plane[j].roughness), w);
      }
      if (w.prior[i].sigma > 0) {
        const double information = 1 / static_cast<double>(w.prior[i].sigma * w.prior[i].sigma);
        H(own, own) += information;
        g(own) += information * static_cast<double>(w.prior[i].mean - w.rho[i]);
      }
    }
    Scalar e[kLensParameters];
    if (lens != nullptr) lens_difference(lens->rows, lens->prior, *lens->camera, e);
    for (int k = 0; k < lens_rows; ++k) {
      const double information = static_cast<double>(lens->prior_information[k * (lens_rows + 1)]);
      H(first_lens + k, first_lens + k) += information;
      g(first_lens + k) -= information * static_cast<double>(e[k]);
    }
  }

  void add(const Dense& J, const Eigen::VectorXd& r, double sigma, const RandomWindow& w) {
    const double huber = static_cast<double>(w.options.huber), sigmas = r.norm() / sigma;
    const double weight = (sigmas > huber ? huber / sigmas : 1) / (sigma * sigma);
    H += weight * J.transpose() * J;
    g += weight * J.transpose() * r;
  }
};

struct Case {
  TestArena arena;
  BundleAdjuster adjuster;
  RandomWindow window;
  Bundle bundle;

  explicit Case(SeededRandom& random, int poses = 6)
      : window(random, poses, 3, 40, 3, 0.4, 0.004), bundle(window.bundle()) {
    TEST_ASSERT_TRUE(adjuster.layout(*arena, poses, 3, 40, 3, kLensParameters));
  }
};

void expect_same(const Dense& expected, const Dense& found) {
  for (Eigen::Index a = 0; a < expected.rows(); ++a)
    for (Eigen::Index b = 0; b < expected.cols(); ++b)
      EXPECT_BELOW((kIsFloat ? 3e-2 : 1e-7) * std::sqrt(expected(a, a) * expected(b, b)),
                   std::fabs(found(a, b) - expected(a, b)));
}

void test_step_should_be_that_of_the_dense_normal_equations_when_there_are_planes() {
  SeededRandom random(61);
  for (int poses = 4; poses < 4 + 2 * kTestCameras; ++poses) {  // twice before every model of a camera
    Case c(random, poses);
    const DenseSystem dense(c.window);
    Dense H = dense.H;
    for (int i = 0; i < dense.first_rho; ++i) H(i, i) += 1e-9;
    const Eigen::VectorXd expected = solved(H, dense.g);
    TEST_ASSERT_TRUE(c.adjuster.step(c.window.camera, c.window.options, c.bundle, 0));
    double worst = 0;
    for (int a = 0; a < dense.first_rho; ++a)
      worst = std::max(worst, std::fabs(static_cast<double>(c.adjuster.plane_step()[a]) - expected(a)));
    for (int i = 0; i < c.bundle.points; ++i)
      worst = std::max(worst, std::fabs(static_cast<double>(c.adjuster.rho_step(i)) - expected(dense.first_rho + i)));
    std::printf("steps up to %.3g, difference %.3g\n", expected.cwiseAbs().maxCoeff(), worst);
    EXPECT_BELOW((kIsFloat ? 1e-2 : 1e-8) * expected.cwiseAbs().maxCoeff(), worst);
  }
}

void test_step_and_covariance_of_the_lens_should_be_those_of_the_dense_normal_equations() {
  SeededRandom random(65);
  for (int poses = 4; poses < 4 + 2 * kTestCameras; ++poses) {
    Case c(random, poses);
    adjust_lens(random, 0.3, &c.window, &c.bundle);
    const DenseSystem dense(c.window, c.bundle.lens);
    Dense H = dense.H;
    for (int i = 0; i < dense.first_rho; ++i) H(i, i) += 1e-9;
    const Eigen::VectorXd expected = solved(H, dense.g);
    TEST_ASSERT_TRUE(c.adjuster.step(c.window.camera, c.window.options, c.bundle, 0));
    const auto off = [](double found, double wanted, double size) { return std::fabs(found - wanted) / size; };
    double worst = 0;
    const Dense P = inverse_of(dense.H);
    const auto sigma = [&](int i) { return std::sqrt(P(i, i)); };
    for (int a = 0; a < dense.first_rho; ++a)
      worst = std::max(worst, off(static_cast<double>(c.adjuster.plane_step()[a]), expected(a), sigma(a)));
    for (int i = 0; i < c.bundle.points; ++i) {
      const int own = dense.first_rho + i;
      worst = std::max(worst, off(static_cast<double>(c.adjuster.rho_step(i)), expected(own), sigma(own)));
    }
    std::printf("largest difference of a step %.3g sigma\n", worst);
    EXPECT_BELOW(kIsFloat ? 0.3 : 1e-6, worst);
    TEST_ASSERT_TRUE(c.adjuster.begin_covariances(c.window.camera, c.window.options, c.bundle));
    const int n = c.bundle.lens->rows.count;
    std::vector<Scalar> found(static_cast<std::size_t>(n * n));
    c.adjuster.lens_covariance(found.data());
    const Eigen::Map<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>> of_lens(found.data(), n, n);
    expect_same(P.block(dense.first_lens, dense.first_lens, n, n), of_lens.cast<double>());
    const int last = dense.pose.back();
    expect_same(P.block(last, last, 6, 6), c.adjuster.pose_covariance(c.bundle.poses - 1).cast<double>());
    for (int i = 0; i < 5; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const BundlePose& host = c.bundle.pose[c.bundle.host[i]];
      const Eigen::Vector3d q = (host.q_WC * c.bundle.ray[i] / c.bundle.rho[i]).cast<double>();
      const int column = dense.pose[static_cast<std::size_t>(c.window.host[at])];
      Dense J = Dense::Zero(3, P.rows());
      if (column >= 0) {
        J.middleCols(column, 3) = -hat(q.cast<Scalar>()).cast<double>();
        J.middleCols(column + 3, 3).setIdentity();
      }
      J.col(dense.first_rho + i) = -q / static_cast<double>(c.bundle.rho[i]);
      Vec3 ray;
      Mat32 J_ray_z;
      if (c.window.host_pixel[at].given) {
        TEST_ASSERT_TRUE(unproject(c.window.lens, c.window.host_pixel[at].pixel, &ray, &J_ray_z));
        const RayByLens J_ray = ray_lens_jacobian(c.window.lens, ray, J_ray_z);
        for (int k = 0; k < n; ++k)
          J.col(dense.first_lens + k) =
              (host.q_WC * Vec3(J_ray.col(c.bundle.lens->rows.parameter[k])) / c.bundle.rho[i]).cast<double>();
      }
      Mat3 of_place;
      TEST_ASSERT_TRUE(c.adjuster.point_covariance(c.bundle, i, Scalar(0), &of_place));
      expect_same(J * P * J.transpose(), of_place.cast<double>());
    }
  }
}

void test_covariances_should_be_those_of_the_dense_inverse() {
  SeededRandom random(62);
  Case c(random);
  const DenseSystem dense(c.window);
  const Dense P = inverse_of(dense.H);
  TEST_ASSERT_TRUE(c.adjuster.begin_covariances(c.window.camera, c.window.options, c.bundle));
  for (int k = 0; k < c.bundle.poses; ++k) {
    const int column = dense.pose[static_cast<std::size_t>(k)];
    if (column < 0)
      TEST_ASSERT_TRUE(c.adjuster.pose_covariance(k).isZero());
    else
      expect_same(P.block(column, column, 6, 6), c.adjuster.pose_covariance(k).cast<double>());
  }
  for (int j = 0; j < c.bundle.planes; ++j) {
    const int column = dense.plane[static_cast<std::size_t>(j)];
    if (column < 0)
      TEST_ASSERT_TRUE(c.adjuster.plane_covariance(j).isZero());
    else
      expect_same(P.block(column, column, 3, 3), c.adjuster.plane_covariance(j).cast<double>());
  }
  const double sigma_bearing = 0.002;
  for (int i = 0; i < c.bundle.points; ++i) {
    const int own = dense.first_rho + i,
              column = dense.pose[static_cast<std::size_t>(c.window.host[static_cast<std::size_t>(i)])];
    expect_same(P.block(own, own, 1, 1), Dense::Constant(1, 1, static_cast<double>(c.adjuster.rho_variance(i))));
    const BundlePose& host = c.bundle.pose[c.bundle.host[i]];
    const Eigen::Vector3d q = (host.q_WC * c.bundle.ray[i] / c.bundle.rho[i]).cast<double>();
    Dense J = Dense::Zero(3, P.rows());
    if (column >= 0) {
      J.middleCols(column, 3) = -hat(q.cast<Scalar>()).cast<double>();
      J.middleCols(column + 3, 3).setIdentity();
    }
    J.col(own) = -q / static_cast<double>(c.bundle.rho[i]);
    const Dense bearing = sigma_bearing * sigma_bearing * (q.squaredNorm() * Dense::Identity(3, 3) - q * q.transpose());
    Mat3 found;
    TEST_ASSERT_TRUE(c.adjuster.point_covariance(c.bundle, i, Scalar(sigma_bearing), &found));
    expect_same(J * P * J.transpose() + bearing, found.cast<double>());
  }
}

void test_points_should_come_to_lie_on_their_planes() {
  SeededRandom random(63);
  Case with(random);
  double before = 0, after = 0;
  const auto distances = [&](double* sum) {
    for (int i = 0; i < with.bundle.points; ++i) {
      const int j = with.window.plane_of[static_cast<std::size_t>(i)];
      if (j < 0) continue;
      const BundlePose& host = with.bundle.pose[with.bundle.host[i]];
      const double e = static_cast<double>(
          bearing_plane_distance(with.bundle.plane[j], host.q_WC * with.bundle.ray[i], host.p_W, with.bundle.rho[i]));
      *sum += e * e / with.bundle.points;
    }
  };
  distances(&before);
  with.adjuster.adjust(with.window.camera, with.window.options, with.bundle);
  distances(&after);
  std::printf("mean square distance %.3g before, %.3g after\n", before, after);
  EXPECT_BELOW(0.1 * before, after);
}

void test_point_without_parallax_or_prior_should_stay_where_it_is() {
  SeededRandom random(64);
  Case c(random);
  for (BundlePose& p : c.window.pose) p = {c.window.pose[0].q_WC, c.window.pose[0].p_W, p.free, p.pixel};
  for (std::size_t k = 0; k < c.window.prior.size(); ++k) c.window.prior[k] = {0, 0}, c.window.plane_of[k] = -1;
  for (std::size_t k = 0; k < c.window.pose.size(); ++k)
    for (BundlePixel& p : c.window.pixel[k]) p.seen = p.seen && k + 1 == c.window.pose.size();
  for (int& h : c.window.host) h = 0;
  const std::vector<Scalar> before = c.window.rho;
  TEST_ASSERT_TRUE(c.adjuster.step(c.window.camera, c.window.options, c.bundle, Scalar(1e-3)));
  for (int i = 0; i < c.bundle.points; ++i) TEST_ASSERT_SAME(Scalar(0), c.adjuster.rho_step(i));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_step_should_be_that_of_the_dense_normal_equations_when_there_are_planes);
  RUN_TEST(test_step_and_covariance_of_the_lens_should_be_those_of_the_dense_normal_equations);
  RUN_TEST(test_covariances_should_be_those_of_the_dense_inverse);
  RUN_TEST(test_points_should_come_to_lie_on_their_planes);
  RUN_TEST(test_point_without_parallax_or_prior_should_stay_where_it_is);
  return UNITY_END();
}
