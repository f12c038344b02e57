// Anchors on rendered frames, with either back end: where they should be by their own covariance, when they are set, after a second of
// black, and after the camera has come back to them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "base/eigen.h"
#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Point = Eigen::Vector3d;

constexpr int kLength = 330, kSetFrom = 90, kSetTo = 150, kEvery = 20, kBlackFrom = 170, kBlackTo = 200;
constexpr std::uint64_t kSeeds[] = {101, 102, 103};

struct Set {
  std::uint32_t id;
  Point truth_W;
};

std::uint64_t seed;

/// What the ray of a pixel really meets.
bool true_point(const RenderedRun& run, int u, int v, Point* p_W) {
  const pf_camera_t& camera = run.config.camera;
  const std::size_t pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  std::vector<float> depth(pixels);
  std::vector<std::int32_t> surface(pixels);
  const pf_pose_t& pose = run.frames.back().truth;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_depth(run.scene(), &pose, depth.data(), surface.data()));
  const std::int32_t at = surface[static_cast<std::size_t>(v * camera.width + u)];
  Point n_W, ray;
  double d_W = 0;
  if (at < 0 || pf_sim_surface(run.scene(), at, n_W.data(), &d_W) != PF_OK) return false;
  const double pixel[2] = {static_cast<double>(u), static_cast<double>(v)};
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_unproject(&camera, pixel, ray.data()));
  const Eigen::Quaterniond q(pose.q_WC[0], pose.q_WC[1], pose.q_WC[2], pose.q_WC[3]);
  const Point c_W(pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]), direction = q * ray;
  *p_W = c_W + direction * ((d_W - n_W.dot(c_W)) / n_W.dot(direction));
  return true;
}

pf_anchor_t anchor_of(const RenderedRun& run, std::uint32_t id) {
  pf_anchor_t anchor;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_anchor(run.slam, id, &anchor));
  return anchor;
}

/// Squared Mahalanobis distance of an anchor's position from the truth, three degrees of freedom, and the distance [m].
double squared_sigmas(const RenderedRun& run, const Set& set, double* distance) {
  const pf_anchor_t anchor = anchor_of(run, set.id);
  const Point e = Point(anchor.p_WA[0], anchor.p_WA[1], anchor.p_WA[2]) - set.truth_W;
  Eigen::Matrix3d P;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) P(i, j) = anchor.covariance[6 * (3 + i) + 3 + j];
  *distance = e.norm();
  return e.dot(P.inverse() * e);
}

/// On the plane of the surface that is really there: a hit on another one is the plane's fault, and not the anchor's.
void set_some(RenderedRun& run, std::vector<Set>* sets) {
  const pf_camera_t& camera = run.config.camera;
  for (const int u : {camera.width / 3, 2 * camera.width / 3}) {
    const int v = camera.height / 2;
    const double pixel[2] = {static_cast<double>(u), static_cast<double>(v)};
    pf_hit_t hit;
    Set set;
    if (pf_hit_test(run.slam, pixel, &hit) != PF_OK || !true_point(run, u, v, &set.truth_W)) continue;
    const Point off = Point(hit.p_W[0], hit.p_W[1], hit.p_W[2]) - set.truth_W;
    if (off.norm() > 0.1) continue;
    if (pf_add_anchor_hit(run.slam, &hit, &set.id) == PF_OK) sets->push_back(set);
  }
}

struct Outcome {
  std::vector<double> before, after, end;  ///< squared sigmas
  double worst_m = 0;
};

void note(const RenderedRun& run, const std::vector<Set>& sets, std::vector<double>* out, double* worst_m) {
  for (const Set& set : sets) {
    double distance = 0;
    out->push_back(squared_sigmas(run, set, &distance));
    *worst_m = std::max(*worst_m, distance);
  }
}

Outcome outcome_of(pf_backend_t backend) {
  Outcome out;
  RenderedRun::backend = backend;
  for (const std::uint64_t s : kSeeds) {
    seed = s;
    RenderedRun run("room", kLength, RenderedRun::Start::kRectangle,
                    [](pf_sim_options_t* options) { options->seed = seed; });
    run.config.capacity.max_anchors = 16;
    run.create();
    run.start_at_rectangle();
    std::vector<Set> sets;
    while (static_cast<int>(run.frames.size()) < kBlackFrom && run.step()) {
      const int frame = static_cast<int>(run.frames.size());
      if (frame >= kSetFrom && frame <= kSetTo && frame % kEvery == 0 && run.frames.back().status == PF_OK)
        set_some(run, &sets);
    }
    note(run, sets, &out.before, &out.worst_m);
    const std::size_t first = out.before.size() - sets.size();
    run.tracked_until(kBlackTo, 0);
    while (run.step()) {
      if (static_cast<int>(run.frames.size()) == kBlackTo + 40) note(run, sets, &out.after, &out.worst_m);
    }
    note(run, sets, &out.end, &out.worst_m);
    std::printf("seed %llu: %zu anchors; tracked at the end: %d\n", static_cast<unsigned long long>(s), sets.size(),
                run.frames.back().status == PF_OK);
    for (std::size_t k = first; k < out.before.size(); ++k)
      std::printf("  squared sigmas %.2f before, %.2f after black, %.2f at the end\n", out.before[k], out.after[k],
                  out.end[k]);
  }
  return out;
}

double share_within(const std::vector<double>& values, double bound) {
  return static_cast<double>(std::count_if(values.begin(), values.end(), [&](double v) { return v < bound; })) /
         static_cast<double>(values.size());
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

void require_honest(pf_backend_t backend) {
  constexpr double kThreeSigma = 14.16;  // chi-square with three degrees of freedom: 0.27 % are beyond
  const Outcome out = outcome_of(backend);
  std::printf(
      "%zu anchors: mean of squared sigmas (3 expected) %.2f before, %.2f after black, %.2f at the end; worst %.4f m\n",
      out.before.size(), mean(out.before), mean(out.after), mean(out.end), out.worst_m);
  TEST_ASSERT_TRUE(out.before.size() >= 8);
  for (const auto* values : {&out.before, &out.after, &out.end})
    TEST_ASSERT_TRUE(share_within(*values, kThreeSigma) == 1);
}

void test_anchors_of_the_filter_should_be_within_three_sigmas() { require_honest(PF_BACKEND_FILTER); }
void test_anchors_of_the_window_should_be_within_three_sigmas() { require_honest(PF_BACKEND_WINDOW); }

/// Pictures that show something else for long: a new map begins, and the anchor stays what it was in the old one.
void require_left_behind(pf_backend_t backend) {
  RenderedRun::backend = backend;
  RenderedRun run("room", kLength, RenderedRun::Start::kRectangle);
  run.config.motion.coast_s = 0.2;
  run.config.motion.restart_s = 0.3;
  run.create();
  run.start_at_rectangle();
  std::vector<Set> sets;
  while (sets.empty() && run.step())
    if (static_cast<int>(run.frames.size()) >= kSetFrom) set_some(run, &sets);
  TEST_ASSERT_FALSE(sets.empty());
  pf_anchor_t last = anchor_of(run, sets[0].id);
  run.flicker = 1;
  std::uint32_t map_id = last.map_id;
  while (map_id == last.map_id && run.step()) {
    const pf_anchor_t anchor = anchor_of(run, sets[0].id);
    map_id = run.frames.back().report.map_id;
    TEST_ASSERT_EQUAL_UINT32(last.map_id, anchor.map_id);
    if (map_id != last.map_id) TEST_ASSERT_EQUAL_MEMORY(&last, &anchor, sizeof(last));
    last = anchor;
  }
  TEST_ASSERT_TRUE(map_id > last.map_id);
  run.flicker = 0;
  for (int k = 0; k < 60 && run.step(); ++k) {
    const pf_anchor_t anchor = anchor_of(run, sets[0].id);
    if (run.frames.back().report.map_id == last.map_id) {  // joined to the map that was left: it follows again
      double apart2 = 0;
      for (int i = 0; i < 3; ++i) apart2 += (anchor.p_WA[i] - last.p_WA[i]) * (anchor.p_WA[i] - last.p_WA[i]);
      std::printf("joined after %d frames, the anchor has moved by %.4f\n", k + 1, std::sqrt(apart2));
      TEST_ASSERT_TRUE(apart2 < 0.05 * 0.05);
      continue;
    }
    TEST_ASSERT_EQUAL_MEMORY(&last, &anchor, sizeof(last));
  }
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_remove_anchor(run.slam, sets[0].id));
}

void test_an_anchor_should_stay_as_it_was_when_its_map_is_discarded() {
  for (const pf_backend_t backend : {PF_BACKEND_FILTER, PF_BACKEND_WINDOW}) require_left_behind(backend);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_anchors_of_the_filter_should_be_within_three_sigmas);
  RUN_TEST(test_anchors_of_the_window_should_be_within_three_sigmas);
  RUN_TEST(test_an_anchor_should_stay_as_it_was_when_its_map_is_discarded);
  return UNITY_END();
}
