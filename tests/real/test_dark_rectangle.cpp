// The dark rectangle of the desk sequence, found in every frame by itself and compared with its measured corners.
#include <planefold_platform/sequence.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "support/skip.h"
#include "track/quad_refine.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

std::string folder;

struct Row {
  int frame;
  double corners[8];
};

std::vector<Row> read_corners() {
  std::vector<Row> rows;
  std::FILE* file = std::fopen((folder + "/target_corners.csv").c_str(), "r");
  TEST_ASSERT_NOT_NULL(file);
  char line[400];
  while (std::fgets(line, sizeof line, file) != nullptr) {
    Row row;
    double t, *c = row.corners;
    if (std::sscanf(line, "%d,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &row.frame, &t, &c[0], &c[1], &c[2], &c[3], &c[4],
                    &c[5], &c[6], &c[7]) == 10) {
      rows.push_back(row);
    }
  }
  std::fclose(file);
  return rows;
}

Camera camera_of(const pf_camera_t& c) {
  const double intrinsics[4] = {c.fx, c.fy, c.cx, c.cy};
  Camera camera;
  TEST_ASSERT_NULL(make_camera(c.model, c.width, c.height, intrinsics, c.distortion, &camera));
  return camera;
}

/// Root mean square of the pixel coordinates' distance from the measured corners.
double corner_rms(const Row& row, const Quad& quad) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const double u = static_cast<double>(quad.corners[i].x()) - row.corners[2 * i];
    const double v = static_cast<double>(quad.corners[i].y()) - row.corners[2 * i + 1];
    sum += u * u + v * v;
  }
  return std::sqrt(sum / 8);
}

void test_rectangle_should_be_found_where_it_was_measured_when_the_desk_is_filmed() {
  char message[PF_SEQUENCE_MESSAGE];
  pf_sequence_t* sequence;
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_open_sequence(("images:" + folder).c_str(), nullptr, &sequence, message),
                                message);
  pf_sequence_info_t info;
  pf_get_sequence_info(sequence, &info);
  const Camera camera = camera_of(info.camera);
  const std::vector<Row> rows = read_corners();

  std::vector<unsigned char> block(1 << 20);
  Arena arena(block.data(), block.size());
  const QuadWorkspace workspace = take_quad_workspace(&arena, camera.width, camera.height);
  TEST_ASSERT_TRUE(arena.ok());

  std::size_t next = 0;
  int found = 0, measured = 0, wrong = 0, ambiguous = 0, candidates = 0;
  double sum = 0, worst = 0, worst_pose = 0;
  for (int64_t i = 0; i < info.count; ++i) {
    pf_image_t image;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_read_sequence_frame(sequence, i, &image, message), message);
    const ImageView view = {image.pixels, image.width, image.height, image.stride};
    Quad quads[16];
    candidates += find_dark_quads(view, workspace, quads, 16);
    RectangleSighting seen;
    const bool ok = find_dark_rectangle(view, camera, Scalar(0.1832), Scalar(0.1295), Scalar(0.2), workspace, &seen);
    const Row* row = next < rows.size() && rows[next].frame == i ? &rows[next++] : nullptr;
    if (ok) ++found;
    if (row == nullptr) continue;
    ++measured;
    if (!ok) {
      std::printf("frame %d: not found\n", row->frame);
      continue;
    }
    const double rms = corner_rms(*row, seen.quad);
    if (rms > 3) {
      ++wrong;
      std::printf("frame %d: another place, %.1f px away\n", row->frame, rms);
      continue;
    }
    if (rms > 0.6)
      std::printf("frame %d: %.2f px, sides %.2f px\n", row->frame, rms, static_cast<double>(seen.quad.rms_px));
    sum += rms * rms;
    worst = std::fmax(worst, rms);
    worst_pose = std::fmax(worst_pose, static_cast<double>(seen.pose.rms_px));
    if (seen.second_rms_px < Scalar(0.4)) ++ambiguous;
  }
  pf_close_sequence(sequence);
  const int good = measured - wrong;
  const double rms = std::sqrt(sum / good);
  std::printf(
      "found in %d of %d frames, %d of them elsewhere; corners %.3f px RMS, worst frame %.2f px;\n"
      "pose explains them within %.2f px; two poses possible in %d frames; %.2f quadrilaterals a frame\n",
      found, static_cast<int>(info.count), wrong, rms, worst, worst_pose, ambiguous,
      static_cast<double>(candidates) / static_cast<double>(info.count));
  TEST_ASSERT_EQUAL_INT(0, wrong);
  TEST_ASSERT_EQUAL_INT(400, found);
  TEST_ASSERT_TRUE(rms < 0.2);
}

}  // namespace

int main() {
  const char* data = std::getenv("PLANEFOLD_DATA");
  if (data == nullptr) SKIP_PROGRAM("PLANEFOLD_DATA is not set");
  folder = std::string(data) + "/monoslam_desk_a";
  UNITY_BEGIN();
  RUN_TEST(test_rectangle_should_be_found_where_it_was_measured_when_the_desk_is_filmed);
  return UNITY_END();
}
