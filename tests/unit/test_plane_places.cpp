// Folded points whose pixels say that they lie elsewhere leave their plane, and it turns to where the others are. Where the map begins
// again with them, their plane goes on.
#include "filter_slam/start/walls_apart.h"
#include "same.h"
#include "support/plane_keeper_bench.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kPoints = 16;

/// A camera over a table, y downwards: 0.4 m below it. The first `off` points stand 25 mm above it, at this distance, and all are
/// folded: at the table's far end into a plane that they tilt, else into the table's.
struct Table : PlaneKeeperBench {
  Vec3 truth[kPoints];
  int entry[kPoints];
  int plane = -1;
  Scalar size = 1;  ///< of the world, against what see() is told

  Table(SeededRandom& random, int off, Scalar distance) {
    for (int i = 0; i < kPoints; ++i)
      truth[i] = i < off ? Vec3(Scalar(0.1) * static_cast<Scalar>(i), Scalar(0.375), distance)
                         : Vec3(static_cast<Scalar>(random.uniform(-0.4, 0.4)), Scalar(0.4),
                                static_cast<Scalar>(random.uniform(0.8, 1.2)));
    fold(distance > Scalar(1.2));
  }

  /// Points move along their rays, as pixels want it.
  void fold(bool is_tilted) {
    PlaneFrame about;
    about.o_W = Vec3(0, Scalar(0.4), 1);
    PlaneFit bent;  // by its points, as a filter has it
    TEST_ASSERT_TRUE(fit_plane(truth, kPoints, Vec3(0, 0, 0), &bent));
    if (is_tilted) about.o_W = bent.frame.o_W;
    const Vec3 n = is_tilted ? Vec3(bent.frame.R_WP.col(2)) : Vec3(0, -1, 0);
    about.R_WP.col(0) = Vec3(1, 0, 0);
    about.R_WP.col(1) = n.cross(Vec3(1, 0, 0));
    about.R_WP.col(2) = n;
    int slots[kPoints];
    for (int i = 0; i < kPoints; ++i) {
      const Vec3 ray = truth[i];
      const Vec3 p_W = ray * (n.dot(about.o_W) / n.dot(ray));
      slots[i] = filter->add_point(p_W, Mat3(Mat3::Identity() * Scalar(1e-4)));
      TEST_ASSERT_TRUE(slots[i] >= 0);
      entry[i] = map.features.add(slots[i]);
      filter->set_owner(slots[i], entry[i]);
    }
    PlaneFit fit;
    fit.frame = about;
    fit.lambda = Vec3(Scalar(1e-6), Scalar(0.1), Scalar(0.2));
    fit.count = kPoints;
    plane = filter->add_plane(fit, slots, kPoints, Scalar(0.002));
    TEST_ASSERT_TRUE(plane >= 0);
    const int at = map.planes.add(plane);
    filter->set_owner(plane, at);
    unsigned char folded[Filter::kMaxFolded];
    TEST_ASSERT_EQUAL_INT(kPoints, filter->fold(plane, slots, kPoints, settings.fold, folded));
  }

  void see(Scalar aside, SeededRandom& random, double sigma_px) {
    Body body;
    body.p_W = size * Vec3(aside, Scalar(-0.3) * aside, 0);
    filter->set_mean(body);
    frame.begin(33000000 * (frame.report.frames + 1));
    for (int i = 0; i < kPoints; ++i) {
      if (!map.features.used(entry[i])) continue;
      Feature& f = map.features[entry[i]];
      ++f.observations;
      f.was_missed = false;
      f.rejections = 0;
      f.last_seen_ns = frame.report.t_ns;
      Vec2 z;
      TEST_ASSERT_TRUE(project(settings.camera, Vec3(truth[i] - body.p_W), &z));
      z += random.normals<2>(sigma_px);
      frame.add({entry[i], f.id, MatchStatus::kInlier, BlockKind::kPlanePoint, true, false, z, Mat2::Identity(), z,
                 Scalar(1)});
    }
    planes.maintain();
  }
  /// All lengths become s times as large.
  void scale(Scalar s) {
    filter->join_planes_apart(s, Vec3::Zero());
    scale_tables(s, Vec3::Zero(), &map);
    planes.scale(s);
    for (Vec3& p : truth) p *= s;
    size *= s;
  }
  /// The map begins again with the same features, as points: where they are, or each so much of its depth farther or nearer in turn.
  void begin_again(Scalar apart) {
    map.planes.keep_known();
    filter->init(settings.kernels, settings.body, settings.research.keep_gauge);
    filter->set_lens(settings.camera, LensPrior());
    filter->set_roughness(settings.fold.roughness);
    for (int i = 0; i < kPoints; ++i) {
      const Scalar farther = (i % 2 == 0 ? apart : -apart) * static_cast<Scalar>(1 + i % 3);
      const int slot = filter->add_point(truth[i] * (1 + farther), Mat3(Mat3::Identity() * Scalar(1e-6)));
      TEST_ASSERT_TRUE(slot >= 0);
      map.features[entry[i]].slot = slot;
      filter->set_owner(slot, entry[i]);
    }
  }
  bool is_folded(int i) const {
    return (*filter).state().block[map.features[entry[i]].slot].kind == BlockKind::kPlanePoint;
  }
  double tilt_deg() const {
    Vec3 n;
    Scalar d;
    const Block& block = (*filter).state().block[plane];
    plane_normal((*filter).state().frame_of(block), block.xyz(), &n, &d);
    return std::acos(std::min(1.0, std::abs(static_cast<double>(n.y())))) * 57.29578;
  }
};

/// No filter corrects the points here, so they are looked at when something has happened.
void test_points_should_leave_the_plane_that_they_do_not_lie_on() {
  for (int seed = 1; seed <= 10; ++seed) {
    SeededRandom random(static_cast<unsigned>(seed));
    Table table(random, 3, 1);
    for (int k = 0; k <= 60 && table.map.planes[0].outliers == 0; ++k)
      table.see(Scalar(0.008) * static_cast<Scalar>(k), random, 0.1);
    for (int i = 0; i < kPoints; ++i) TEST_ASSERT_SAME((i >= 3), table.is_folded(i));
    std::printf("%.2f degrees then\n", table.tilt_deg());
    TEST_ASSERT_TRUE(table.tilt_deg() < 1);
    for (int i = 0; i < 3; ++i)
      TEST_ASSERT_TRUE(std::abs(table.filter->point(table.map.features[table.entry[i]].slot).y() - table.truth[i].y()) <
                       0.01);
  }
}

void test_plane_should_turn_to_where_most_of_its_points_are() {
  for (int seed = 1; seed <= 10; ++seed) {
    SeededRandom random(static_cast<unsigned>(seed));
    Table table(random, 4, Scalar(1.5));
    const double before = table.tilt_deg();
    TEST_ASSERT_TRUE(before > 2);
    for (int k = 0; k <= 60 && std::abs(table.tilt_deg() - before) < 1e-6; ++k)
      table.see(Scalar(0.008) * static_cast<Scalar>(k), random, 0.1);
    std::printf("%.2f degrees, then %.2f\n", before, table.tilt_deg());
    TEST_ASSERT_TRUE(table.tilt_deg() < before / 4);
  }
}

/// Six members, three of which hold the plane at a slant, are too few to say so. What began on the plane says it with them.
void test_plane_should_turn_to_where_features_on_trial_show_it_to_be() {
  int turned = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    SeededRandom random(static_cast<unsigned>(seed));
    Table table(random, 3, Scalar(1.5));
    for (int i = 6; i < kPoints; ++i) table.map.features[table.entry[i]].on_trial = true;
    const double before = table.tilt_deg();
    for (int k = 0; k <= 60 && std::abs(table.tilt_deg() - before) < 1e-6; ++k)
      table.see(Scalar(0.008) * static_cast<Scalar>(k), random, 0.1);
    turned += table.tilt_deg() < before / 2 ? 1 : 0;
  }
  std::printf("%d of 10 turned\n", turned);
  TEST_ASSERT_TRUE(turned >= 9);
}

void test_points_should_stay_on_a_plane_on_which_they_lie() {
  for (int seed = 1; seed <= 10; ++seed) {
    SeededRandom random(static_cast<unsigned>(seed));
    Table table(random, 0, 1);
    const Vec3 before = table.filter->state().block[table.plane].xyz();
    for (int k = 0; k <= 40; ++k) table.see(Scalar(0.008) * static_cast<Scalar>(k), random, 0.2);
    for (int i = 0; i < kPoints; ++i) TEST_ASSERT_TRUE(table.is_folded(i));
    TEST_ASSERT_TRUE((table.filter->state().block[table.plane].xyz() - before).norm() < 1e-6);
  }
}

/// What pixels said before of where a point is holds in the new unit of length.
void test_plane_should_keep_its_place_in_the_map_when_lengths_are_scaled() {
  for (const Scalar scale : {Scalar(0.8), Scalar(1.3)}) {
    SeededRandom random(1);
    Table table(random, 3, 1);
    int k = 0;
    for (; k < 4; ++k) table.see(Scalar(0.008) * static_cast<Scalar>(k), random, 0.1);
    TEST_ASSERT_EQUAL_INT(0, table.map.planes[0].outliers);
    table.scale(scale);
    for (; k <= 60 && table.map.planes[0].outliers == 0; ++k)
      table.see(Scalar(0.008) * static_cast<Scalar>(k), random, 0.1);
    for (int i = 0; i < kPoints; ++i) {
      TEST_ASSERT_SAME((i >= 3), table.is_folded(i));
      const Vec3 p_W = table.filter->point(table.map.features[table.entry[i]].slot);
      TEST_ASSERT_TRUE((p_W - table.truth[i]).norm() < 0.02);
    }
  }
}

void test_plane_should_go_on_when_the_map_begins_again_with_its_points() {
  SeededRandom random(1);
  Table table(random, 0, 1);
  for (int k = 0; k < 12; ++k) table.see(Scalar(0.008) * static_cast<Scalar>(k), random, 0.2);
  const std::uint32_t id = table.map.planes[0].id;
  table.begin_again(0);
  TEST_ASSERT_EQUAL_INT(-1, table.map.planes.entry_of(id));
  table.see(0, random, 0.1);
  TEST_ASSERT_TRUE(table.map.planes.entry_of(id) >= 0);
  table.see(0, random, 0.1);
  for (int i = 0; i < kPoints; ++i) TEST_ASSERT_TRUE(table.is_folded(i));
}

void test_plane_should_be_given_up_when_the_map_begins_again_without_it() {
  SeededRandom random(1);
  Table table(random, 0, 1);
  for (int k = 0; k < 12; ++k) table.see(Scalar(0.008) * static_cast<Scalar>(k), random, 0.2);
  const std::uint32_t id = table.map.planes[0].id;
  table.begin_again(Scalar(0.1));
  for (int k = 0; k < 10; ++k) table.see(0, random, 0.1);
  TEST_ASSERT_EQUAL_INT(-1, table.map.planes.entry_of(id));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_points_should_leave_the_plane_that_they_do_not_lie_on);
  RUN_TEST(test_plane_should_turn_to_where_most_of_its_points_are);
  RUN_TEST(test_plane_should_turn_to_where_features_on_trial_show_it_to_be);
  RUN_TEST(test_points_should_stay_on_a_plane_on_which_they_lie);
  RUN_TEST(test_plane_should_keep_its_place_in_the_map_when_lengths_are_scaled);
  RUN_TEST(test_plane_should_go_on_when_the_map_begins_again_with_its_points);
  RUN_TEST(test_plane_should_be_given_up_when_the_map_begins_again_without_it);
  return UNITY_END();
}
