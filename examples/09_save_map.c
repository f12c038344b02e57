/* A map that is saved and found again.
 *
 * The camera moves past a textured wall, and the map that comes of it is saved into a buffer. A second context begins in that
 * map: it is lost in it until an image shows one of the map's places, and then goes on in the same world, with the same
 * lengths. The program prints how large the map is, in which frame it was found again, and how far the new poses are from those
 * that the first context had for the same images. A program would write the buffer to a file: beside the old one, synced,
 * and renamed. lib/docs/guide/save_a_map.md says more.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 320, HEIGHT = 240, FRAMES = 120, AGAIN_FROM = 60 };

static const double kFocal = 280.0;
static uint8_t pixels[HEIGHT][WIDTH];
static double places[FRAMES][3];

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

/* What a camera at x sees that looks at two walls, 2 and 3 away, of which the nearer one fills the lower half. */
static void draw(double x) {
  int u, v;
  for (v = 0; v < HEIGHT; ++v) {
    for (u = 0; u < WIDTH; ++u) {
      const double depth = v < HEIGHT / 2 ? 3.0 : 2.0;
      pixels[v][u] = (uint8_t)pattern(9.0 * (x + depth * (u - 159.5) / kFocal) + 100.0,
                                      9.0 * depth * (v - 119.5) / kFocal + (v < HEIGHT / 2 ? 100.0 : 300.0));
    }
  }
}

static pf_status_t push(pf_slam_t* slam, int frame) {
  pf_image_t image = {&pixels[0][0], WIDTH, HEIGHT, WIDTH, 0};
  image.t_ns = 1000000000 + (int64_t)frame * 33333333;
  draw(0.01 * frame);
  return pf_push_frame(slam, &image);
}

/* A context in a block of its own, which is given back as well, or null. */
static pf_slam_t* create(void** block) {
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam = NULL;
  void* begin;
  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = WIDTH;
  config.camera.height = HEIGHT;
  config.camera.fx = config.camera.fy = kFocal;
  config.camera.cx = 159.5;
  config.camera.cy = 119.5;
  config.backend = PF_BACKEND_WINDOW;
  config.map.features_in_view = 100;
  config.capacity.max_places = 16; /* the default */
  if (pf_memory_query(&config, &need) != PF_OK) {
    return NULL;
  }
  *block = malloc(need.bytes + need.alignment);
  if (*block == NULL) {
    return NULL;
  }
  begin = (char*)*block + need.alignment - (uintptr_t)*block % need.alignment;
  return pf_create(&config, begin, need.bytes, &slam) == PF_OK ? slam : NULL;
}

int main(void) {
  void *first_block = NULL, *second_block = NULL, *map = NULL;
  size_t bytes = 0, used = 0;
  pf_slam_t *first = create(&first_block), *second = create(&second_block);
  pf_pose_t pose;
  pf_report_t report;
  double worst = 0.0;
  int frame, found = -1;

  if (first == NULL || second == NULL) {
    return 1;
  }
  for (frame = 0; frame < FRAMES; ++frame) {
    if (push(first, frame) < PF_OK || pf_get_pose(first, &pose) < PF_OK) {
      return 1;
    }
    places[frame][0] = pose.p_WC[0];
    places[frame][1] = pose.p_WC[1];
    places[frame][2] = pose.p_WC[2];
  }
  if (pf_map_size(first, PF_MAP_PORTABLE, &bytes) != PF_OK || (map = malloc(bytes)) == NULL ||
      pf_save_map(first, PF_MAP_PORTABLE, map, bytes, &used) != PF_OK) {
    return 1;
  }
  if (pf_load_map(second, map, used) != PF_OK || pf_get_report(second, &report) != PF_OK) {
    return 1;
  }
  printf("a map of %lu kB with %d places\n", (unsigned long)(used / 1000), (int)report.places);
  printf("the second run begins in it: its state is %d, lost, until it finds itself\n", (int)report.state);
  for (frame = AGAIN_FROM; frame < FRAMES; ++frame) {
    const pf_status_t status = push(second, frame);
    if (status < PF_OK || pf_get_pose(second, &pose) < PF_OK) {
      return 1;
    }
    if (status == PF_OK) {
      found = found < 0 ? frame - AGAIN_FROM : found;
      worst = fmax(worst, fabs(pose.p_WC[0] - places[frame][0]) + fabs(pose.p_WC[1] - places[frame][1]) +
                              fabs(pose.p_WC[2] - places[frame][2]));
    }
  }
  if (found < 0) {
    printf("the map was not found again\n");
    return 1;
  }
  printf("found again in frame %d; poses are at most %.3f from those of the first run, in its unit\n", found, worst);
  free(map);
  free(first_block);
  free(second_block);
  return 0;
}
