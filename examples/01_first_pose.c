/* The first pose.
 *
 * The shortest way from pixels in memory to a camera pose: a configuration with the camera's calibration, a block of
 * memory of the size that the library asks for, one call per frame, one call for the pose. Here the frames are painted by
 * this program: a wall with random texture, two metres to the left and one metre to the right, seen by a camera that moves
 * sideways. With no known target the scale is arbitrary: lengths are in units of the median depth of the first frame.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 320, HEIGHT = 240, FRAMES = 60 };

/* A random number 0 .. 1 for every cell of an endless grid, the same for the same cell. */
static double cell(int x, int y) {
  uint32_t h = (uint32_t)x * 374761393u + (uint32_t)y * 668265263u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return (double)((h ^ (h >> 16)) & 0xffffu) / 65535.0;
}

/* The grid with its values blended from cell to cell. */
static double texture(double x, double y) {
  const double fx = floor(x), fy = floor(y), u = x - fx, v = y - fy;
  const int i = (int)fx, j = (int)fy;
  return (1 - v) * ((1 - u) * cell(i, j) + u * cell(i + 1, j)) +
         v * ((1 - u) * cell(i, j + 1) + u * cell(i + 1, j + 1));
}

static void paint(const pf_camera_t* camera, double camera_x, uint8_t* pixels) {
  int u, v;
  for (v = 0; v < HEIGHT; ++v) {
    for (u = 0; u < WIDTH; ++u) {
      const double x = (u - camera->cx) / camera->fx, y = (v - camera->cy) / camera->fy;
      const double depth = camera_x + x > 0.0 ? 1.0 : 2.0; /* near on the right of the world's middle */
      const double level = texture(20.0 * (camera_x + depth * x) + 500.0 * depth, 20.0 * depth * y);
      pixels[v * WIDTH + u] = (uint8_t)(30.0 + 190.0 * level);
    }
  }
}

int main(void) {
  static uint8_t pixels[WIDTH * HEIGHT];
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam;
  pf_pose_t pose;
  pf_image_t image = {pixels, WIDTH, HEIGHT, WIDTH, 0};
  pf_status_t status = PF_OK;
  void* block;
  int frame;

  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = WIDTH;
  config.camera.height = HEIGHT;
  config.camera.fx = config.camera.fy = 260.0;
  config.camera.cx = 159.5;
  config.camera.cy = 119.5;

  if (pf_memory_query(&config, &need) != PF_OK) {
    return 1;
  }
  block = malloc(need.bytes + need.alignment);
  if (block == NULL) {
    return 1;
  }
  /* The block must begin at a multiple of need.alignment; malloc promises less. */
  if (pf_create(&config, (char*)block + (need.alignment - (uintptr_t)block % need.alignment) % need.alignment,
                need.bytes, &slam) != PF_OK) {
    return 1;
  }
  for (frame = 0; frame < FRAMES; ++frame) {
    paint(&config.camera, 0.008 * frame, pixels);
    image.t_ns = (int64_t)frame * 33333333;
    status = pf_push_frame(slam, &image);
    if (status < 0) {
      fprintf(stderr, "frame %d: %s\n", frame, pf_status_text(status));
      return 1;
    }
    if (frame % 10 == 9 && pf_get_pose(slam, &pose) == PF_OK) {
      printf("frame %2d  position %7.4f %7.4f %7.4f  (%s)\n", frame, pose.p_WC[0], pose.p_WC[1], pose.p_WC[2],
             pf_status_text(status));
    }
  }
  free(block);
  return status == PF_OK ? 0 : 1;
}
