// The target reader: its three forms, and what it refuses.
#include "skip.h"

#if __has_include(<planefold_platform/sequence.h>)

#include <cmath>

#include "sequence_test.h"

using namespace pf::test;

void setUp() {}
void tearDown() {}

namespace {

const char* const kPoints =
    "points:\n  - [0.1, 0.0, 0.0]\n  - [-0.1, 0.0, 0.0]\n  - [0.0, 0.1, 0.0]\n  - [0.0, -0.1, 0.2]\n"
    "first_pose:\n  position: [0.0, 0.1, -0.6]\n  quaternion_wxyz: [0.8, 0.6, 0.0, 0.0]\n  sigma_position: 0.03\n"
    "  sigma_rotation: 0.1\nsigma: 0.002\n";
const char* const kSceneLib =
    "features:\n  - [0.13, 0.04, 0.0]\n  - [-0.05, 0.04, 0.0]\n  - [0.13, -0.09, 0.0]\n  - [-0.05, -0.09, 0.0]\n"
    "start_camera_position: [0.0, 0.0, -0.6]\nstart_camera_quat_wxyz: [0.9, 0.1, 0.2, 0.374165738677394]\n";

int read(const std::string& text, pf_target_t* target, char* message) {
  TemporaryFolder folder;
  folder.write("target.yaml", text);
  return pf_read_target((folder / "target.yaml").c_str(), target, message);
}

void refused(std::string text, const std::string& from, const std::string& to, const std::string& part) {
  const size_t at = text.find(from);
  TEST_ASSERT_TRUE_MESSAGE(at != std::string::npos, from.c_str());
  text.replace(at, from.size(), to);
  pf_target_t target;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT_MESSAGE(-1, read(text, &target, message), text.c_str());
  require_message(message, part);
  require_message(message, "target.yaml");
}

void rotate(const double q[4], const double v[3], double out[3]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double R[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                          {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                          {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  for (int i = 0; i < 3; ++i) out[i] = R[i][0] * v[0] + R[i][1] * v[1] + R[i][2] * v[2];
}

}  // namespace

static void test_rectangle_should_be_read_from_a_file_and_from_text() {
  pf_target_t target;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT(0, read("width: 0.21\nheight: 0.148\nsigma: 0.001\n", &target, message));
  TEST_ASSERT_EQUAL_INT(PF_TARGET_RECTANGLE, target.kind);
  TEST_ASSERT_EQUAL_DOUBLE(0.21, target.width);
  TEST_ASSERT_EQUAL_DOUBLE(0.001, target.sigma);
  TEST_ASSERT_EQUAL_INT(0, pf_parse_rectangle("0.1832x0.1295", &target, message));
  TEST_ASSERT_EQUAL_DOUBLE(0.1832, target.width);
  TEST_ASSERT_EQUAL_DOUBLE(0.1295, target.height);
  TEST_ASSERT_TRUE(target.sigma > 0.0);
  for (const char* text : {"", "x", "0.1x", "0.1", "-1x2", "0x1", "nanx1", "1xinf", "1x2x3", "2000x1"}) {
    TEST_ASSERT_EQUAL_INT_MESSAGE(-1, pf_parse_rectangle(text, &target, message), text);
    require_message(message, "rectangle:");
  }
}

static void test_sigma_in_degrees_should_get_a_note_that_can_be_typed() {
  for (const auto& [written, note] : {std::pair("3", "write sigma_rotation: 0.05236"), std::pair("0.1", "")}) {
    std::string text = kPoints;
    text.replace(text.find("sigma_rotation: 0.1") + 16, 3, written);
    TemporaryFolder folder;
    folder.write("target.yaml", text);
    pf_target_t target;
    char message[PF_SEQUENCE_MESSAGE] = "";
    TEST_ASSERT_EQUAL_INT(0, pf_read_target((folder / "target.yaml").c_str(), &target, message));
    if (note[0] == '\0')
      TEST_ASSERT_EQUAL_STRING("", message);
    else
      require_message(message, note);
  }
}

static void test_points_should_be_read_with_their_first_pose() {
  pf_target_t target;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, read(kPoints, &target, message), message);
  TEST_ASSERT_EQUAL_INT(PF_TARGET_POINTS, target.kind);
  TEST_ASSERT_EQUAL_INT(4, target.count);
  TEST_ASSERT_EQUAL_DOUBLE(0.2, target.points_W[3][2]);
  TEST_ASSERT_EQUAL_DOUBLE(0.6, target.first_pose.q_WC[1]);
  TEST_ASSERT_EQUAL_DOUBLE(-0.6, target.first_pose.p_WC[2]);
  TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.01, target.first_pose.covariance[0]);
  TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0009, target.first_pose.covariance[35]);
  TEST_ASSERT_EQUAL_DOUBLE(0.002, target.sigma);
}

static void test_scenelib_camera_should_be_turned_to_right_down_forward() {
  pf_target_t target;
  char message[PF_SEQUENCE_MESSAGE];
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, read(kSceneLib, &target, message), message);
  TEST_ASSERT_EQUAL_INT(PF_TARGET_POINTS, target.kind);
  // R_WC (x, y, z) must be R_scenelib (-x, -y, z) for every vector.
  const double q_scenelib[4] = {0.9, 0.1, 0.2, 0.374165738677394};
  const double v[3] = {0.3, -0.7, 1.1};
  const double turned[3] = {-0.3, 0.7, 1.1};
  double expected[3];
  double found[3];
  rotate(q_scenelib, turned, expected);
  rotate(target.first_pose.q_WC, v, found);
  for (int i = 0; i < 3; ++i) {
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected[i], found[i]);
  }
  TEST_ASSERT_EQUAL_DOUBLE(-0.6, target.first_pose.p_WC[2]);
  TEST_ASSERT_TRUE(target.first_pose.covariance[35] > 0.0);
}

static void test_target_should_be_refused_when_a_number_is_nan_or_absurd() {
  refused("width: 0.2\nheight: 0.1\n", "0.2", "nan", "'width'");
  refused("width: 0.2\nheight: 0.1\n", "0.1", "-0.1", "'height'");
  refused("width: 0.2\nheight: 0.1\n", "height", "depth", "'height'");
  refused("width: 0.2\nheight: 0.1\nsigma: 1e-3\n", "1e-3", "0", "'sigma'");
  refused(kPoints, "[0.1, 0.0, 0.0]", "[nan, 0.0, 0.0]", "'points'");
  refused(kPoints, "[0.1, 0.0, 0.0]", "[0.1, 0.0]", "'points'");
  refused(kPoints, "[0.1, 0.0, 0.0]", "[-0.1, 0.0, 0.0]", "same point");
  refused(kPoints, "[0.1, 0.0, 0.0]", "[1e5, 0.0, 0.0]", "metre");
  refused(kPoints, "  - [0.1, 0.0, 0.0]\n", "", "3 points");
  refused(kPoints, "[0.8, 0.6, 0.0, 0.0]", "[0.8, 0.8, 0.0, 0.0]", "first_pose.quaternion_wxyz");
  refused(kPoints, "[0.8, 0.6, 0.0, 0.0]", "[nan, 0.6, 0.0, 0.0]", "first_pose.quaternion_wxyz");
  refused(kPoints, "position: [0.0, 0.1, -0.6]", "position: [0.0, 0.1]", "first_pose.position");
  refused(kPoints, "sigma_rotation: 0.1", "sigma_rotation: 0", "first_pose.sigma_rotation");
  refused(kPoints, "first_pose", "other_pose", "'first_pose'");
  refused(kSceneLib, "start_camera_position", "start", "'start_camera_position'");
  refused("colour: red\n", "red", "blue", "no target");
}

static void test_target_should_be_refused_when_a_field_is_there_twice_or_misspelled() {
  refused("width: 0.2\nheight: 0.1\n", "height: 0.1\n", "height: 0.1\nheight: 0.2\n", "'height'");
  refused("width: 0.2\nheight: 0.1\n", "height: 0.1\n", "height: 0.1\nsigm: 0.1\n", "'sigma'");
  refused("width: 0.2\nheight: 0.1\n", "height: 0.1\n", "height: 0.1\ndepth: 0.1\n", "'depth'");
  refused(kPoints, "sigma_rotation: 0.1", "sigma_rotaton: 0.1", "first_pose.sigma_rotation");
  refused(kPoints, "sigma_rotation: 0.1", "sigma_rotation: 0.1\n  sigma_rotation: 0.2", "first_pose.sigma_rotation");
  refused(kSceneLib, "features", "sigmas: 1\nfeatures", "'sigma'");
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_rectangle_should_be_read_from_a_file_and_from_text);
  RUN_TEST(test_sigma_in_degrees_should_get_a_note_that_can_be_typed);
  RUN_TEST(test_points_should_be_read_with_their_first_pose);
  RUN_TEST(test_scenelib_camera_should_be_turned_to_right_down_forward);
  RUN_TEST(test_target_should_be_refused_when_a_number_is_nan_or_absurd);
  RUN_TEST(test_target_should_be_refused_when_a_field_is_there_twice_or_misspelled);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
