// Descriptors of corners: under rotation, light, noise and scale, against those of other corners; and the distance between two.
#include <cmath>
#include <vector>

#include "support/seeded_random.h"
#include "unity.h"
#include "vision/descriptor.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kSide = 64;

/// A smooth random texture about the middle of a picture, rotated, scaled and lit otherwise.
class Texture {
 public:
  explicit Texture(SeededRandom* random) {
    for (Wave& wave : wave_)
      wave = {0.25 * random->normal(), 0.25 * random->normal(), 6.28 * random->uniform(0, 1),
              14 + 10 * random->uniform(0, 1)};
  }

  std::vector<std::uint8_t> picture(double rotation, double scale, double gain, double noise,
                                    SeededRandom* random) const {
    std::vector<std::uint8_t> out;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double u = x - kSide / 2, v = y - kSide / 2;
        const double a = (std::cos(rotation) * u + std::sin(rotation) * v) * scale;
        const double b = (-std::sin(rotation) * u + std::cos(rotation) * v) * scale;
        double grey = 0.7 * a;  // so that one side is brighter
        for (const Wave& wave : wave_) grey += wave.height * std::sin(wave.u * a + wave.v * b + wave.phase);
        grey = 128 + gain * grey + noise * random->normal();
        out.push_back(static_cast<std::uint8_t>(std::fmin(255, std::fmax(0, std::floor(grey + 0.5)))));
      }
    return out;
  }

 private:
  struct Wave {
    double u, v, phase, height;
  };
  Wave wave_[6];
};

Descriptor described(const std::vector<std::uint8_t>& pixels) {
  ImageView image;
  image.data = pixels.data();
  image.width = image.height = image.stride = kSide;
  Descriptor out;
  TEST_ASSERT_TRUE(describe(image, Vec2(kSide / 2, kSide / 2), &out));
  return out;
}

void test_distance_should_count_the_bits_that_differ() {
  SeededRandom random(31);
  Descriptor a, all;
  TEST_ASSERT_EQUAL_INT(0, distance(a, a));
  for (std::uint64_t& word : all.word) word = ~std::uint64_t{0};
  TEST_ASSERT_EQUAL_INT(256, distance(a, all));
  for (int trial = 0; trial < 200; ++trial) {
    Descriptor b = a;
    int flipped = 0;
    for (int i = 0; i < 256; ++i)
      if (random.uniform(0, 1) < trial / 200.0) {
        b.word[i / 64] ^= std::uint64_t{1} << (i % 64);
        ++flipped;
      }
    TEST_ASSERT_EQUAL_INT(flipped, distance(a, b));
    TEST_ASSERT_EQUAL_INT(flipped, distance(b, a));
  }
}

void test_a_corner_should_stay_nearer_to_itself_than_to_others() {
  SeededRandom random(32);
  std::vector<Texture> textures;
  std::vector<Descriptor> first;
  for (int i = 0; i < 40; ++i) {
    textures.emplace_back(&random);
    first.push_back(described(textures.back().picture(0, 1, 1, 0, &random)));
  }
  const struct {
    const char* name;
    double rotation, scale, gain, noise;
  } changes[] = {{"rotated by 40 degrees", 0.7, 1, 1, 0},
                 {"half the contrast", 0, 1, 0.5, 0},
                 {"noise of 4 grey levels", 0, 1, 1, 4},
                 {"a tenth larger", 0, 1.1, 1, 0},
                 {"upside down", 3.14159, 1, 1, 0}};
  for (const auto& change : changes) {
    int nearest_is_itself = 0;
    for (std::size_t i = 0; i < textures.size(); ++i) {
      const Descriptor now =
          described(textures[i].picture(change.rotation, change.scale, change.gain, change.noise, &random));
      bool itself = distance(now, first[i]) <= 70;
      for (std::size_t j = 0; j < first.size(); ++j)
        itself = itself && (j == i || distance(now, first[j]) > distance(now, first[i]));
      nearest_is_itself += itself ? 1 : 0;
    }
    TEST_ASSERT_TRUE_MESSAGE(nearest_is_itself >= 36, change.name);
  }
}

void test_a_pixel_near_the_edge_should_have_none() {
  SeededRandom random(33);
  const std::vector<std::uint8_t> pixels = Texture(&random).picture(0, 1, 1, 0, &random);
  ImageView image;
  image.data = pixels.data();
  image.width = image.height = image.stride = kSide;
  Descriptor out;
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  TEST_ASSERT_TRUE(describe(image, Vec2(kDescriptorMargin, kDescriptorMargin), &out));
  for (const Vec2& pixel : {Vec2(kDescriptorMargin - 1, 30), Vec2(30, kSide - kDescriptorMargin), Vec2(-1e9f, 30),
                            Vec2(30, 1e9f), Vec2(nan, 30), Vec2(30, nan)})
    TEST_ASSERT_FALSE(describe(image, pixel, &out));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_distance_should_count_the_bits_that_differ);
  RUN_TEST(test_a_corner_should_stay_nearer_to_itself_than_to_others);
  RUN_TEST(test_a_pixel_near_the_edge_should_have_none);
  return UNITY_END();
}
