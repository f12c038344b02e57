/* A mask: what stands still on the picture is not the scene.
 *
 * The lower fifth of these pictures shows the carrier's own body, as on a robot or a car, while the camera turns before a
 * textured surrounding. Points on the body do not move in the picture, however the camera turns, and so contradict the
 * others. pf_set_mask says which pixels are not the scene, by rectangles or with one byte a pixel: nothing is searched or
 * begun there. Room for it is asked for in the config (capacity.mask), one bit for 4x4 pixels. The program turns the camera
 * by 24 degrees, without and with the mask, and prints what is measured on the body and how far the camera has turned.
 * lib/docs/guide/mask.md says what is left out.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 320, HEIGHT = 240, BODY = HEIGHT / 5, FRAMES = 60 };

static const double kFocal = 280.0, kTurn = 24.0 * 3.14159265358979 / 180.0;
static uint8_t pixels[HEIGHT][WIDTH];

/* Grey level of a cell of a pattern, by a hash of its numbers. */
static double grey_of(int i, int j) {
  uint32_t h = (uint32_t)i * 0x9e3779b1u ^ (uint32_t)j * 0x85ebca77u;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  return 40.0 + (double)((h ^ h >> 12) % 176u);
}

/* The pattern between its cells: squares with edges that are a third of a cell wide. */
static double pattern(double u, double v) {
  const int i = (int)floor(u), j = (int)floor(v);
  const double x = fmin(1.0, 3.0 * (u - i)), y = fmin(1.0, 3.0 * (v - j));
  return (1.0 - y) * ((1.0 - x) * grey_of(i - 1, j - 1) + x * grey_of(i, j - 1)) +
         y * ((1.0 - x) * grey_of(i - 1, j) + x * grey_of(i, j));
}

/* What the camera sees after it has turned to the right by an angle: a drum all around it, and the body below. */
static void draw(double angle) {
  int x, y;
  for (y = 0; y < HEIGHT; ++y) {
    for (x = 0; x < WIDTH; ++x) {
      const double rx = (x - 159.5) / kFocal, ry = (y - 119.5) / kFocal;
      const double around = atan2(rx, 1.0) + angle, up = ry / sqrt(1.0 + rx * rx);
      pixels[y][x] = (uint8_t)(y < HEIGHT - BODY ? pattern(24.0 * around + 100.0, 24.0 * up + 100.0)
                                                 : pattern(x / 13.0, y / 11.0));
    }
  }
}

/* Turns the camera once. 0: done. */
static int turn(pf_slam_t* slam, const char* name) {
  pf_match_t matches[60];
  pf_pose_t pose;
  size_t count = 0, k, on_body = 0, all = 0;
  int frame;
  for (frame = 0; frame < FRAMES; ++frame) {
    const pf_image_t image = {&pixels[0][0], WIDTH, HEIGHT, WIDTH, 1000000000 + (int64_t)frame * 33333333};
    draw(kTurn * frame / (FRAMES - 1));
    if (pf_push_frame(slam, &image) < PF_OK || pf_get_pose(slam, &pose) < PF_OK ||
        pf_get_matches(slam, matches, 60, &count) < PF_OK) {
      return 1;
    }
    for (k = 0; k < count && k < 60; ++k) {
      const int measured = matches[k].status == PF_MATCH_INLIER;
      all += (size_t)measured;
      on_body += (size_t)(measured && matches[k].measured_px[1] >= HEIGHT - BODY);
    }
  }
  printf("%s: %lu of %lu matches on the body; the camera has turned by %.2f degrees (24 are right)\n", name,
         (unsigned long)on_body, (unsigned long)all, 360.0 / 3.14159265358979 * acos(fmin(1.0, fabs(pose.q_WC[0]))));
  return 0;
}

int main(void) {
  const pf_rectangle_t body = {0, HEIGHT - BODY, WIDTH, BODY};
  pf_mask_t mask = {0};
  pf_config_t config;
  pf_memory_t without, need;
  pf_slam_t* slam;
  void* block;

  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = WIDTH;
  config.camera.height = HEIGHT;
  config.camera.fx = config.camera.fy = kFocal;
  config.camera.cx = 159.5;
  config.camera.cy = 119.5;
  if (pf_memory_query(&config, &without) != PF_OK) {
    return 1;
  }
  config.capacity.mask = WIDTH * HEIGHT;
  if (pf_memory_query(&config, &need) != PF_OK) {
    return 1;
  }
  printf("the room for a mask takes %lu bytes\n", (unsigned long)(need.bytes - without.bytes));
  block = malloc(need.bytes + need.alignment);
  if (block == NULL ||
      pf_create(&config, (char*)block + (need.alignment - (uintptr_t)block % need.alignment) % need.alignment,
                need.bytes, &slam) != PF_OK) {
    return 1;
  }
  if (turn(slam, "without") != 0 || pf_reset(slam) != PF_OK) {
    return 1;
  }
  mask.width = WIDTH;
  mask.height = HEIGHT;
  mask.rectangles = &body;
  mask.num_rectangles = 1;
  if (pf_set_mask(slam, &mask) != PF_OK || turn(slam, "with a mask") != 0) {
    return 1;
  }
  free(block);
  return 0;
}
