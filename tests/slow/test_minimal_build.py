"""A library without its optional parts refuses a config that asks for them, naming field and option, tracks as ever, and is smaller."""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402
import sizes  # noqa: E402

PARTS = ("WINDOW", "INERTIAL", "WALLS", "MASKS")
PROGRAM = r"""
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static pf_config_t config;

static void names(const char* field) {
  const char* bad = NULL;
  const pf_status_t status = pf_config_check(&config, &bad);
  if (status != PF_ERROR_CONFIG || bad == NULL || strcmp(bad, field) != 0) {
    printf("%s: %d %s\n", field, (int)status, bad == NULL ? "-" : bad);
    exit(1);
  }
}

int main(void) {
  static uint8_t pixels[240][320];
  pf_config_default(&config);
  config.camera = (pf_camera_t){.model = PF_CAMERA_PINHOLE, .width = 320, .height = 240, .fx = 280, .fy = 280, .cx = 159.5, .cy = 119.5};
  const pf_config_t good = config;
  config.backend = PF_BACKEND_WINDOW, names("backend (built without PLANEFOLD_WINDOW)"), config = good;
  config.motion.model = PF_MOTION_INERTIAL, names("motion.model (built without PLANEFOLD_INERTIAL)"), config = good;
  config.capacity.max_patches = 1, names("capacity.max_patches (built without PLANEFOLD_WALLS)"), config = good;
  config.map.masks = PF_MASKS_PARTIAL, names("map.masks (built without PLANEFOLD_MASKS)"), config = good;
  pf_memory_t need;
  pf_slam_t* slam;
  if (pf_memory_query(&config, &need) != PF_OK) return 2;
  if (pf_create(&config, aligned_alloc(need.alignment, (need.bytes + need.alignment - 1) / need.alignment * need.alignment), need.bytes, &slam) != PF_OK) return 3;
  const double origin_covariance[36] = {1e-6, 0, 0, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0, 0, 0, 1e-6};
  pf_pose_t pose = {.q_WC = {1}};
  memcpy(pose.covariance, origin_covariance, sizeof pose.covariance);
  if (pf_start_from_pose(slam, &pose, origin_covariance) != PF_OK) return 4;
  pf_wall_prior_t wall = {.R_WP = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .covariance = {1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4}, .outline_count = 4,
                          .outline_P = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  uint32_t id;
  if (pf_add_wall(slam, &wall, &id) != PF_ERROR_STATE) return 5;
  for (int i = 0; i < 20; ++i) {
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x) pixels[y][x] = (uint8_t)(((x + i) / 11 * 37 + y / 13 * 91) % 255);
    const pf_image_t image = {&pixels[0][0], 320, 240, 320, 1 + 33333333LL * i};
    if (pf_push_frame(slam, &image) < 0) return 6;
  }
  return 0;
}
"""

script.skip_unless_plain_native_build()
with tempfile.TemporaryDirectory(prefix="planefold_") as name:
    folder = pathlib.Path(name)
    script.run("cmake", "-S", script.SOURCE, "-B", folder / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DPLANEFOLD_UNITY=ON",
               "-DPLANEFOLD_BUILD_TESTS=OFF", "-DPLANEFOLD_BUILD_PROGRAMS=OFF", *(f"-DPLANEFOLD_{part}=OFF" for part in PARTS))
    script.run("cmake", "--build", folder / "build", "--target", "planefold")
    archive = folder / "build/lib/libplanefold.a"
    (folder / "program.c").write_text(PROGRAM)
    script.run(script.c_compiler(), "-std=c11", "-I", script.SOURCE / "lib/include", folder / "program.c", archive, "-lm", "-o", folder / "program")
    script.run(folder / "program")
    minimal, full = (sizes.of_archive("size", file)["text"] for file in (archive, script.BUILD / "lib/libplanefold.a"))
    print(f"text: {minimal} bytes without the parts, {full} with them")
    if minimal > 0.7 * full:
        script.fail(f"{minimal} bytes of text are more than 0.7 of {full}: parts that are left out are still in the archive")
