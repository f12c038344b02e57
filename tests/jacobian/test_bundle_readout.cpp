// The readout in the adjustment: its column of the normal equations against differences of the cost.
#include "bundle/bundle_terms.h"
#include "support/random_window.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// The window's readout is adjusted, and is off by `off`; with which velocities its rows were read out.
struct Rows {
  Camera camera;
  BundleLens lens = {};
  std::vector<Scalar> information;
  std::vector<BundleRates> rates;
  std::vector<HostPixel> host_pixel;

  Rows(SeededRandom& random, double before, double off, RandomWindow* w, Bundle* bundle) {
    w->camera.readout = static_cast<Scalar>(before);
    LensSigmas sigmas;
    sigmas.readout = Scalar(0.01);
    const LensPrior prior = make_lens_prior(sigmas, &w->camera);
    information.assign(1, Scalar(1e4));
    for (std::size_t c = 0; c < w->pose.size(); ++c) rates.push_back({random.normals<3>(0.5), random.normals<3>(0.5)});
    for (std::size_t i = 0; i < w->ray.size(); ++i) {
      HostPixel h = {Vec2::Zero(), false};
      h.given = i % 4 != 3 && project(w->camera, w->ray[i], &h.pixel);
      host_pixel.push_back(h);
    }
    camera = w->camera;
    camera.readout += static_cast<Scalar>(off);
    lens = {prior.rows,        information.data(), w->camera,    &camera,
            host_pixel.data(), w->ray.data(),      rates.data(), w->camera.readout};
    bundle->lens = &lens;
  }
};

/// Poses, planes and depths are held; what is left is the readout.
void check_gradient(SeededRandom& random, double before, int planes) {
  TestArena arena;
  BundleTerms terms;
  RandomWindow window(random, 6, 0, 40, planes, 0.5, 0.01);
  for (BundlePlane& plane : window.plane) plane.free = false;
  for (std::size_t i = 0; i < window.prior.size(); ++i) window.prior[i] = {window.rho[i], Scalar(1e-7)};
  TEST_ASSERT_TRUE(terms.layout(*arena, 6, 1, 40, 4, kLensParameters));
  window.options.huber = Scalar(1e6);
  Bundle bundle = window.bundle();
  Rows rows(random, before, 0, &window, &bundle);
  terms.begin(bundle);
  terms.linearise(rows.camera, window.options, bundle, Scalar(0));
  const double b = static_cast<double>(terms.equations.b[0]), h = sizeof(Scalar) == sizeof(float) ? 1e-3 : 1e-5;
  const auto cost = [&](double e) {
    rows.camera.readout = static_cast<Scalar>(before + e);
    return static_cast<double>(terms.cost(rows.camera, window.options, bundle));
  };
  const double slope = (cost(h) - cost(-h)) / (2 * h);
  TEST_ASSERT_DOUBLE_WITHIN((sizeof(Scalar) == sizeof(float) ? 2e-2 : 1e-5) * std::fabs(slope) + 1, slope, -2 * b);
}

void test_column_of_the_readout_should_be_the_slope_of_the_cost() {
  SeededRandom random(161);
  for (int trial = 0; trial < 20; ++trial) check_gradient(random, trial % 2 == 0 ? 0 : 0.02, trial % 3);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_column_of_the_readout_should_be_the_slope_of_the_cost);
  return UNITY_END();
}
