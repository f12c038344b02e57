// The store of patches, and the search for a patch that is far from where it is expected.
#include <cstdlib>
#include <memory>
#include <vector>

#include "support/test_cameras.h"
#include "support/textured_images.h"
#include "track/patch_search.h"
#include "track/patch_store.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWidth = 320, kHeight = 240, kCapacity = 3;
constexpr std::size_t kBytes = std::size_t{1} << 20;

struct Block {
  std::unique_ptr<void, void (*)(void*)> bytes{std::aligned_alloc(Arena::kAlignment, kBytes), std::free};
  Arena arena{bytes.get(), kBytes};
};

Camera pinhole() {
  const double intrinsics[4] = {250, 250, 0.5 * (kWidth - 1), 0.5 * (kHeight - 1)}, distortion[8] = {};
  Camera camera;
  make_camera(static_cast<int>(CameraModel::kPinhole), kWidth, kHeight, intrinsics, distortion, &camera);
  return camera;
}

void test_a_patch_should_take_at_most_24_kib() { TEST_ASSERT_TRUE(sizeof(StoredPatch) <= 24 * 1024); }

void test_a_store_should_give_ids_once_and_count_cameras() {
  Block block;
  PatchStore store;
  TEST_ASSERT_TRUE(store.layout(block.arena, kCapacity));
  store.init();
  TEST_ASSERT_EQUAL_INT(0, store.count());
  const int cameras[kCapacity] = {7, 7, 9};
  for (const int camera : cameras) {
    const int i = store.find_free();
    TEST_ASSERT_TRUE(i >= 0);
    store.begin(i).camera = camera;
    TEST_ASSERT_FALSE(store[i].is_proven());
  }
  TEST_ASSERT_EQUAL_INT(kCapacity, store.count());
  TEST_ASSERT_EQUAL_INT(-1, store.find_free());
  TEST_ASSERT_EQUAL_INT(2, store.cameras());
  store.remove(2);
  TEST_ASSERT_EQUAL_INT(1, store.cameras());
  TEST_ASSERT_EQUAL_INT(2, store.find_free());
  TEST_ASSERT_EQUAL_UINT32(4, store.begin(2).id);
  store.clear();
  TEST_ASSERT_EQUAL_INT(0, store.count());
  TEST_ASSERT_EQUAL_UINT32(5, store.begin(0).id);
}

/// Looks for a patch of 64 px that is dx, dy away from where it is expected. tile: of texture that repeats [px], or 0.
bool search(double dx, double dy, double sigma_px, double tile, Vec2* shift) {
  constexpr int kSide = 64, kLeft = 120, kTop = 90;
  SeededRandom random(31);
  const Texture texture(&random, 9, 60);
  const auto grey = [&](double x, double y) {
    return tile > 0 ? texture.at(x - tile * std::floor(x / tile), y - tile * std::floor(y / tile)) : texture.at(x, y);
  };
  const TestImage first(kWidth, kHeight, grey),
      moved(kWidth, kHeight, [&](int x, int y) { return grey(x - dx, y - dy); });
  Block block;
  Pyramid pyramid;
  PatchSearch patch_search;
  TEST_ASSERT_TRUE(pyramid.layout(block.arena, kWidth, kHeight, 4) && patch_search.layout(block.arena));
  pyramid.build(moved.view());
  const auto patch = std::make_unique<PlanePatch>();
  TEST_ASSERT_TRUE(extract_plane_patch(first.view(), kLeft, kTop, kSide, patch.get()));
  const Mat2 innovation = Mat2::Identity() * static_cast<Scalar>(sigma_px * sigma_px);
  return patch_search.find(pyramid, pinhole(), *patch, Mat3::Identity(), innovation, Scalar(9.21), shift);
}

void test_a_patch_should_be_found_inside_of_its_ellipse() {
  for (const auto& [dx, dy, sigma] :
       {std::tuple{21.0, -13.0, 12.0}, std::tuple{-70.0, 38.0, 45.0}, std::tuple{0.0, 0.0, 80.0}}) {
    Vec2 shift;
    TEST_ASSERT_TRUE(search(dx, dy, sigma, 0, &shift));
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(shift.x()) - dx) <= 4.0);  // a pixel of level 2
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(shift.y()) - dy) <= 4.0);
  }
}

void test_a_patch_should_not_be_found_outside_of_its_ellipse_or_where_texture_repeats() {
  Vec2 shift;
  TEST_ASSERT_FALSE(search(90, 60, 8, 0, &shift) && std::fabs(static_cast<double>(shift.x()) - 90) < 8);
  TEST_ASSERT_FALSE(search(0, 0, 40, 32, &shift));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_patch_should_take_at_most_24_kib);
  RUN_TEST(test_a_store_should_give_ids_once_and_count_cameras);
  RUN_TEST(test_a_patch_should_be_found_inside_of_its_ellipse);
  RUN_TEST(test_a_patch_should_not_be_found_outside_of_its_ellipse_or_where_texture_repeats);
  return UNITY_END();
}
