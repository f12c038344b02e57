// Patches on planes: the aligner against known warps, what hides and lights them, what is refused, lenses, and its twin of 11 x 11.
#include <algorithm>
#include <limits>

#include "geometry/small_cholesky.h"
#include "same.h"
#include "support/bounds.h"
#include "support/test_cameras.h"
#include "support/textured_images.h"
#include "track/align_plane.h"
#include "unity.h"
#include "vision/align.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWidth = 320, kHeight = 240, kLeft = 110, kTop = 70, kSide = 96, kAround = 24;

Camera pinhole() { return test_camera(CameraModel::kPinhole, kWidth, kHeight, 260, 260, 159.5, 119.5); }
Camera distorted() {
  return test_camera(CameraModel::kRadtan, kWidth, kHeight, 260, 260, 159.5, 119.5, -0.28, 0.07, 2e-4, 2e-5);
}

/// A plane with a texture over the rays of the reference camera (in pixels of a pinhole), which cameras look at.
struct View {
  SeededRandom random;
  Texture plane, other;
  Camera camera;
  TestArena arena;
  Pyramid pyramid;
  PlaneAligner aligner;
  PlanePatch patch;

  explicit View(std::uint64_t seed, const Camera& camera_ = pinhole())
      : random(seed), plane(&random, 9, 60), other(&random, 9, 60), camera(camera_) {
    TEST_ASSERT_TRUE(aligner.layout(*arena) && pyramid.layout(*arena, kWidth, kHeight, PlanePatch::kLevels));
  }

  double grey(const Vec2& pixel, const Mat3& H_KC) const {
    Vec3 ray;
    if (!unproject(camera, pixel, &ray)) return 128;
    const Vec3 p = H_KC * ray;
    return plane.at(static_cast<double>(camera.fx * p.x() / p.z()), static_cast<double>(camera.fy * p.y() / p.z()));
  }
  /// f(grey, x, y) is what becomes of the grey level of a pixel, before noise of sigma.
  template <typename F>
  TestImage see(const Mat3& H_CK, double sigma, F&& f) {
    const Mat3 H_KC = H_CK.inverse();
    return TestImage(kWidth, kHeight, [&](int x, int y) {
      if (x < kLeft - kAround || y < kTop - kAround || x >= kLeft + kSide + kAround || y >= kTop + kSide + kAround)
        return 128.0;  // nobody looks there
      return f(grey(Vec2(x, y), H_KC), x, y) + sigma * random.normal();
    });
  }
  TestImage see(const Mat3& H_CK, double sigma) {
    return see(H_CK, sigma, [](double g, int, int) { return g; });
  }
  void learn(double sigma) {
    const TestImage image = see(Mat3::Identity(), sigma);
    TEST_ASSERT_TRUE(extract_plane_patch(image.view(), kLeft, kTop, kSide, &patch));
  }
  template <typename Warp>
  PlaneAlignment find(const TestImage& image, const Mat3& start, const Warp& warp) {
    pyramid.build(image.view());
    PlaneStart from;
    from.H_CK = start;
    return aligner.align(pyramid, camera, patch, from, warp);
  }
  PlaneAlignment find(const TestImage& image, const Mat3& start = Mat3::Identity()) {
    return find(image, start, HomographyWarp());
  }
  /// Where the patch's corners are under H.
  Eigen::Matrix<Scalar, 8, 1> corners(const Mat3& H_CK) const {
    Eigen::Matrix<Scalar, 8, 1> all;
    for (int k = 0; k < 4; ++k) {
      Vec3 ray;
      Vec2 pixel;
      TEST_ASSERT_TRUE(unproject(camera, patch.corner(k), &ray) && project(camera, H_CK * ray, &pixel));
      all.segment<2>(2 * k) = pixel;
    }
    return all;
  }
  Eigen::Matrix<Scalar, 8, 1> error(const PlaneAlignment& found, const Mat3& truth) const {
    Eigen::Matrix<Scalar, 8, 1> e = -corners(truth);
    for (int k = 0; k < 4; ++k) e.segment<2>(2 * k) += found.corner[k];
    return e;
  }
  double rms(const PlaneAlignment& found, const Mat3& truth) const {
    return std::sqrt(static_cast<double>(error(found, truth).squaredNorm()) / 4);
  }
  /// The camera turned a little, and moved before a plane that is 2 m away.
  Mat3 random_homography() {
    const Vec3 w = random.normals<3>(0.012), t = random.normals<3>(0.02);
    Mat3 R;
    R << 1, -w.z(), w.y(), w.z(), 1, -w.x(), -w.y(), w.x(), 1;
    return R + t * Vec3(Scalar(0.05), Scalar(-0.1), Scalar(0.5)).transpose();
  }
};

void test_known_homographies_should_be_found_with_their_covariance() {
  for (const bool has_lens : {false, true}) {
    View view(621, has_lens ? distorted() : pinhole());
    double nees = 0;
    constexpr int kTrials = 8;
    for (int trial = 0; trial < kTrials; ++trial) {
      view.learn(2);
      const Mat3 truth = view.random_homography();
      const PlaneAlignment found = view.find(view.see(truth, 2));
      TEST_ASSERT_TRUE(found.is_aligned());
      TEST_ASSERT_TRUE(found.iterations <= PlaneAligner::kMaxIterations);
      EXPECT_BELOW(0.12, view.rms(found, truth));
      TEST_ASSERT_DOUBLE_WITHIN(0.6, 2.0, static_cast<double>(found.sigma));
      const Eigen::Matrix<Scalar, 8, 1> e = view.error(found, truth);
      SmallCholesky<8> cholesky;
      TEST_ASSERT_TRUE(cholesky.factor(found.covariance + found.reference_covariance));
      nees += static_cast<double>(e.dot(cholesky.solve<1>(e))) / kTrials;
      // The corners are those of the homography that it found.
      Eigen::Matrix<Scalar, 8, 1> own = view.corners(found.H_CK);
      for (int k = 0; k < 4; ++k) EXPECT_BELOW(0.02, (found.corner[k] - own.segment<2>(2 * k)).norm());
    }
    std::printf("NEES %.2f (8)\n", nees);
    TEST_ASSERT_TRUE(nees > 4 && nees < 16);
  }
}

void test_light_should_not_matter_and_be_found() {
  View view(622);
  view.learn(1);
  const Mat3 truth = view.random_homography();
  Mat3 start = truth;
  start(0, 2) += Scalar(0.01);  // 2.6 px
  const PlaneAlignment found = view.find(view.see(truth, 1, [](double g, int, int) { return 0.6 * g + 70; }), start);
  TEST_ASSERT_TRUE(found.is_aligned());
  EXPECT_BELOW(0.06, view.rms(found, truth));
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.6, static_cast<double>(found.gain));
  TEST_ASSERT_DOUBLE_WITHIN(3, 70, static_cast<double>(found.offset));
}

void test_what_hides_a_part_should_have_no_weight() {
  View view(623);
  for (int trial = 0; trial < 6; ++trial) {
    view.learn(2);
    const Mat3 truth = view.random_homography();
    const int end = kLeft + (trial % 2 == 0 ? kSide * 3 / 10 : kSide * 4 / 10);
    const PlaneAlignment found =
        view.find(view.see(truth, 2, [&](double g, int x, int y) { return x < end ? view.other.at(x, y) : g; }), truth);
    TEST_ASSERT_TRUE(found.is_aligned());
    EXPECT_BELOW(4 * std::sqrt(static_cast<double>((found.covariance + found.reference_covariance).trace()) / 4),
                 view.rms(found, truth));
    EXPECT_BELOW(trial % 2 == 0 ? 0.8 : 0.7, found.weight);
  }
}

void test_something_else_should_be_refused() {
  View view(624);
  view.learn(2);
  const PlaneAlignment else_where =
      view.find(view.see(Mat3::Identity(), 2, [&](double, int x, int y) { return view.other.at(x, y); }));
  TEST_ASSERT_FALSE(else_where.is_aligned());
  const PlaneAlignment hidden = view.find(view.see(Mat3::Identity(), 2, [&](double g, int x, int y) {
    return x < kLeft + kSide * 4 / 5 ? view.other.at(x, y) : g;
  }));
  TEST_ASSERT_FALSE(hidden.is_aligned());
  TEST_ASSERT_FALSE(view.find(TestImage(kWidth, kHeight, [](int, int) { return 255; })).is_aligned());
  Mat3 outside = Mat3::Identity();
  outside(0, 2) = 5;
  TEST_ASSERT_FALSE(view.find(view.see(Mat3::Identity(), 2), outside).is_aligned());
  outside(0, 2) = std::numeric_limits<Scalar>::quiet_NaN();
  TEST_ASSERT_FALSE(view.find(view.see(Mat3::Identity(), 2), outside).is_aligned());
}

void test_flat_and_grazing_patches_should_be_refused() {
  View view(625);
  const TestImage flat(kWidth, kHeight, [](int, int) { return 128; });
  TEST_ASSERT_FALSE(extract_plane_patch(flat.view(), kLeft, kTop, kSide, &view.patch));
  const TestImage stripes(kWidth, kHeight, [](int x, int) { return 128 + 60 * std::sin(0.5 * x); });
  TEST_ASSERT_FALSE(extract_plane_patch(stripes.view(), kLeft, kTop, kSide, &view.patch));
  view.learn(0);
  for (const double factor : {0.3, 0.25}) {  // squeezed: seen at 73 and 76 degrees
    Mat3 grazing = Mat3::Identity();
    grazing(0, 0) = static_cast<Scalar>(factor);
    const PlaneAlignment found = view.find(view.see(grazing, 0), grazing);
    TEST_ASSERT_SAME(PlaneVerdict::kSlanted, found.verdict);
  }
  const TestImage image = view.see(Mat3::Identity(), 0);
  TEST_ASSERT_FALSE(extract_plane_patch(image.view(), kWidth - kSide + 1, kTop, kSide, &view.patch));
  TEST_ASSERT_FALSE(extract_plane_patch(image.view(), -1, kTop, kSide, &view.patch));
  TEST_ASSERT_FALSE(extract_plane_patch(image.view(), 0, 0, PlanePatch::kMaxSide + 1, &view.patch));
}

void test_slopes_should_be_found_when_the_motion_is_known() {
  View view(626);
  const Vec3 middle((kLeft + Scalar(0.5) * (kSide - 1) - view.camera.cx) / view.camera.fx,
                    (kTop + Scalar(0.5) * (kSide - 1) - view.camera.cy) / view.camera.fy, 1);
  for (int trial = 0; trial < 6; ++trial) {
    view.learn(1);
    const Vec3 t(Scalar(0.2), Scalar(-0.1), Scalar(0.05));
    Vec3 m(static_cast<Scalar>(view.random.uniform(-0.15, 0.15)), static_cast<Scalar>(view.random.uniform(-0.15, 0.15)),
           0);
    m.z() = Scalar(0.5) - m.x() * middle.x() - m.y() * middle.y();  // the depth along the middle ray is known
    const Mat3 truth = Mat3::Identity() + t * m.transpose();
    SlopesWarp warp;
    warp.t = t;
    const PlaneAlignment found =
        view.find(view.see(truth, 1), Mat3::Identity() + t * Vec3(0, 0, Scalar(0.5)).transpose(), warp);
    TEST_ASSERT_TRUE(found.is_aligned());
    EXPECT_BELOW(0.06, view.rms(found, truth));
  }
}

void test_a_shift_should_be_what_the_small_aligner_finds() {
  View view(627);
  double worst = 0;
  int compared = 0;
  const TestImage before = view.see(Mat3::Identity(), 0);
  for (int trial = 0; trial < 40; ++trial) {
    Mat3 H = Mat3::Identity();
    H(0, 2) = static_cast<Scalar>(view.random.uniform(-1.2, 1.2)) / view.camera.fx;
    H(1, 2) = static_cast<Scalar>(view.random.uniform(-1.2, 1.2)) / view.camera.fy;
    const TestImage after = view.see(H, 0);
    const int x = kLeft + 2 * trial, y = kTop + 80 - 2 * trial;
    float window[kWarpSize * kWarpSize];
    for (int j = 0; j < kWarpSize; ++j)
      for (int i = 0; i < kWarpSize; ++i) window[j * kWarpSize + i] = before.view().at(x + i, y + j);
    AlignTemplate pattern;
    if (!extract_plane_patch(before.view(), x, y, kWarpSize, &view.patch) || !make_align_template(window, &pattern))
      continue;
    const AlignResult small = align(after.view(), pattern, Vec2(x + kWarpSize / 2, y + kWarpSize / 2));
    const PlaneAlignment found = view.find(after, Mat3::Identity(), ShiftWarp());
    if (!small.converged || !found.is_aligned()) continue;
    ++compared;
    const Vec2 middle = (found.corner[0] + found.corner[2]) / 2;
    worst = std::max(worst, static_cast<double>((middle - small.position).norm()));
  }
  std::printf("%d compared, worst %.4f px\n", compared, worst);
  TEST_ASSERT_TRUE(compared >= 15);
  EXPECT_BELOW(0.08, worst);
}

void test_a_lens_should_be_interpolated_to_a_fiftieth_pixel() {
  for (const Camera& camera : {radtan_camera(), equidistant_camera(), division_camera()}) {
    PlanePatch patch;
    patch.side = 100;
    patch.left = static_cast<std::int16_t>(camera.width / 2 - 10);
    patch.top = static_cast<std::int16_t>(camera.height / 2 - 100);
    PlaneLens lens;
    TEST_ASSERT_TRUE(lens.set_reference(camera, patch));
    Mat3 H = Mat3::Identity();
    H(0, 1) = Scalar(0.1);
    H(2, 0) = Scalar(-0.05);
    TEST_ASSERT_TRUE(lens.set_image(camera, H));
    Scalar worst = 0;
    for (int y = 0; y < patch.side; ++y)
      for (int x = 0; x < patch.side; ++x) {
        const PlaneLens::Cell cell = lens.cell_of(static_cast<float>(x), static_cast<float>(y));
        const Vec2 pixel(patch.left + x, patch.top + y);
        Vec3 ray;
        TEST_ASSERT_TRUE(unproject(camera, pixel, &ray));
        const auto pinhole_of = [&](const Vec3& p) {
          return Vec2(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
        };
        worst = std::max(worst, (pixel + lens.reference_at(cell).cast<Scalar>() - pinhole_of(ray)).norm());
        Vec2 now;
        TEST_ASSERT_TRUE(project(camera, H * ray, &now));
        worst = std::max(worst, (pinhole_of(H * ray) + lens.image_at(cell).cast<Scalar>() - now).norm());
      }
    std::printf("model %d: worst %.4f px\n", camera.model, static_cast<double>(worst));
    EXPECT_BELOW(0.02, worst);
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_known_homographies_should_be_found_with_their_covariance);
  RUN_TEST(test_light_should_not_matter_and_be_found);
  RUN_TEST(test_what_hides_a_part_should_have_no_weight);
  RUN_TEST(test_something_else_should_be_refused);
  RUN_TEST(test_flat_and_grazing_patches_should_be_refused);
  RUN_TEST(test_slopes_should_be_found_when_the_motion_is_known);
  RUN_TEST(test_a_shift_should_be_what_the_small_aligner_finds);
  RUN_TEST(test_a_lens_should_be_interpolated_to_a_fiftieth_pixel);
  return UNITY_END();
}
