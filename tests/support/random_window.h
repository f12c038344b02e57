#pragma once

// Random windows for the bundle adjuster: fixed and free poses before points, some of them on planes.

#include <algorithm>
#include <vector>

#include "bundle/bundle_adjuster.h"
#include "geometry/so3.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"

namespace pf {

struct RandomWindow {
  static constexpr int kMaxPoses = 10, kMaxFree = 4, kMaxPoints = 48, kMaxPlanes = 4;

  Camera camera;
  AdjustOptions options;
  std::vector<BundlePose> pose;
  std::vector<std::vector<BundlePixel>> pixel;
  std::vector<Vec3> ray;
  std::vector<int> host, plane_of;
  std::vector<Scalar> rho;
  std::vector<RhoPrior> prior;
  std::vector<BundlePlane> plane;
  Scalar class_sigma[3] = {Scalar(0.5), Scalar(1), Scalar(0.25)};
  // Of the lens, where it is adjusted.
  Camera lens;
  BundleLens bundle_lens;
  std::vector<HostPixel> host_pixel;
  std::vector<Scalar> lens_information;

  /// The last `free` poses and every second plane are free; pixels, poses, depths and planes are off by the sigmas.
  RandomWindow(SeededRandom& random, int poses, int free, int points, int planes, double noise_px, double off)
      : camera(test_camera_of(poses % kTestCameras)) {
    options = {Scalar(0.5), Scalar(3), Scalar(0.5), Scalar(2), Scalar(10), Scalar(100), 30};
    options.class_sigma_px = class_sigma;
    const auto scalar = [](double v) { return static_cast<Scalar>(v); };
    for (int c = 0; c < poses; ++c) {
      const Quat q = exp_so3(random.normals<3>(0.03));
      const Vec3 p = Vec3(scalar(0.15 * c), 0, 0) + random.normals<3>(0.05);
      pose.push_back({q, p, c >= poses - free, nullptr});
    }
    pixel.assign(pose.size(), std::vector<BundlePixel>(static_cast<std::size_t>(points), BundlePixel{0, 0, false}));
    for (int j = 0; j < planes; ++j) {
      PlaneFrame frame;
      frame.R_WP = exp_so3(random.normals<3>(0.2)).toRotationMatrix();
      frame.o_W = Vec3(0, 0, scalar(2 + 0.7 * j));
      plane.push_back({frame, random.normals<3>(0.02), Scalar(0.01), j % 2 == 0});
    }
    for (int i = 0; i < points; ++i) {
      const int h = static_cast<int>(random.uniform(0, poses - 1e-6));
      const auto hosts = static_cast<std::size_t>(h);
      const int on = planes > 0 && i % 2 == 0 ? i / 2 % planes : -1;
      const double x = random.uniform(-0.25, 0.25), y = random.uniform(-0.2, 0.2), depth = random.uniform(1.5, 4);
      Vec3 p_W(scalar(x * depth + 0.07 * poses), scalar(y * depth), scalar(depth));
      if (on >= 0) {
        const BundlePlane& of = plane[static_cast<std::size_t>(on)];
        p_W = plane_point(of.frame, of.x, plane_coordinates(of.frame, p_W)) + random.normals<3>(noise_px * 0.01);
      }
      const Vec3 d = pose[hosts].q_WC.conjugate() * (p_W - pose[hosts].p_W);
      host.push_back(h);
      plane_of.push_back(on);
      ray.push_back(d.normalized());
      rho.push_back(Scalar(1) / d.norm() * scalar(1 + off * random.uniform(-5, 5)));
      prior.push_back(i % 3 == 0 ? RhoPrior{0, 0} : RhoPrior{Scalar(1) / d.norm(), Scalar(0.3)});
      for (std::size_t c = 0; c < pose.size(); ++c) {
        BundlePixel& seen = pixel[c][static_cast<std::size_t>(i)];
        Vec2 z;
        seen.seen = project(camera, pose[c].q_WC.conjugate() * (p_W - pose[c].p_W), &z) && random.uniform(0, 1) < 0.9;
        if (!seen.seen) continue;
        z += random.normals<2>(noise_px);
        seen.x = static_cast<float>(z.x());
        seen.y = static_cast<float>(z.y());
        seen.sigma_class = static_cast<std::uint8_t>(i % 3);
      }
    }
    for (BundlePose& p : pose) {
      if (!p.free) continue;
      p.q_WC = exp_so3(random.normals<3>(off)) * p.q_WC;
      p.p_W += random.normals<3>(off);
    }
    for (BundlePlane& p : plane)
      if (p.free) p.x += random.normals<3>(off);
  }

  Bundle bundle() {
    for (std::size_t c = 0; c < pose.size(); ++c) pose[c].pixel = pixel[c].data();
    Bundle b = {pose.data(), static_cast<int>(pose.size()), ray.data(), host.data(),
                rho.data(),  static_cast<int>(rho.size())};
    b.prior = prior.data();
    b.plane = plane.data();
    b.planes = static_cast<int>(plane.size());
    b.plane_of = plane_of.data();
    return b;
  }
};

/// The window's lens is adjusted too: every parameter but k2 and those behind it, off by `off` of its prior's sigma. Every fourth bearing
/// does not depend on it.
inline void adjust_lens(SeededRandom& random, double off, RandomWindow* w, Bundle* bundle) {
  LensSigmas sigmas;
  sigmas.focal = Scalar(0.02);
  sigmas.aspect = Scalar(0.01);
  sigmas.centre = Scalar(3);
  sigmas.distortion[0] =
      static_cast<CameraModel>(w->camera.model) == CameraModel::kDivision ? Scalar(1e-7) : Scalar(0.02);
  const LensPrior prior = make_lens_prior(sigmas, &w->camera);
  const auto n = static_cast<std::size_t>(prior.rows.count);
  w->lens_information.assign(n * n, 0);
  std::vector<Scalar> e(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Scalar sigma = std::sqrt(prior.variance[k]);
    w->lens_information[k * (n + 1)] = 1 / (sigma * sigma);
    e[k] = sigma * static_cast<Scalar>(off * random.normal());
  }
  w->host_pixel.clear();
  for (std::size_t i = 0; i < w->ray.size(); ++i) {
    HostPixel h = {Vec2::Zero(), false};
    h.given = i % 4 != 3 && project(w->camera, w->ray[i], &h.pixel);
    w->host_pixel.push_back(h);
  }
  w->lens = w->camera;
  move_lens(prior.rows, e.data(), &w->lens);
  for (std::size_t i = 0; i < w->ray.size(); ++i)
    if (w->host_pixel[i].given) unproject(w->lens, w->host_pixel[i].pixel, &w->ray[i]);
  w->bundle_lens = {prior.rows, w->lens_information.data(), w->camera, &w->lens, w->host_pixel.data(), w->ray.data()};
  bundle->lens = &w->bundle_lens;
}

/// Many windows, some of them degenerate: their cost never rises, and nothing becomes anything but a number.
inline void check_random_windows(std::uint64_t seed, int windows) {
  SeededRandom random(seed);
  TestArena arena;
  BundleAdjuster adjuster;
  TEST_ASSERT_TRUE(adjuster.layout(*arena, RandomWindow::kMaxPoses, RandomWindow::kMaxFree, RandomWindow::kMaxPoints,
                                   RandomWindow::kMaxPlanes, kLensParameters));
  int lowered = 0, determined = 0;
  for (int trial = 0; trial < windows; ++trial) {
    const int poses = 2 + static_cast<int>(random.uniform(0, 8)),
              free = 1 + static_cast<int>(random.uniform(0, std::min(4, poses) - 1e-6));
    const int points = static_cast<int>(random.uniform(0, 48)),
              planes = trial % 3 == 0 ? static_cast<int>(random.uniform(0, 4.99)) : 0;
    RandomWindow window(random, poses, free, points, planes, random.uniform(0, 1), trial % 2 == 0 ? 0.01 : 0.1);
    const auto any = [&](int count) { return static_cast<std::size_t>(random.uniform(0, count - 1e-6)); };
    if (trial % 5 == 1) window.options.rho_sigma = 0;
    for (int k = trial % 4; k > 0 && points > 0; --k) {
      Scalar& rho = window.rho[any(points)];
      const int kind = static_cast<int>(any(5));
      rho = kind == 0   ? Scalar(0)
            : kind == 1 ? -rho
            : kind == 2 ? Scalar(1e-12)
            : kind == 3 ? Scalar(1e6)
                        : Scalar(-1e-9);
      for (std::size_t c = 0; c < window.pose.size() && k == 2; ++c) window.pixel[c][any(points)].x += 1e4f;
    }
    if (trial % 7 == 2) window.pose[any(poses)] = window.pose[any(poses)];
    if (trial % 11 == 3)
      for (BundlePose& p : window.pose) p = {window.pose[0].q_WC, window.pose[0].p_W, p.free, nullptr};
    if (trial % 13 == 4)
      for (BundlePixel& p : window.pixel.back()) p.seen = false;
    int now_free = 0;
    for (BundlePose& p : window.pose) p.free = p.free && now_free++ < RandomWindow::kMaxFree;
    Bundle bundle = window.bundle();
    if (trial % 5 == 2) bundle.prior = nullptr;
    if (trial % 2 == 1) adjust_lens(random, trial % 3 == 0 ? 3 : 0.5, &window, &bundle);
    const std::vector<BundlePose> before = window.pose;
    AdjustOptions none = window.options;
    none.max_rounds = 0;
    const Scalar first = adjuster.adjust(window.camera, none, bundle);
    window.options.max_rounds = 1 + trial % 12;
    const Scalar last = adjuster.adjust(window.camera, window.options, bundle);
    const Scalar again = adjuster.adjust(window.camera, none, bundle);
    TEST_ASSERT_TRUE(std::isfinite(first) && std::isfinite(last) && last <= first);
    TEST_ASSERT_SAME(last, again);
    lowered += last < first ? 1 : 0;
    for (std::size_t c = 0; c < window.pose.size(); ++c) {
      TEST_ASSERT_TRUE(window.pose[c].q_WC.coeffs().allFinite() && window.pose[c].p_W.allFinite());
      if (!window.pose[c].free) TEST_ASSERT_SAME(before[c].p_W, window.pose[c].p_W);
    }
    for (const Scalar rho : window.rho) TEST_ASSERT_TRUE(std::isfinite(rho));
    for (const BundlePlane& p : window.plane) TEST_ASSERT_TRUE(p.x.allFinite());
    if (bundle.lens != nullptr) TEST_ASSERT_SAME(nullptr, check_camera(window.lens));
    if (!adjuster.begin_covariances(window.camera, window.options, bundle)) continue;
    ++determined;
    for (int c = 0; c < poses; ++c) TEST_ASSERT_TRUE(adjuster.pose_covariance(c).allFinite());
    for (int j = 0; j < planes; ++j) TEST_ASSERT_TRUE(adjuster.plane_covariance(j).allFinite());
    for (int i = 0; i < points; ++i) {
      Mat3 P;
      if (adjuster.point_covariance(bundle, i, Scalar(1e-3), &P)) TEST_ASSERT_TRUE(!P.hasNaN());
    }
  }
  std::printf("%d windows: the cost fell in %d, all was determined in %d\n", windows, lowered, determined);
  TEST_ASSERT_GREATER_THAN_INT(windows / 2, lowered);
  TEST_ASSERT_GREATER_THAN_INT(windows / 3, determined);
}

}  // namespace pf
