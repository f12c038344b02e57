// The walls file: what it says about walls and faces, and what it refuses, in one line that names the file, the wall and the field.
#include "skip.h"

#if __has_include(<planefold_platform/walls.h>)

#include <planefold_platform/walls.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <string>

#include "unity.h"

void setUp() {}
void tearDown() {}

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

const char* const kPlan = R"({"planefold_walls": 1, "up": [0, 0, 2],
"walls": [{"name": "north", "from": [0, 4], "to": [6, 4], "base": 0.5, "height": 3, "seen_from": "right",
           "sigma_rotation_deg": 2, "sigma_vertical_deg": 1, "sigma_offset_m": 0.1, "roughness_m": 0.02}],
"faces": [{"name": "board", "corners": [[0, 0, 1], [1, 0, 1], [1, 2, 1], [0, 2, 1]], "seen_from": "both",
           "sigma_rotation_deg": 3, "sigma_vertical_deg": 4, "sigma_offset_m": 0.05}]})";

pf_walls_t walls;
char message[PF_WALLS_MESSAGE];

int parse(const std::string& text) { return pf_parse_walls(text.data(), text.size(), "plan.json", &walls, message); }

void require_one_line(const std::string& what) {
  TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(message, "plan.json"), what.c_str());
  TEST_ASSERT_NULL_MESSAGE(std::strchr(message, '\n'), what.c_str());
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, walls.count, what.c_str());
}

/// With `from` replaced by `to`, the plan is refused, and the message has all the parts.
void refused(const std::string& from, const std::string& to, std::initializer_list<const char*> parts) {
  std::string text = kPlan;
  const size_t at = text.find(from);
  TEST_ASSERT_TRUE_MESSAGE(at != std::string::npos, from.c_str());
  text.replace(at, from.size(), to);
  TEST_ASSERT_EQUAL_INT_MESSAGE(-1, parse(text), text.c_str());
  std::printf("%s\n", message);
  require_one_line(to);
  for (const char* part : parts) TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(message, part), part);
}

void test_walls_and_faces_should_become_priors_at_their_own_centre() {
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, parse(kPlan), message);
  TEST_ASSERT_EQUAL_INT(2, walls.count);
  TEST_ASSERT_EQUAL_INT(1, walls.has_up);
  TEST_ASSERT_EQUAL_DOUBLE(1, walls.up_W[2]);
  const pf_wall_prior_t& north = walls.wall[0].prior;
  TEST_ASSERT_EQUAL_STRING("north", walls.wall[0].name);
  const double centre[3] = {3, 4, 2}, normal[3] = {0, -1, 0}, up[3] = {0, 0, 1};
  for (int i = 0; i < 3; ++i) {
    TEST_ASSERT_EQUAL_DOUBLE(centre[i], north.p_WP[i]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, normal[i], north.R_WP[3 * i + 2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, up[i], north.R_WP[3 * i + 1]);
  }
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 4 * kDegree * kDegree, north.covariance[0]);  // alpha rotates about up
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, kDegree * kDegree, north.covariance[4]);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.01, north.covariance[8]);
  TEST_ASSERT_EQUAL_DOUBLE(0.02, north.roughness);
  TEST_ASSERT_EQUAL_UINT32(0, north.two_sided);
  TEST_ASSERT_EQUAL_INT(4, north.outline_count);
  TEST_ASSERT_EQUAL_DOUBLE(-3, north.outline_P[0][0]);
  TEST_ASSERT_EQUAL_DOUBLE(-1.5, north.outline_P[0][1]);

  const pf_wall_prior_t& board = walls.wall[1].prior;
  const double middle[3] = {0.5, 1, 1};
  for (int i = 0; i < 3; ++i) {
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, middle[i], board.p_WP[i]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, up[i], board.R_WP[3 * i + 2]);
  }
  TEST_ASSERT_EQUAL_DOUBLE(0, board.roughness);
  TEST_ASSERT_EQUAL_UINT32(1, board.two_sided);
  for (int k = 0; k < 4; ++k) {  // back in W, the corners of the file
    const double corners[4][3] = {{0, 0, 1}, {1, 0, 1}, {1, 2, 1}, {0, 2, 1}};
    for (int i = 0; i < 3; ++i) {
      const double x =
          board.p_WP[i] + board.R_WP[3 * i] * board.outline_P[k][0] + board.R_WP[3 * i + 1] * board.outline_P[k][1];
      TEST_ASSERT_DOUBLE_WITHIN(1e-12, corners[k][i], x);
    }
  }
}

/// What the reader accepts, the library accepts: a rotation, a covariance and an outline that hold.
void test_priors_from_a_file_should_be_added() {
  pf_config_t config;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  const pf_camera_t camera = {PF_CAMERA_PINHOLE,  640, 480, 400, 400, 319.5, 239.5, {}, 0, PF_CAMERA_EXACT,
                              PF_TIMESTAMPS_REAL, 0,   0,   0,   {}};
  config.camera = camera;
  pf_memory_t need;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  std::string raw(need.bytes + need.alignment, '\0');
  void* block = raw.data();
  size_t space = raw.size();
  TEST_ASSERT_NOT_NULL(std::align(need.alignment, need.bytes, block, space));
  pf_slam_t* slam = nullptr;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
  pf_pose_t pose = {};
  pose.q_WC[0] = 1;
  double velocity[36] = {};
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = velocity[7 * i] = 1e-2;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &pose, velocity));
  TEST_ASSERT_EQUAL_INT(0, parse(kPlan));
  for (int i = 0; i < walls.count; ++i) {
    uint32_t id = 0;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &walls.wall[i].prior, &id));
    TEST_ASSERT_TRUE(id > 0);
  }
}

void test_wrong_fields_should_be_named() {
  refused("\"planefold_walls\": 1", "\"planefold_walls\": 2", {"'planefold_walls'", "must be 1"});
  refused("\"height\": 3, ", "", {"wall 'north'", "'height'", "missing"});
  refused("\"height\": 3", "\"hight\": 3, \"height\": 3", {"wall 'north'", "'hight'"});
  refused("\"height\": 3", "\"height\": NaN", {"wall 'north'", "'height'", "JSON"});
  refused("\"height\": 3", "\"height\": 1e999", {"wall 'north'", "'height'"});
  refused("\"height\": 3", "\"height\": \"tall\"", {"wall 'north'", "'height'", "number"});
  refused("\"height\": 3", "\"height\": -3", {"wall 'north'", "'height'", "more than 0"});
  refused("\"height\": 3", "\"height\": 3, \"height\": 4", {"wall 'north'", "'height'", "twice"});
  refused("[6, 4]", "[0, 4]", {"wall 'north'", "'to'", "no length"});
  refused("[6, 4]", "[6e9, 4]", {"wall 'north'", "'to'", "metre"});
  refused("[6, 4]", "[6, 4, 0]", {"wall 'north'", "'to'", "2 numbers"});
  refused("\"right\"", "\"outside\"", {"wall 'north'", "'seen_from'", "left, right, both"});
  refused("\"sigma_offset_m\": 0.1", "\"sigma_offset_m\": 0", {"wall 'north'", "'sigma_offset_m'"});
  refused("\"sigma_rotation_deg\": 2", "\"sigma_rotation_deg\": 200", {"wall 'north'", "'sigma_rotation_deg'"});
  refused("[0, 0, 2]", "[0, 0, 0]", {"'up'", "direction"});
  refused("[0, 0, 2]", "[0, 1, 0]", {"wall 'north'", "'from'", "face"});
  refused("\"board\"", "\"north\"", {"face 'north'", "'name'", "another"});
  refused("\"name\": \"north\", ", "", {"wall 1", "'name'", "missing"});
  refused("\"name\": \"north\"", "\"name\": \"a\\nb\"", {"'name'", "control"});
  refused("[1, 2, 1]", "[1, 2, 1.5]", {"face 'board'", "'corners'", "off it by more"});
  refused("[1, 2, 1], [0, 2, 1]", "[0.2, 2, 1], [0.9, 2.5, 1]", {"face 'board'", "'corners'", "convex"});
  refused("[1, 2, 1], [0, 2, 1]", "[0, 2, 1], [1, 2, 1]", {"face 'board'", "'corners'", "no area"});
  refused("[1, 2, 1]", "[0.2, 0.2, 1]", {"face 'board'", "'corners'", "convex"});
  refused("[1, 2, 1], [0, 2, 1]", "[2, 0, 1], [3, 0, 1]", {"face 'board'", "'corners'", "no area"});
  refused("[1, 2, 1], [0, 2, 1]", "[1, 2, 1], [0, 2]", {"face 'board'", "'corners'", "3 numbers"});
}

void test_files_that_are_no_plan_should_be_refused() {
  for (const char* text : {"", "{", "[]", "7", "null", "{}", "{\"planefold_walls\": 1}", "\xff\xfe",
                           "{\"planefold_walls\": 1, \"walls\": 3}", "{\"planefold_walls\": 1, \"walls\": [3]}",
                           "{\"planefold_walls\": 1, \"walls\": [], \"faces\": []}"}) {
    TEST_ASSERT_EQUAL_INT_MESSAGE(-1, parse(text), text);
    std::printf("%s\n", message);
    require_one_line(text);
  }
  std::string deep = "{\"planefold_walls\": ";
  for (int i = 0; i < 100000; ++i) deep += "[";
  TEST_ASSERT_EQUAL_INT(-1, parse(deep));
  require_one_line("deep");
  std::string many = "{\"planefold_walls\": 1, \"walls\": [";
  for (int i = 0; i < 10000; ++i)
    many +=
        std::string(i > 0 ? "," : "") + R"({"name": "w)" + std::to_string(i) +
        R"(", "from": [0, 0], "to": [1, 0], "base": 0, "height": 1, "seen_from": "left", "sigma_rotation_deg": 1,)" +
        R"("sigma_vertical_deg": 1, "sigma_offset_m": 1})";
  TEST_ASSERT_EQUAL_INT(-1, parse(many + "]}"));
  std::printf("%s\n", message);
  require_one_line("many");
  TEST_ASSERT_NOT_NULL(std::strstr(message, "10000"));
}

/// Damaged files: a plan or one line, whatever was changed.
void test_a_damaged_plan_should_be_a_plan_or_one_line() {
  const std::string plan = kPlan;
  std::uint64_t state = 41;
  const auto draw = [&](size_t limit) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<size_t>(state >> 33) % limit;
  };
  std::printf("seed %d\n", 41);
  const std::string pieces = "[]{},:\"0123456789.-+eE \\nul\x01\x80";
  int accepted = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text = plan;
    for (size_t k = 0, edits = 1 + draw(3); k < edits && !text.empty(); ++k) {
      const size_t at = draw(text.size());
      switch (draw(4)) {
        case 0:
          text.erase(at, 1 + draw(20));
          break;
        case 1:
          text[at] = pieces[draw(pieces.size())];
          break;
        case 2:
          text.insert(at, plan.substr(draw(plan.size()), 1 + draw(40)));
          break;
        default:
          text.resize(at + 1);
      }
    }
    if (parse(text) != 0) {
      require_one_line(text);
      continue;
    }
    ++accepted;
    TEST_ASSERT_TRUE(walls.count > 0 && walls.count <= PF_WALLS_MAX);
    for (int i = 0; i < walls.count; ++i) {
      const pf_wall_prior_t& prior = walls.wall[i].prior;
      for (const double x : prior.R_WP) TEST_ASSERT_TRUE(std::fabs(x) <= 1 + 1e-12);
      for (int k = 0; k < 9; k += 4) TEST_ASSERT_TRUE(prior.covariance[k] > 0);
      TEST_ASSERT_TRUE(prior.outline_count >= 3 && prior.outline_count <= PF_OUTLINE_MAX);
    }
  }
  std::printf("%d of 20000 damaged plans are plans\n", accepted);
  TEST_ASSERT_TRUE(accepted > 100 && accepted < 20000);
}

void test_a_missing_file_should_be_named() {
  TEST_ASSERT_EQUAL_INT(-1, pf_read_walls("/nowhere/plan.json", &walls, message));
  require_one_line("missing");
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_walls_and_faces_should_become_priors_at_their_own_centre);
  RUN_TEST(test_priors_from_a_file_should_be_added);
  RUN_TEST(test_wrong_fields_should_be_named);
  RUN_TEST(test_files_that_are_no_plan_should_be_refused);
  RUN_TEST(test_a_damaged_plan_should_be_a_plan_or_one_line);
  RUN_TEST(test_a_missing_file_should_be_named);
  return UNITY_END();
}

#else

int main() { SKIP_PROGRAM("this build has no platform layer"); }

#endif
