/* Anchors: something that stays where it was put while the map is corrected.
 *
 * The camera moves past two textured walls. As soon as a plane is found in the middle of the picture, an anchor is set there: where
 * the ray of that pixel meets the plane. The program then goes on, and says in which pixel the anchor is and how sure that is, and
 * how far it has been moved by what was learnt since. A label or a model would be drawn at q_WA and p_WA, whose third axis is the
 * plane's normal. Then the lens is covered for half a second: the anchor is still there when the camera is found again.
 * lib/docs/guide/anchors.md says more.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 320, HEIGHT = 240, FRAMES = 160, COVERED_FROM = 100, COVERED_TO = 115 };

static const double kFocal = 280.0;
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
  if (frame >= COVERED_FROM && frame < COVERED_TO) {
    memset(pixels, 0, sizeof pixels);
  }
  return pf_push_frame(slam, &image);
}

/* Sets an anchor on the plane in the middle of the lower half. 0: there is none yet. */
static uint32_t set_anchor(pf_slam_t* slam) {
  const double pixel[2] = {WIDTH / 2.0, 0.75 * HEIGHT};
  pf_hit_t hit;
  uint32_t id = 0;
  return pf_hit_test(slam, pixel, &hit) == PF_OK && pf_add_anchor_hit(slam, &hit, &id) == PF_OK ? id : 0;
}

static void tell(const pf_slam_t* slam, int frame, uint32_t id) {
  pf_anchor_t anchor;
  double pixel[2];
  if (pf_get_anchor(slam, id, &anchor) != PF_OK || pf_project_point(slam, anchor.p_WA, pixel, NULL) != PF_OK) {
    return;
  }
  printf("frame %3d: anchor %u on plane %u, at %.3f %.3f %.3f, sigma %.4f along z, in pixel %.1f %.1f\n", frame,
         (unsigned)anchor.id, (unsigned)anchor.plane, anchor.p_WA[0], anchor.p_WA[1], anchor.p_WA[2],
         sqrt(anchor.covariance[35]), pixel[0], pixel[1]);
}

int main(void) {
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam = NULL;
  void *block, *begin;
  uint32_t id = 0, start = 0;
  pf_pose_t pose;
  pf_anchor_t anchor;
  pf_state_t state;
  int frame;

  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = WIDTH;
  config.camera.height = HEIGHT;
  config.camera.fx = config.camera.fy = kFocal;
  config.camera.cx = 159.5;
  config.camera.cy = 119.5;
  config.capacity.max_anchors = 8; /* the default */
  if (pf_memory_query(&config, &need) != PF_OK || (block = malloc(need.bytes + need.alignment)) == NULL) {
    return 1;
  }
  begin = (char*)block + need.alignment - (uintptr_t)block % need.alignment;
  if (pf_create(&config, begin, need.bytes, &slam) != PF_OK) {
    return 1;
  }
  for (frame = 0; frame < FRAMES; ++frame) {
    if (push(slam, frame) < PF_OK || pf_get_state(slam, &state) < PF_OK) {
      return 1;
    }
    if (id == 0 && state == PF_STATE_TRACKING && (id = set_anchor(slam)) != 0) {
      tell(slam, frame, id);
    }
    /* One where the camera is now, to come back to. */
    if (start == 0 && state == PF_STATE_TRACKING &&
        (pf_get_pose(slam, &pose) != PF_OK || pf_add_anchor_pose(slam, &pose, &start) != PF_OK)) {
      return 1;
    }
    if (id != 0 && frame % 20 == 0) {
      tell(slam, frame, id);
    }
  }
  if (id == 0) {
    printf("no plane was found\n");
    return 1;
  }
  tell(slam, FRAMES - 1, id);
  if (pf_get_anchor(slam, start, &anchor) != PF_OK || pf_get_pose(slam, &pose) != PF_OK) {
    return 1;
  }
  printf("the camera is %.3f from where tracking began\n",
         sqrt(pow(pose.p_WC[0] - anchor.p_WA[0], 2) + pow(pose.p_WC[1] - anchor.p_WA[1], 2) +
              pow(pose.p_WC[2] - anchor.p_WA[2], 2)));
  printf("removed: %s\n", pf_status_text(pf_remove_anchor(slam, id)));
  free(block);
  return 0;
}
