// pf-capture finds by how much a unit's clock differs from the camera's, from how both turn, and says when it cannot.
#include <planefold/planefold.h>

#include "skip.h"

#if __has_include(<planefold_platform/sim.h>)

#include <planefold_platform/sim.h>
#include <unistd.h>

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>

#include "base/eigen.h"
#include "image_files.h"
#include "seeded_random.h"
#include "unity.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

constexpr int kFrames = 300;
constexpr uint64_t kSeed = 11;

std::string program(const char* name) {
  const char* bin = std::getenv("PLANEFOLD_BIN");
  return std::string(bin != nullptr ? bin : ".") + "/" + name;
}

/// The pictures that all runs see, rendered once.
class Film {
 public:
  Film() {
    const std::string command =
        program("pf-sim") + " render desk --seed 1 --frames " + std::to_string(kFrames) + " --out " + path();
    TEST_ASSERT_EQUAL_INT(0, std::system(command.c_str()));
  }
  std::string path() const { return folder_ / "film"; }

 private:
  TemporaryFolder folder_;
};

using Rates = std::function<Eigen::Vector3d(int64_t)>;

/// Samples at 200 Hz of a unit that is mounted askew, with bias and noise, whose clock is behind by some time.
void write_samples(const std::string& path, double behind_s, const Rates& rates, int64_t last_ns) {
  pf::SeededRandom random(kSeed);
  const Eigen::Matrix3d mounted =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.3, -0.8, 0.5).normalized()).toRotationMatrix();
  std::FILE* file = std::fopen(path.c_str(), "w");
  TEST_ASSERT_NOT_NULL(file);
  for (int64_t t_ns = 0; t_ns < last_ns; t_ns += 5000000) {
    Eigen::Vector3d w = mounted * rates(t_ns) + Eigen::Vector3d(0.01, -0.006, 0.004);
    for (int k = 0; k < 3; ++k) w(k) += 0.01 * random.normal();
    const auto stamp = t_ns - static_cast<int64_t>(1e9 * behind_s) + 10000000000;  // times are positive
    std::fprintf(file, "%" PRId64 ",%.9g,%.9g,%.9g,0,-9.81,0\n", stamp, w(0), w(1), w(2));
  }
  std::fclose(file);
}

struct Report {
  std::string text;
  double number(const std::string& key) const {
    const size_t begin = text.find("\"time_offset\"");
    const size_t at = text.find("\"" + key + "\": ", begin);
    TEST_ASSERT_TRUE_MESSAGE(begin != std::string::npos && at != std::string::npos, key.c_str());
    return std::atof(text.c_str() + at + key.size() + 4);
  }
  bool says(const std::string& part) const { return text.find(part) != std::string::npos; }
};

/// given_s: of --imu-offset, besides what makes the times positive.
Report run(const Rates& rates, double behind_s, double given_s) {
  static const Film film;
  TemporaryFolder folder;
  write_samples(folder / "imu.csv", behind_s, rates, static_cast<int64_t>(1e9 * (kFrames / 30.0 + 1.0)));
  const std::string command = program("pf-capture") + " --headless --no-film --quiet --source images:" + film.path() +
                              " --imu csv:" + (folder / "imu.csv") + " --imu-offset " + std::to_string(given_s - 10.0) +
                              " --out " + (folder / "out");
  TEST_ASSERT_EQUAL_INT(0, std::system(command.c_str()));
  std::ifstream file(folder / "out/report.json");
  return {std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>())};
}

/// How the simulated camera turns; the film is of the same scene, with the same seed.
class Scene {
 public:
  explicit Scene(const char* name) {
    pf_sim_options_t options;
    TEST_ASSERT_EQUAL_INT32(PF_OK, pf_sim_options_default(name, &options));
    options.seed = 1;
    options.frames = kFrames;
    sim_ = pf_sim_open(name, &options);
    TEST_ASSERT_NOT_NULL(sim_);
    pf_image_t image;
    pf_pose_t truth;
    TEST_ASSERT_EQUAL_INT(1, pf_sim_next(sim_, &image, &truth));
    first_ns_ = image.t_ns;
  }
  ~Scene() { pf_sim_close(sim_); }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  Rates rates() const {
    return [this](int64_t t_ns) {
      pf_pose_t pose;
      pf_sim_pose_at(sim_, t_ns, &pose);
      return Eigen::Vector3d(pose.w_C[0], pose.w_C[1], pose.w_C[2]);
    };
  }
  int64_t first_ns() const { return first_ns_; }

 private:
  pf_sim_t* sim_ = nullptr;
  int64_t first_ns_ = 0;
};

void check_finds(double behind_s, double given_s) {
  const Scene scene("desk");
  const Report report = run(scene.rates(), behind_s, given_s);
  const double found = report.number("offset_s") + 10.0, sigma = report.number("sigma_s");
  std::printf("clock behind by %.1f ms, found %.2f ms, sigma %.2f ms, correlation %.3f, first frame at %" PRId64 "\n",
              1e3 * behind_s, 1e3 * found, 1e3 * sigma, report.number("correlation"), scene.first_ns());
  TEST_ASSERT_DOUBLE_WITHIN(0.005, behind_s, found);
  TEST_ASSERT_DOUBLE_WITHIN(3.0 * sigma, behind_s, found);
  TEST_ASSERT_TRUE(sigma < 0.005);
}

void test_time_offset_should_be_found_when_the_clock_of_the_unit_is_behind() { check_finds(0.0374, 0.0); }
void test_time_offset_should_be_found_when_the_clock_of_the_unit_is_ahead() { check_finds(-0.1128, 0.0); }
void test_time_offset_should_add_to_one_that_is_given() { check_finds(0.85, 0.8); }

void test_time_offset_should_be_refused_when_the_unit_does_not_turn() {
  const Report report = run([](int64_t) { return Eigen::Vector3d(0, 0, 0); }, 0.0, 0.0);
  TEST_ASSERT_TRUE(report.says("\"offset_s\": null"));
  TEST_ASSERT_TRUE(report.says("do not turn alike"));
}

void test_time_offset_should_be_refused_when_the_unit_turns_as_another_camera_does() {
  const Scene scene("rotation");
  const Report report = run(scene.rates(), 0.0, 0.0);
  std::printf("correlation %.3f\n", report.number("correlation"));
  TEST_ASSERT_TRUE(report.says("\"offset_s\": null"));
}

}  // namespace

int main() {
  if (access(program("pf-capture").c_str(), X_OK) != 0 || access(program("pf-sim").c_str(), X_OK) != 0) {
    SKIP_PROGRAM("pf-capture or pf-sim is not built");
  }
  UNITY_BEGIN();
  RUN_TEST(test_time_offset_should_be_found_when_the_clock_of_the_unit_is_behind);
  RUN_TEST(test_time_offset_should_be_found_when_the_clock_of_the_unit_is_ahead);
  RUN_TEST(test_time_offset_should_add_to_one_that_is_given);
  RUN_TEST(test_time_offset_should_be_refused_when_the_unit_does_not_turn);
  RUN_TEST(test_time_offset_should_be_refused_when_the_unit_turns_as_another_camera_does);
  return UNITY_END();
}

#else
int main() { SKIP_PROGRAM("platform/sim is not part of this tree"); }
#endif
