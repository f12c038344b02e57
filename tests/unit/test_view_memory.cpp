// Kept views: their correlation against a plain one in double, which are kept, and the rotation that a shifted image gives.
#include "geometry/so3.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/panorama.h"
#include "support/test_cameras.h"
#include "track/view_memory.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWidth = Thumbnail::kWidth, kHeight = Thumbnail::kHeight;

Thumbnail random_thumbnail(SeededRandom& random, double contrast) {
  Thumbnail t;
  for (std::uint8_t& p : t.pixels)
    p = static_cast<std::uint8_t>(std::clamp(128 + contrast * random.normal(), 0.0, 255.0));
  return t;
}

double plain_correlation(const Thumbnail& a, const Thumbnail& b, int dx, int dy) {
  std::vector<double> pa, pb;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int u = x - dx, v = y - dy;
      if (u < 0 || v < 0 || u >= kWidth || v >= kHeight) continue;
      pa.push_back(a.pixels[y * kWidth + x]);
      pb.push_back(b.pixels[v * kWidth + u]);
    }
  const double n = static_cast<double>(pa.size());
  double ma = 0, mb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t i = 0; i < pa.size(); ++i) ma += pa[i] / n, mb += pb[i] / n;
  for (std::size_t i = 0; i < pa.size(); ++i) {
    saa += (pa[i] - ma) * (pa[i] - ma);
    sbb += (pb[i] - mb) * (pb[i] - mb);
    sab += (pa[i] - ma) * (pb[i] - mb);
  }
  return sab / std::sqrt(saa * sbb);
}

void test_correlation_should_be_the_textbook_one_at_every_shift() {
  SeededRandom random(121);
  for (int trial = 0; trial < 20; ++trial) {
    const Thumbnail a = random_thumbnail(random, 90), b = random_thumbnail(random, 40);
    const int dx = trial - 10, dy = (7 * trial) % 17 - 8;
    TEST_ASSERT_TRUE(std::fabs(correlate(a, b, dx, dy) - plain_correlation(a, b, dx, dy)) < 1e-5);
    TEST_ASSERT_TRUE(correlate(a, a, 0, 0) > 0.99999f);
  }
}

void test_correlation_should_not_overflow_and_be_zero_of_a_flat_picture() {
  Thumbnail a, b, flat;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    a.pixels[i] = i % 2 ? 255 : 0;
    b.pixels[i] = i % 2 ? 0 : 255;
    flat.pixels[i] = 200;
  }
  TEST_ASSERT_TRUE(correlate(a, b, 0, 0) < -0.9999f);
  TEST_ASSERT_SAME(0, correlate(a, flat, 0, 0));
  TEST_ASSERT_SAME(0, correlate(flat, flat, 0, 0));
}

/// A memory of some capacity, and the pictures that it is shown.
struct Shown {
  TestArena arena;
  Pyramid pyramid;
  ViewMemory memory;
  Texture texture;
  const Camera camera = test_camera(CameraModel::kPinhole, 320, 240, 260, 260, 159.5, 119.5);

  Shown(SeededRandom& random, int capacity) : texture(&random, 60, 200) {
    TEST_ASSERT_TRUE(pyramid.layout(*arena, 320, 240, 4));
    TEST_ASSERT_TRUE(memory.layout(*arena, capacity));
    memory.init();
  }
  void show(double x0, double y0) {
    const TestImage image(320, 240, [&](int x, int y) { return texture.at(x + x0, y + y0); });
    pyramid.build(image.view());
  }
};

void test_a_view_should_be_recognised_and_turned_as_the_picture_is() {
  SeededRandom random(122);
  Panorama panorama(random);
  TestArena arena;
  ViewMemory memory;
  TEST_ASSERT_TRUE(memory.layout(*arena, 8));
  memory.init();
  const Camera camera = test_camera(CameraModel::kPinhole, Panorama::kWidth, Panorama::kHeight, 260, 260, 159.5, 119.5);
  const Quat kept = exp_so3(Vec3(Scalar(0.3), Scalar(1.2), Scalar(-0.2)));
  const Quat turn = exp_so3(Vec3(Scalar(-0.06), Scalar(0.09), Scalar(0.08)));
  const Vec3 place(1, 2, 3);
  panorama.look(camera, Quat::Identity());
  memory.keep_if_new(panorama.pyramid, Quat::Identity(), Vec3::Zero());
  panorama.look(camera, kept);
  memory.keep_if_new(panorama.pyramid, kept, place);
  TEST_ASSERT_EQUAL_INT(2, memory.count());
  panorama.look(camera, kept * turn);
  const Recognition found = memory.recognise(panorama.pyramid, camera);
  TEST_ASSERT_TRUE(found.score > 0.7f);
  TEST_ASSERT_SAME(0, (found.p_W - place).norm());
  const double off = static_cast<double>(log_so3(found.q_WC * (kept * turn).conjugate()).norm());
  std::printf("off by %.4f rad\n", off);
  TEST_ASSERT_TRUE(off < 0.004);  // a pixel of the thumbnail is 0.03
}

void test_only_new_views_should_be_kept_and_the_oldest_replaced() {
  SeededRandom random(123);
  Shown s(random, 2);
  const Body body = random_body(random);
  s.show(0, 0);
  s.memory.keep_if_new(s.pyramid, body.q_WC, Vec3(1, 0, 0));
  s.show(2, 0);
  s.memory.keep_if_new(s.pyramid, body.q_WC, Vec3(2, 0, 0));
  TEST_ASSERT_EQUAL_INT(1, s.memory.count());
  for (int k = 1; k < 3; ++k) {
    s.show(4000 * k, 0);
    s.memory.keep_if_new(s.pyramid, body.q_WC, Vec3(static_cast<Scalar>(10 * k), 0, 0));
  }
  TEST_ASSERT_EQUAL_INT(2, s.memory.count());
  s.show(8000, 0);
  TEST_ASSERT_SAME(20, s.memory.recognise(s.pyramid, s.camera).p_W.x());
  s.show(0, 0);  // replaced
  TEST_ASSERT_TRUE(s.memory.recognise(s.pyramid, s.camera).score < 0.8f);
}

void test_a_memory_without_room_should_recognise_nothing() {
  SeededRandom random(124);
  Shown s(random, 0);
  s.show(0, 0);
  s.memory.keep_if_new(s.pyramid, Quat::Identity(), Vec3::Zero());
  TEST_ASSERT_EQUAL_INT(0, s.memory.count());
  TEST_ASSERT_SAME(0, s.memory.recognise(s.pyramid, s.camera).score);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_correlation_should_be_the_textbook_one_at_every_shift);
  RUN_TEST(test_correlation_should_not_overflow_and_be_zero_of_a_flat_picture);
  RUN_TEST(test_a_view_should_be_recognised_and_turned_as_the_picture_is);
  RUN_TEST(test_only_new_views_should_be_kept_and_the_oldest_replaced);
  RUN_TEST(test_a_memory_without_room_should_recognise_nothing);
  return UNITY_END();
}
