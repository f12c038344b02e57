/* Three sizes of configuration, from a microcontroller to a desktop.
 *
 * Only the capacities and the image size decide how much memory the library needs. This program fills in three sets of them, asks,
 * and prints a table. Take the one that is nearest to your device, and change it: a state of n rows costs n * n / 2
 * numbers, and a frame's work grows with n * n times the features measured.
 *
 *   tiny      a small picture, 30 features: a microcontroller
 *   handheld  a small picture, 60 features: a phone or a UMPC
 *   room      a larger picture, 200 features in a map that is kept while the camera looks elsewhere
 */
#include <planefold/planefold.h>
#include <stdio.h>

typedef struct profile {
  const char* name;
  int32_t width, height;
  int32_t max_features;     /* in the map */
  int32_t max_state_dim;    /* 13 of the camera, 3 for a point, 6 for one of unknown depth */
  int32_t max_observations; /* measured in one frame */
  int32_t max_planes;
  int32_t max_kept_views; /* to find the map again from elsewhere */
  int32_t max_anchors;
} profile_t;

static const profile_t profiles[] = {
    {"tiny", 320, 240, 30, 112, 20, 4, 0, 0},
    {"handheld", 320, 240, 60, 260, 40, 8, 24, 8},
    {"room", 640, 480, 200, 700, 60, 16, 60, 16},
};

static void fill_in(const profile_t* profile, pf_config_t* config) {
  pf_config_default(config);
  config->camera.model = PF_CAMERA_PINHOLE; /* your calibration goes here */
  config->camera.width = profile->width;
  config->camera.height = profile->height;
  config->camera.fx = config->camera.fy = 0.8 * profile->width;
  config->camera.cx = 0.5 * (profile->width - 1);
  config->camera.cy = 0.5 * (profile->height - 1);
  config->capacity.max_features = profile->max_features;
  config->capacity.max_state_dim = profile->max_state_dim;
  config->capacity.max_observations = profile->max_observations;
  config->capacity.max_planes = profile->max_planes;
  config->capacity.max_kept_views = profile->max_kept_views;
  config->capacity.max_anchors = profile->max_anchors;
  config->map.features_in_view = profile->max_observations;
}

int main(void) {
  size_t i;
  for (i = 0; i < sizeof(profiles) / sizeof(profiles[0]); ++i) {
    pf_config_t config;
    pf_memory_t need;
    const char* field = NULL;
    fill_in(&profiles[i], &config);
    if (pf_config_check(&config, &field) != PF_OK || pf_memory_query(&config, &need) != PF_OK) {
      fprintf(stderr, "%s: %s is out of its range\n", profiles[i].name, field != NULL ? field : "something");
      return 1;
    }
    printf("%-8s  %dx%d, %d features, %d states: block %lu bytes, stack at most %lu bytes, %s\n", profiles[i].name,
           (int)profiles[i].width, (int)profiles[i].height, (int)profiles[i].max_features,
           (int)profiles[i].max_state_dim, (unsigned long)need.bytes, (unsigned long)need.stack_bytes,
           config.scalar == PF_SCALAR_FLOAT ? "float" : "double");
  }
  return 0;
}
