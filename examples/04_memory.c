/* What a map costs.
 *
 * Capacities are the only fields of the configuration that change the memory, together with the size of the image:
 * the covariance grows with the square of capacity.max_state_dim. This program asks for a few sizes, and shows how a
 * field that is out of its range is named before anything is created.
 */
#include <planefold/planefold.h>
#include <stdio.h>

int main(void) {
  static const struct {
    int32_t width, height, max_features, max_state_dim;
  } sizes[] = {
      {320, 240, 30, 120}, {320, 240, 100, 300}, {640, 480, 100, 300}, {640, 480, 200, 700}, {1280, 720, 400, 1200}};
  pf_config_t config;
  pf_memory_t need;
  const char* field = "";
  size_t i;

  printf("planefold %u.%u.%u\n", (unsigned)(pf_version() >> 16), (unsigned)(pf_version() >> 8 & 255),
         (unsigned)(pf_version() & 255));
  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  for (i = 0; i < sizeof(sizes) / sizeof(sizes[0]); ++i) {
    config.camera.width = sizes[i].width;
    config.camera.height = sizes[i].height;
    config.camera.fx = config.camera.fy = 0.8 * sizes[i].width;
    config.camera.cx = 0.5 * sizes[i].width;
    config.camera.cy = 0.5 * sizes[i].height;
    config.capacity.max_features = sizes[i].max_features;
    config.capacity.max_state_dim = sizes[i].max_state_dim;
    if (pf_memory_query(&config, &need) != PF_OK) {
      return 1;
    }
    printf("%4d x %d, %3d features, %4d states: %6.2f MiB, and %.0f kB of stack\n", (int)sizes[i].width,
           (int)sizes[i].height, (int)sizes[i].max_features, (int)sizes[i].max_state_dim,
           (double)need.bytes / 1048576.0, (double)need.stack_bytes / 1024.0);
  }
  config.capacity.max_features = -3;
  if (pf_config_check(&config, &field) == PF_OK) {
    return 1;
  }
  printf("with -3 features: field '%s' is refused\n", field);
  return 0;
}
