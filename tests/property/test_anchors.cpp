// Anchors in both back ends: they go with the planes and the cameras that hold them, and with W where all of it is moved.
#include "filter_slam/filter_anchors.h"
#include "geometry/ray_plane.h"
#include "keyframe_slam/memory/keyframe_anchors.h"
#include "support/plane_keeper_bench.h"
#include "support/window_bench.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kRounding = sizeof(Scalar) == sizeof(float) ? Scalar(2e-5) : Scalar(1e-10);

/// A plane 2 m before the camera, turned by up to half a radian.
PlaneFrame plane_in_view(SeededRandom& random) {
  PlaneFrame frame;
  Mat3 towards;  // the third axis points back to the camera
  towards << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  frame.R_WP = random_turn(random, 0.3).toRotationMatrix() * towards;
  frame.o_W = Vec3(0, 0, 2) + random.normals<3>(0.1);
  return frame;
}

struct FilterBench : PlaneKeeperBench {
  static constexpr std::uint32_t kMap = 1;

  FilterAnchors anchors{*filter, map, features};
  int plane = -1;
  std::int64_t t_ns = 0;

  explicit FilterBench(SeededRandom& random) {
    const Mat3 P = Vec3(Scalar(1e-5), Scalar(1e-5), Scalar(1e-4)).asDiagonal();
    const int slot = filter->add_known_plane(plane_in_view(random), P, Scalar(0.002));
    TEST_ASSERT_TRUE(slot >= 0);
    plane = map.planes.add(slot);
    filter->set_owner(slot, plane);
    Scalar body[144] = {};
    for (int i = 0; i < 12; ++i) body[13 * i] = Scalar(1e-4);
    filter->set_body(Body(), body);
  }
  const Anchor& add(const AnchorRequest& asked) {
    std::uint32_t id = 0;
    TEST_ASSERT_SAME(Status::kOk, anchors.add(asked, kMap, ++t_ns, 0, &id));
    return map.anchors[map.anchors.entry_of(id)];
  }
  /// Where the ray of a pixel meets the plane.
  AnchorRequest hit(SeededRandom& random) const {
    const Vec3 ray(static_cast<Scalar>(random.uniform(-0.3, 0.3)), static_cast<Scalar>(random.uniform(-0.3, 0.3)), 1);
    const Block& block = state().block[map.planes[plane].slot];
    AnchorRequest asked;
    asked.plane = plane;
    TEST_ASSERT_TRUE(intersect_ray_plane(state().frame_of(block), block.xyz(), Vec3::Zero(), ray, &asked.T_WA.p));
    return asked;
  }
  const State& state() const { return (*filter).state(); }
  Scalar distance(const Vec3& p_W) const {
    const Block& block = state().block[map.planes[plane].slot];
    return plane_distance(state().frame_of(block), block.xyz(), p_W);
  }
};

void test_of_the_filter_an_anchor_should_be_where_it_was_asked_for() {
  SeededRandom random(21);
  for (int trial = 0; trial < 20; ++trial) {
    FilterBench bench(random);
    const AnchorRequest asked = bench.hit(random);
    const Anchor& on = bench.add(asked);
    TEST_ASSERT_TRUE((on.T_WA.p - asked.T_WA.p).norm() < kRounding);
    AnchorRequest pose;
    pose.T_WA = {random_turn(random, 1), random.normals<3>(1)};
    const Anchor& free = bench.add(pose);
    TEST_ASSERT_TRUE((free.T_WA.p - pose.T_WA.p).norm() < kRounding);
    TEST_ASSERT_TRUE(free.T_WA.q.angularDistance(pose.T_WA.q) < 10 * kRounding);
  }
}

void test_of_the_filter_an_anchor_should_go_with_its_plane() {
  SeededRandom random(22);
  for (int trial = 0; trial < 20; ++trial) {
    FilterBench bench(random);
    const AnchorRequest asked = bench.hit(random);
    const Anchor& anchor = bench.add(asked);
    const Vec3 was = anchor.T_WA.p;
    const Mat3 Q = Mat3::Identity() * Scalar(1e-6);
    const Vec3 x = random.normals<3>(0.05);
    TEST_ASSERT_TRUE(bench.filter->slide_plane(bench.map.planes[bench.plane].slot, x, Q, Scalar(0.001)));
    bench.anchors.follow(FilterBench::kMap, 0);
    TEST_ASSERT_TRUE(std::abs(bench.distance(anchor.T_WA.p)) < kRounding);
    TEST_ASSERT_TRUE((anchor.T_WA.p - was).norm() > Scalar(1e-4));
    TEST_ASSERT_TRUE(anchor.T_WA.p.cross(was).norm() < 10 * kRounding);  // the camera is at the origin: the same ray
  }
}

/// A translation, a rotation and a scaling of all that the state holds move anchors as they move everything.
void test_of_the_filter_an_anchor_should_go_with_the_world() {
  SeededRandom random(23);
  const double step = 1e-4;
  for (int direction = 0; direction < 7; ++direction) {
    FilterBench bench(random);
    const AnchorRequest asked = bench.hit(random);
    const Anchor& on = bench.add(asked);
    AnchorRequest pose;
    pose.T_WA = {random_turn(random, 1), Vec3::Zero()};  // at the camera: a scale cannot stretch what a camera holds
    const Anchor& free = bench.add(pose);
    const RelativePlace before[2] = {on.T_WA, free.T_WA};
    const Dense N = bench.filter.gauge();
    std::vector<Scalar> dx;
    for (int i = 0; i < bench.filter.dim(); ++i) dx.push_back(static_cast<Scalar>(step * N(i, direction)));
    bench.filter.move(dx.data());
    bench.anchors.follow(FilterBench::kMap, 0);
    Vec3 unit = Vec3::Zero();
    if (direction < 6) unit(direction % 3) = static_cast<Scalar>(step);
    for (int k = 0; k < 2; ++k) {
      const RelativePlace& now = k == 0 ? on.T_WA : free.T_WA;
      const Vec3 p = direction < 3   ? Vec3(before[k].p + unit)
                     : direction < 6 ? Vec3(exp_so3(unit) * before[k].p)
                                     : Vec3((1 + static_cast<Scalar>(step)) * before[k].p);
      const Quat q = direction >= 3 && direction < 6 ? Quat(exp_so3(unit) * before[k].q) : before[k].q;
      const Scalar most = sizeof(Scalar) == sizeof(float) ? Scalar(1e-5) : Scalar(1e-6);  // of second order: 1e-8
      TEST_ASSERT_TRUE((now.p - p).norm() < most);
      TEST_ASSERT_TRUE(log_so3((now.q * q.conjugate()).normalized()).norm() < most);
    }
  }
}

/// What is known of an anchor on a plane is what a hit test says at that moment.
void test_of_the_filter_anchors_of_a_frame_should_share_a_camera_that_goes_with_the_last() {
  SeededRandom random(24);
  FilterBench bench(random);
  const int rows = bench.filter.dim();
  std::uint32_t id[3];
  for (int k = 0; k < 3; ++k)
    TEST_ASSERT_SAME(Status::kOk, bench.anchors.add(bench.hit(random), 1, k < 2 ? 50 : 51, 0, &id[k]));
  TEST_ASSERT_EQUAL_INT(rows + 12, bench.filter.dim());
  bench.anchors.remove(bench.map.anchors.entry_of(id[0]));
  TEST_ASSERT_EQUAL_INT(rows + 12, bench.filter.dim());
  bench.anchors.remove(bench.map.anchors.entry_of(id[1]));
  TEST_ASSERT_EQUAL_INT(rows + 6, bench.filter.dim());
  bench.anchors.remove(bench.map.anchors.entry_of(id[2]));
  TEST_ASSERT_EQUAL_INT(rows, bench.filter.dim());
}

/// The plane may go, and the filter may begin again.
void test_of_the_filter_an_anchor_should_stay_when_what_holds_it_goes() {
  SeededRandom random(25);
  FilterBench bench(random);
  const Anchor& anchor = bench.add(bench.hit(random));
  const Vec3 was = anchor.T_WA.p;
  const Scalar sigma = std::sqrt(anchor.covariance(5, 5));
  const int slot = bench.map.planes[bench.plane].slot;
  bench.map.planes.remove(bench.plane);
  bench.filter->remove(&slot, 1);
  bench.anchors.follow(FilterBench::kMap, 0);
  TEST_ASSERT_FALSE(anchor.is_on_plane);
  TEST_ASSERT_TRUE((anchor.T_WA.p - was).norm() < kRounding);
  TEST_ASSERT_TRUE(std::sqrt(anchor.covariance(5, 5)) > sigma / 2);
  TEST_ASSERT_TRUE(anchor.camera >= 0);
  const int before = anchor.camera;
  Anchor& awaits = bench.map.anchors[bench.map.anchors.entry_of(anchor.id)];
  awaits.T_KV = awaits.T_WV;  // the camera is at the origin
  awaits.between = awaits.covariance_WV;
  awaits.camera = Anchor::kAwaitsCamera;
  bench.filter->unpin(before);
  bench.anchors.follow(FilterBench::kMap + 1, 0);
  TEST_ASSERT_EQUAL_INT(Anchor::kAwaitsCamera, anchor.camera);
  bench.anchors.follow(FilterBench::kMap, 0);
  TEST_ASSERT_TRUE(anchor.camera >= 0);
  TEST_ASSERT_TRUE((anchor.T_WA.p - was).norm() < kRounding);
  TEST_ASSERT_TRUE(std::sqrt(anchor.covariance(5, 5)) > sigma);
}

struct WindowBench : KeyframeBench {
  KeyframeAnchors anchors{tables.anchors, map, planes};
  KeyframeAnchors::View view;

  explicit WindowBench(std::uint64_t seed) : KeyframeBench(seed) {
    TEST_ASSERT_EQUAL_INT(0, tables.planes.restore(1));
    planes.restore(0, plane_in_view(random), Mat3::Identity() * Scalar(1e-6));
    view.T_WV.p = Vec3(Scalar(0.22), 0, 0);
    view.covariance = Mat6::Identity() * Scalar(1e-6);
    view.depth = 2;
    view.t_ns = 5;
    for (const int k : used_entries(map.keyframes)) map.keyframes[k].covariance = Mat6::Identity() * Scalar(1e-6);
  }
  AnchorRequest hit() {
    AnchorRequest asked;
    asked.plane = 0;
    TEST_ASSERT_TRUE(intersect_ray_plane(planes.plane(0).frame, Vec3::Zero(), view.T_WV.p,
                                         Vec3(Scalar(0.1), Scalar(-0.1), 1), &asked.T_WA.p));
    return asked;
  }
  Anchor& add(const AnchorRequest& asked) {
    std::uint32_t id = 0;
    TEST_ASSERT_SAME(Status::kOk, anchors.add(asked, 1, view, &id));
    return tables.anchors[tables.anchors.entry_of(id)];
  }
};

void test_of_the_window_an_anchor_should_be_held_by_the_nearest_keyframe_and_go_with_it() {
  WindowBench bench(31);
  AnchorRequest pose;
  pose.T_WA.p = Vec3(0, Scalar(0.3), 1);
  const Anchor& anchor = bench.add(pose);
  TEST_ASSERT_EQUAL_UINT32(3, anchor.place);  // that at 0.2
  TEST_ASSERT_TRUE((anchor.T_WA.p - pose.T_WA.p).norm() < kRounding);
  Keyframe& k = bench.map.keyframes[2];
  const Quat turn = exp_so3(Vec3(0, Scalar(0.01), 0));
  const Vec3 was = anchor.T_WA.p, centre = k.p_W, shift(Scalar(0.01), Scalar(0.02), 0);
  k.q_WC = turn * k.q_WC;
  k.p_W += shift;
  bench.anchors.follow(1, 2);
  TEST_ASSERT_TRUE((anchor.T_WA.p - (centre + shift + turn * (was - centre))).norm() < kRounding);
}

void test_of_the_window_an_anchor_should_go_with_its_plane() {
  WindowBench bench(32);
  const AnchorRequest asked = bench.hit();
  const Anchor& anchor = bench.add(asked);
  TEST_ASSERT_TRUE((anchor.T_WA.p - asked.T_WA.p).norm() < kRounding);
  PlaneFrame frame = bench.planes.plane(0).frame;
  frame.o_W += Scalar(0.05) * frame.R_WP.col(2) + Scalar(0.4) * frame.R_WP.col(0);
  frame.R_WP = exp_so3(Vec3(Scalar(0.02), Scalar(0.01), 1)).toRotationMatrix() * frame.R_WP;
  bench.planes.restore(0, frame, Mat3::Identity() * Scalar(1e-6));
  bench.anchors.follow(1, 2);
  TEST_ASSERT_TRUE(std::abs(frame.R_WP.col(2).dot(anchor.T_WA.p - frame.o_W)) < kRounding);
  TEST_ASSERT_TRUE((anchor.T_WA.q * Vec3::UnitZ() - frame.R_WP.col(2)).norm() < 10 * kRounding);
  TEST_ASSERT_TRUE((anchor.T_WA.p - bench.view.T_WV.p).cross(asked.T_WA.p - bench.view.T_WV.p).norm() < 10 * kRounding);
}

void test_of_the_window_an_anchor_should_keep_its_place_before_the_camera_when_the_map_begins_again() {
  WindowBench bench(35);
  AnchorRequest pose;
  pose.T_WA.p = Vec3(0, Scalar(0.3), 1);
  const Anchor& anchor = bench.add(pose);
  const RelativePlace T_CA = bench.view.T_WV.inverse().of(anchor.T_WA);
  const RelativePlace now = {exp_so3(Vec3(Scalar(0.1), 0, Scalar(0.2))), Vec3(Scalar(0.6), Scalar(0.1), 0)};
  bench.map.keyframes.remove(2);
  bench.map.keyframes.add(9, now.q, now.p);
  bench.anchors.move(bench.view.T_WV, now, 1);
  bench.anchors.follow(1, 2);
  TEST_ASSERT_EQUAL_UINT32(7, anchor.place);
  TEST_ASSERT_TRUE((anchor.T_WA.p - now.of(T_CA).p).norm() < kRounding);
}

void test_of_the_window_an_anchor_should_stay_when_its_keyframe_and_plane_go() {
  WindowBench bench(33);
  const Anchor& anchor = bench.add(bench.hit());
  const Vec3 was = anchor.T_WA.p;
  const Mat6 P = anchor.covariance;
  bench.map.keyframes.remove(2);
  bench.anchors.follow(1, 2);
  TEST_ASSERT_TRUE(anchor.place != 3 && anchor.place != 0);
  TEST_ASSERT_TRUE((anchor.T_WA.p - was).norm() < kRounding);
  for (int i = 0; i < 6; ++i) TEST_ASSERT_TRUE(anchor.covariance(i, i) > Scalar(0.99) * P(i, i));
  bench.tables.planes.remove(0);
  bench.anchors.follow(1, 2);
  TEST_ASSERT_FALSE(anchor.is_on_plane);
  TEST_ASSERT_TRUE((anchor.T_WA.p - was).norm() < kRounding);
  for (int k = 0; k < KeyframeBench::kKeyframes; ++k)
    if (bench.map.keyframes.used(k)) bench.map.keyframes.remove(k);
  bench.anchors.follow(1, 2);
  TEST_ASSERT_EQUAL_UINT32(0, anchor.place);
  bench.anchors.follow(1, 2);
  TEST_ASSERT_TRUE((anchor.T_WA.p - was).norm() < kRounding);
}

void test_a_full_table_and_a_ray_that_misses_should_change_nothing() {
  WindowBench window(34);
  SeededRandom random(34);
  FilterBench filter(random);
  AnchorRequest behind;
  behind.plane = 0;
  behind.T_WA.p = Vec3(0, 0, -2);
  std::uint32_t id = 77;
  TEST_ASSERT_SAME(Status::kRange, window.anchors.add(behind, 1, window.view, &id));
  const int rows = filter.filter.dim();
  TEST_ASSERT_SAME(Status::kRange, filter.anchors.add(behind, 1, 5, 0, &id));
  TEST_ASSERT_EQUAL_INT(rows, filter.filter.dim());
  TEST_ASSERT_EQUAL_INT(0, window.tables.anchors.count() + filter.map.anchors.count());
  for (int k = 0; k < 8; ++k) {
    window.add(window.hit());
    filter.add(filter.hit(random));
  }
  const int full = filter.filter.dim();
  TEST_ASSERT_SAME(Status::kFull, window.anchors.add(window.hit(), 1, window.view, &id));
  TEST_ASSERT_SAME(Status::kFull, filter.anchors.add(filter.hit(random), 1, 6, 0, &id));
  TEST_ASSERT_EQUAL_INT(full, filter.filter.dim());
  TEST_ASSERT_EQUAL_UINT32(77, id);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_of_the_filter_an_anchor_should_be_where_it_was_asked_for);
  RUN_TEST(test_of_the_filter_an_anchor_should_go_with_its_plane);
  RUN_TEST(test_of_the_filter_an_anchor_should_go_with_the_world);
  RUN_TEST(test_of_the_filter_anchors_of_a_frame_should_share_a_camera_that_goes_with_the_last);
  RUN_TEST(test_of_the_filter_an_anchor_should_stay_when_what_holds_it_goes);
  RUN_TEST(test_of_the_window_an_anchor_should_be_held_by_the_nearest_keyframe_and_go_with_it);
  RUN_TEST(test_of_the_window_an_anchor_should_go_with_its_plane);
  RUN_TEST(test_of_the_window_an_anchor_should_keep_its_place_before_the_camera_when_the_map_begins_again);
  RUN_TEST(test_of_the_window_an_anchor_should_stay_when_its_keyframe_and_plane_go);
  RUN_TEST(test_a_full_table_and_a_ray_that_misses_should_change_nothing);
  return UNITY_END();
}
