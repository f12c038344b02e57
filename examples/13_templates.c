/* Templates with masks: which pixels around a feature belong to the plane that it lies on.
 *
 * A feature is found again by the pixels around it. At the edge of a surface some of these belong to what is behind it, and
 * move differently when the camera moves. With map.masks each feature learns how likely each pixel of its template is to lie
 * on its dominant plane, and how that plane is turned; what does not lie on it counts no more when the feature is matched.
 * The program draws a board with holes before a wall, moves the camera sideways, and prints what pf_report_t says of all
 * templates, and the template of one feature at an edge: its pixels, and its mask, # on the plane and . beside it.
 * lib/docs/theory/templates.md says how a mask learns, and lib/docs/theory/masoud2015.md where this comes from.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 320, HEIGHT = 240, FRAMES = 150, MAX_FEATURES = 100, MIN_FRAMES = 10 };

static const double kFocal = 280.0, kBoard = 1.6, kWall = 3.2, kHole = 0.36;
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

/* The board is a checkerboard whose dark squares are holes, through which the wall is seen. */
static int is_hole(double x, double y) { return ((int)floor(x / kHole) + (int)floor(y / kHole)) % 2 != 0; }

static void draw(double t) {
  const double camera_W[3] = {0.4 * sin(0.9 * t), 0.15 * sin(1.4 * t), 0.1 * (1.0 - cos(0.8 * t))};
  int x, y;
  for (y = 0; y < HEIGHT; ++y) {
    for (x = 0; x < WIDTH; ++x) {
      const double rx = (x - 159.5) / kFocal, ry = (y - 119.5) / kFocal, near = kBoard - camera_W[2];
      const double u = camera_W[0] + near * rx, v = camera_W[1] + near * ry;
      const double far = kWall - camera_W[2];
      pixels[y][x] =
          (uint8_t)(is_hole(u, v) ? pattern(7.0 * (camera_W[0] + far * rx), 7.0 * (camera_W[1] + far * ry) + 300.0)
                                  : pattern(14.0 * u + 100.0, 14.0 * v + 100.0));
    }
  }
}

/* Share of a template's pixels that are more likely than not on its dominant plane. */
static double area_of(const pf_template_t* of) {
  int i, count = 0;
  for (i = 0; i < of->side * of->side; ++i) {
    count += of->mask[i] > 127;
  }
  return (double)count / (of->side * of->side);
}

static void show(const pf_template_t* of) {
  static const char shade[] = " .:-=+*%@";
  int row, column;
  printf("feature %u after %d frames:\n", of->feature, of->frames);
  for (row = 0; row < of->side; ++row) {
    printf("  ");
    for (column = 0; column < of->side; ++column) {
      putchar(shade[of->grey[row * of->side + column] * 8 / 255]);
    }
    printf("   ");
    for (column = 0; column < of->side; ++column) {
      putchar(of->mask[row * of->side + column] > 127 ? '#' : '.');
    }
    printf("\n");
  }
}

int main(void) {
  static pf_feature_t features[MAX_FEATURES];
  pf_template_t one, best = {0};
  pf_config_t config;
  pf_memory_t without, need;
  pf_report_t report;
  pf_state_t state = PF_STATE_STARTING;
  pf_slam_t* slam;
  double area = 0.0;
  size_t count = 0, k;
  int frame, learning = 0, at_edges = 0, known = 0;
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
  config.map.masks = PF_MASKS_PARTIAL;
  if (pf_memory_query(&config, &need) != PF_OK) {
    return 1;
  }
  printf("templates take %lu bytes\n", (unsigned long)(need.bytes - without.bytes));
  block = malloc(need.bytes + need.alignment);
  if (block == NULL ||
      pf_create(&config, (char*)block + (need.alignment - (uintptr_t)block % need.alignment) % need.alignment,
                need.bytes, &slam) != PF_OK) {
    return 1;
  }
  for (frame = 0; frame < FRAMES; ++frame) {
    const double t = frame / 30.0;
    const pf_image_t image = {&pixels[0][0], WIDTH, HEIGHT, WIDTH, 1000000000 + (int64_t)(1e9 * t)};
    draw(t);
    if (pf_push_frame(slam, &image) < PF_OK || pf_get_report(slam, &report) < PF_OK) {
      return 1;
    }
    if (report.templates > 0) {
      area += report.template_area;
      ++learning;
    }
  }
  if (pf_get_state(slam, &state) != PF_OK || state != PF_STATE_TRACKING || learning == 0 ||
      pf_get_features(slam, features, MAX_FEATURES, &count) < PF_OK) {
    return 1;
  }
  printf("in %d of %d frames templates learnt; %.0f %% of their pixels are on their planes\n", learning, FRAMES,
         100.0 * area / learning);
  for (k = 0; k < count && k < MAX_FEATURES; ++k) {
    if (pf_get_template(slam, features[k].id, &one) != PF_OK || one.frames < MIN_FRAMES) {
      continue;
    }
    ++known;
    at_edges += area_of(&one) < 0.9;
    if (best.frames == 0 || fabs(area_of(&one) - 0.5) < fabs(area_of(&best) - 0.5)) {
      best = one;
    }
  }
  printf(
      "%d of %d templates that have learnt from at least %d frames have more than a tenth of their pixels elsewhere\n",
      at_edges, known, MIN_FRAMES);
  if (best.frames == 0) {
    return 1;
  }
  show(&best);
  free(block);
  return at_edges > 0 ? 0 : 1;
}
