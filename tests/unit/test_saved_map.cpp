// Saved maps as bytes: what is written comes back to the last bit, and whatever is wrong with them is refused by name, also where somebody
// has made the CRC fit again.
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "memory/crc32c.h"
#include "memory/map_file.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Bytes = std::vector<std::uint8_t>;

Quat random_rotation(SeededRandom* random) {
  Quat q(static_cast<Scalar>(random->normal()), static_cast<Scalar>(random->normal()),
         static_cast<Scalar>(random->normal()), static_cast<Scalar>(random->normal()));
  return q.normalized();
}

/// A Aᵀ of a random A.
template <int n>
Eigen::Matrix<Scalar, n, n> random_covariance(SeededRandom* random) {
  Eigen::Matrix<Scalar, n, n> A;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) A(i, j) = static_cast<Scalar>(0.1 * random->normal());
  Eigen::Matrix<Scalar, n, n> P = A.lazyProduct(A.transpose());
  return (P + P.transpose()) / 2;
}

struct Content {
  Camera camera;
  Vec3 gravity_W = Vec3::Zero();
  std::vector<SavedPlane> planes;
  std::vector<KeptPlace> places;
  std::vector<Anchor> anchors;
};

Content random_content(SeededRandom* random) {
  Content out;
  const double intrinsics[4] = {400 + 100 * random->uniform(0, 1), 400 + 100 * random->uniform(0, 1), 320, 240};
  const double distortion[8] = {0.01 * random->normal()};
  TEST_ASSERT_NULL(make_camera(2, 640, 480, intrinsics, distortion, &out.camera));
  const auto length = [&] { return static_cast<Scalar>(3 * random->normal()); };
  if (random->uniform(0, 1) < 0.5) out.gravity_W = Vec3(length(), length(), length());
  const int planes = static_cast<int>(4 * random->uniform(0, 1)),
            places = 1 + static_cast<int>(4 * random->uniform(0, 1));
  for (int k = 0; k < planes; ++k) {
    SavedPlane plane;
    plane.id = static_cast<std::uint32_t>(3 * k + 1);
    plane.max_points = 20;
    plane.frame = {random_rotation(random).toRotationMatrix(), Vec3(length(), length(), length())};
    plane.covariance = random_covariance<3>(random);
    Vec2 uv[12];
    for (Vec2& at : uv) at = Vec2(length(), length());
    extend_outline(&plane.outline, uv, 12);
    out.planes.push_back(plane);
  }
  for (int k = 0; k < places; ++k) {
    KeptPlace place;
    place.id = static_cast<std::uint32_t>(5 * k + 2);
    place.count = static_cast<int>(25 * random->uniform(0, 1));
    place.depth = static_cast<Scalar>(0.5 + random->uniform(0, 1));
    place.q_WK = random_rotation(random);
    place.p_WK = Vec3(length(), length(), length());
    place.covariance = random_covariance<6>(random);
    for (int i = 0; i < place.count; ++i) {
      PlacePoint& p = place.point[i];
      p.id = static_cast<std::uint32_t>(100 * k + i + 1);
      p.plane = planes > 0 && random->uniform(0, 1) < 0.5 ? out.planes[0].id : 0;
      p.observations = static_cast<std::int32_t>(1000 * random->uniform(0, 1));
      const Vec3 ray = Vec3(length(), length(), Scalar(10)).normalized();
      const Mat3 P = random_covariance<3>(random);
      const Quat q = random_rotation(random);
      for (int a = 0, n = 0; a < 3; ++a) {
        p.ray_K[a] = static_cast<float>(ray(a));
        p.q_KV[a + 1] = static_cast<float>(q.vec()(a));
        p.c_K[a] = static_cast<float>(length());
        for (int b = 0; b <= a; ++b) p.covariance[n++] = static_cast<float>(P(a, b));
      }
      p.q_KV[0] = static_cast<float>(q.w());
      p.rho = static_cast<float>(0.1 + random->uniform(0, 1));
      for (std::uint64_t& word : p.descriptor.word) word = static_cast<std::uint64_t>(1e15 * random->uniform(0, 1));
      p.patch.centre[0] = p.patch.centre[1] = 10.5f;
      p.patch.end[0] = p.patch.end[1] = PlacePatch::kSize;
      for (std::uint8_t& grey : p.patch.pixels) grey = static_cast<std::uint8_t>(255 * random->uniform(0, 1));
    }
    out.places.push_back(place);
  }
  const int anchors = static_cast<int>(4 * random->uniform(0, 1));
  for (int k = 0; k < anchors; ++k) {
    Anchor anchor;
    anchor.id = static_cast<std::uint32_t>(2 * k + 1);
    anchor.place = random->uniform(0, 1) < 0.8 ? out.places[0].id : 0;
    anchor.plane = planes > 0 && random->uniform(0, 1) < 0.5 ? out.planes[0].id : 0;
    for (RelativePlace* T : {&anchor.T_KV, &anchor.T_VA})
      *T = {random_rotation(random), Vec3(length(), length(), length())};
    anchor.between = random_covariance<6>(random);
    if (anchor.plane == 0) anchor.beside = random_covariance<6>(random);
    out.anchors.push_back(anchor);
  }
  return out;
}

void write(const Content& content, MapWriter* out) {
  out->begin(kPortableMap);
  write_lens(content.camera, out);
  write_world(content.gravity_W, out);
  begin_planes(static_cast<int>(content.planes.size()), out);
  for (const SavedPlane& plane : content.planes) write_plane(plane, out);
  out->end_section();
  begin_places(static_cast<int>(content.places.size()), out);
  for (const KeptPlace& place : content.places) write_place(place, out);
  out->end_section();
  if (!content.anchors.empty()) begin_anchors(static_cast<int>(content.anchors.size()), out);
  for (const Anchor& anchor : content.anchors) write_anchor(anchor, out);
  if (!content.anchors.empty()) out->end_section();
  out->end();
}

Bytes written(const Content& content) {
  MapWriter counted(nullptr, 0);
  write(content, &counted);
  Bytes bytes(counted.used());
  MapWriter out(bytes.data(), bytes.size());
  write(content, &out);
  TEST_ASSERT_TRUE(out.fits());
  TEST_ASSERT_EQUAL_size_t(bytes.size(), out.used());
  return bytes;
}

/// Null, or why it is refused. A copy of the exact size, so that a sanitizer sees what is read behind it.
const char* opened(const Bytes& bytes, SavedMap* map, KeptPlace* scratch) {
  const std::unique_ptr<std::uint8_t[]> copy(new std::uint8_t[bytes.size() + 1]);
  std::copy(bytes.begin(), bytes.end(), copy.get());
  return map->open(copy.get(), bytes.size(), scratch);
}

const char* refused(const Bytes& bytes) {
  SavedMap map;
  const auto scratch = std::make_unique<KeptPlace>();
  return opened(bytes, &map, scratch.get());
}

std::uint64_t number_at(const Bytes& bytes, std::size_t at, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i)
    value |= static_cast<std::uint64_t>(bytes[at + static_cast<std::size_t>(i)]) << (8 * i);
  return value;
}

void set_number(Bytes* bytes, std::size_t at, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i)
    bytes->at(at + static_cast<std::size_t>(i)) = static_cast<std::uint8_t>(value >> (8 * i));
}

/// Makes all CRCs fit, as far as the sections lead.
void forge(Bytes* bytes) {
  if (bytes->size() < kMapHeader) return;
  set_number(bytes, 28, crc32c(bytes->data(), 28), 4);
  for (std::size_t at = kMapHeader; at + kSectionHeader <= bytes->size();) {
    const std::uint64_t length = number_at(*bytes, at + 8, 8);
    if (length > bytes->size() - at - kSectionHeader) return;
    const std::size_t count = static_cast<std::size_t>(length);
    set_number(bytes, at + 16, crc32c(bytes->data() + at + kSectionHeader, count, crc32c(bytes->data() + at, 16)), 4);
    at += kSectionHeader + count;
  }
}

std::size_t section_at(const Bytes& bytes, int number) {
  std::size_t at = kMapHeader;
  for (int s = 0; s < number; ++s) at += kSectionHeader + static_cast<std::size_t>(number_at(bytes, at + 8, 8));
  return at;
}

void test_crc_should_be_castagnolis() {
  const std::string digits = "123456789";
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(digits.data());
  TEST_ASSERT_EQUAL_HEX32(0xe3069283u, crc32c(bytes, 9));
  TEST_ASSERT_EQUAL_HEX32(0xe3069283u, crc32c(bytes + 4, 5, crc32c(bytes, 4)));
  TEST_ASSERT_EQUAL_HEX32(0u, crc32c(bytes, 0));
}

void test_what_is_read_should_be_written_again_to_the_last_bit() {
  SeededRandom random(41);
  for (int trial = 0; trial < 2000; ++trial) {
    const Content content = random_content(&random);
    const Bytes bytes = written(content);
    SavedMap map;
    const auto scratch = std::make_unique<KeptPlace>();
    const char* wrong = map.open(bytes.data(), bytes.size(), scratch.get());
    TEST_ASSERT_NULL_MESSAGE(wrong, wrong);
    Content back;
    back.camera = content.camera;
    back.gravity_W = map.gravity_W();
    map.for_each_plane([&](const SavedPlane& plane) { back.planes.push_back(plane); });
    map.for_each_place(scratch.get(), [&](const KeptPlace& place) { back.places.push_back(place); });
    map.for_each_anchor([&](const Anchor& anchor) { back.anchors.push_back(anchor); });
    TEST_ASSERT_EQUAL_size_t(content.planes.size(), back.planes.size());
    TEST_ASSERT_EQUAL_size_t(content.anchors.size(), back.anchors.size());
    TEST_ASSERT_EQUAL_size_t(content.places.size(), back.places.size());
    TEST_ASSERT_TRUE(bytes == written(back));
  }
}

void test_a_small_buffer_should_stay_as_it_is_behind_its_end() {
  SeededRandom random(42);
  const Content content = random_content(&random);
  const Bytes bytes = written(content);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{31}, bytes.size() / 2, bytes.size() - 1}) {
    Bytes small(size + 8, 0xa5);
    MapWriter out(small.data(), size);
    write(content, &out);
    TEST_ASSERT_FALSE(out.fits());
    TEST_ASSERT_EQUAL_size_t(bytes.size(), out.used());
    for (std::size_t i = size; i < small.size(); ++i) TEST_ASSERT_EQUAL_HEX8(0xa5, small[i]);
  }
}

void test_every_truncation_should_be_refused() {
  SeededRandom random(43);
  Bytes bytes = written(random_content(&random));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    TEST_ASSERT_NOT_NULL(refused(cut));
    if (size >= kMapHeader) {
      set_number(&cut, 16, size, 8);
      forge(&cut);
      TEST_ASSERT_NOT_NULL(refused(cut));
    }
  }
  bytes.push_back(0);
  TEST_ASSERT_NOT_NULL(refused(bytes));
}

void test_every_flipped_bit_should_be_refused() {
  SeededRandom random(44);
  const Bytes bytes = written(random_content(&random));
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes flipped = bytes;
    const std::size_t at = static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(bytes.size()));
    flipped[at] = static_cast<std::uint8_t>(flipped[at] ^ 1u << trial % 8);
    const char* wrong = refused(flipped);
    TEST_ASSERT_NOT_NULL(wrong);
  }
}

/// Whatever somebody writes and signs: refused, or good numbers.
void test_forged_bytes_should_be_refused_or_be_numbers_of_a_map() {
  SeededRandom random(45);
  int taken = 0;
  for (int trial = 0; trial < 8000; ++trial) {
    Bytes bytes = written(random_content(&random));
    for (int k = 0; k < 1 + trial % 3; ++k) {
      const std::size_t at = static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(bytes.size() - 8));
      const double values[] = {NAN, INFINITY, -INFINITY, 1e300, -1, 0, 1e-300, 5};
      if (random.uniform(0, 1) < 0.5)
        std::memcpy(&bytes[at / 4 * 4], &values[static_cast<int>(8 * random.uniform(0, 1))], 8);
      else
        bytes[at] = static_cast<std::uint8_t>(256 * random.uniform(0, 1));
    }
    forge(&bytes);
    SavedMap map;
    const auto scratch = std::make_unique<KeptPlace>();
    if (map.open(bytes.data(), bytes.size(), scratch.get()) != nullptr) continue;
    ++taken;
    TEST_ASSERT_TRUE(map.num_places() > 0 && map.num_places() <= kMaxPlaces && map.num_planes() <= kMaxPlanes);
    map.for_each_plane([](const SavedPlane& plane) {
      TEST_ASSERT_TRUE(plane.frame.R_WP.allFinite() && plane.frame.o_W.allFinite() && plane.covariance.allFinite());
      TEST_ASSERT_TRUE(plane.outline.count >= 0 && plane.outline.count <= kMaxOutline);
    });
    TEST_ASSERT_TRUE(map.num_anchors() <= kMaxAnchors);
    map.for_each_anchor([](const Anchor& read) {
      Anchor anchor = read;
      const AnchorPlane plane;
      place_by(RelativePlace(), Mat6::Identity(), anchor.plane != 0 ? &plane : nullptr, &anchor);
      TEST_ASSERT_TRUE(anchor.T_WA.p.allFinite() && anchor.T_WA.q.coeffs().allFinite() &&
                       anchor.covariance.allFinite());
    });
    map.for_each_place(scratch.get(), [](const KeptPlace& place) {
      TEST_ASSERT_TRUE(place.count >= 0 && place.count <= KeptPlace::kMaxPoints && place.covariance.allFinite());
      for (int i = 0; i < place.count; ++i) {
        const PlacePoint& p = place.point[i];
        TEST_ASSERT_TRUE(place.position_W(i).allFinite() && p.rho > 0 && p.observations >= 0);
        TEST_ASSERT_TRUE(p.patch.end[0] <= PlacePatch::kSize && p.patch.end[1] <= PlacePatch::kSize);
        SourcePatch patch;
        restore_patch(p.patch, &patch);
      }
    });
  }
  TEST_ASSERT_TRUE(taken > 400);  // patches and descriptors are most of a map, and any of these will do
}

void test_what_is_wrong_should_be_named() {
  SeededRandom random(46);
  Content content = random_content(&random);
  while (content.planes.size() < 2 || content.places.size() < 2 || content.places[0].count < 2 ||
         content.anchors.size() < 2)
    content = random_content(&random);
  const Bytes good = written(content);
  TEST_ASSERT_NULL(refused(good));
  const auto names = [&](const char* part, Bytes bytes) {
    forge(&bytes);
    const char* wrong = refused(bytes);
    TEST_ASSERT_NOT_NULL(wrong);
    TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(wrong, part), wrong);
  };
  Bytes bytes = good;
  set_number(&bytes, 8, 1, 4);
  names("version", bytes);
  bytes = good;
  set_number(&bytes, 12, 2, 4);
  names("kind", bytes);
  // The sections of planes and places change places.
  const std::size_t planes = section_at(good, 2), places = section_at(good, 3);
  bytes.assign(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(planes));
  bytes.insert(bytes.end(), good.begin() + static_cast<std::ptrdiff_t>(places), good.end());
  bytes.insert(bytes.end(), good.begin() + static_cast<std::ptrdiff_t>(planes),
               good.begin() + static_cast<std::ptrdiff_t>(places));
  names("order", bytes);
  Content wrong = content;
  wrong.planes.pop_back();
  for (KeptPlace& place : wrong.places)
    for (int i = 0; i < place.count; ++i) place.point[i].plane = content.planes.back().id;
  names("plane that there is not", written(wrong));
  wrong = content;
  wrong.planes[1].id = wrong.planes[0].id;
  names("PLAN: ids", written(wrong));
  wrong = content;
  wrong.places[1].id = wrong.places[0].id;
  names("PLAC: ids", written(wrong));
  wrong = content;
  wrong.places[0].point[1].id = wrong.places[0].point[0].id;
  names("twice", written(wrong));
  wrong = content;
  wrong.anchors[1].id = wrong.anchors[0].id;
  names("ANCH: ids", written(wrong));
  wrong = content;
  wrong.anchors[1].place = 77;
  names("ANCH: an anchor is held by a place that there is not", written(wrong));
  wrong = content;
  wrong.anchors[1].plane = 77;
  names("ANCH: an anchor lies on a plane that there is not", written(wrong));
  wrong = content;
  wrong.anchors[0].between(3, 3) = -1;
  names("ANCH: a covariance", written(wrong));
  wrong = content;
  wrong.anchors[0].T_VA.q.coeffs() *= 2;
  names("ANCH: a number", written(wrong));
  wrong = content;
  wrong.anchors.clear();
  TEST_ASSERT_NULL(refused(written(wrong)));  // as maps of before there were anchors
  bytes = written(wrong);
  const std::size_t end = bytes.size();
  bytes.insert(bytes.end(), good.begin() + static_cast<std::ptrdiff_t>(section_at(good, 4)), good.end());
  set_number(&bytes, 16, bytes.size(), 8);
  names("section", bytes);  // that nothing announces
  set_number(&bytes, 24, 5, 4);
  set_number(&bytes, end + kSectionHeader, 65, 4);
  names("ANCH", bytes);
  wrong = content;
  wrong.places[0].covariance(0, 0) = -1;
  names("covariance", written(wrong));
  wrong = content;
  wrong.places[0].covariance.setIdentity();
  wrong.places[0].covariance(1, 0) = wrong.places[0].covariance(2, 0) = Scalar(0.9);
  wrong.places[0].covariance(2, 1) = Scalar(-0.9);
  names("covariance", written(wrong));
  wrong = content;
  wrong.planes[0].frame.R_WP.col(0) *= -1;
  names("PLAN", written(wrong));
  wrong = content;
  wrong.places[0].q_WK.coeffs() *= 2;
  names("PLAC", written(wrong));
  wrong = content;
  wrong.places.clear();
  names("no place", written(wrong));
  wrong = content;
  wrong.places[0].point[0].rho = 0;
  names("point", written(wrong));
  wrong = content;
  wrong.places[0].point[0].patch.end[0] = PlacePatch::kSize + 1;
  names("patch", written(wrong));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_crc_should_be_castagnolis);
  RUN_TEST(test_what_is_read_should_be_written_again_to_the_last_bit);
  RUN_TEST(test_a_small_buffer_should_stay_as_it_is_behind_its_end);
  RUN_TEST(test_every_truncation_should_be_refused);
  RUN_TEST(test_every_flipped_bit_should_be_refused);
  RUN_TEST(test_forged_bytes_should_be_refused_or_be_numbers_of_a_map);
  RUN_TEST(test_what_is_wrong_should_be_named);
  return UNITY_END();
}
