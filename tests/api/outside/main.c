/* Asks the library for its defaults, its memory and a context, and prints what it was told. */
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

int main(void) {
  pf_config_t config;
  pf_memory_t memory;
  pf_slam_t* slam = NULL;
  pf_state_t state;
  void* block;
  if (pf_config_default(&config) != PF_OK) {
    return 1;
  }
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = 320;
  config.camera.height = 240;
  config.camera.fx = config.camera.fy = 200.0;
  config.camera.cx = 159.5;
  config.camera.cy = 119.5;
  if (pf_memory_query(&config, &memory) != PF_OK) {
    return 2;
  }
  block = malloc(memory.bytes + memory.alignment);
  if (block == NULL) {
    return 3;
  }
  {
    char* aligned = (char*)block;
    while ((size_t)aligned % memory.alignment != 0) {
      ++aligned;
    }
    if (pf_create(&config, aligned, memory.bytes, &slam) != PF_OK) {
      return 4;
    }
  }
  if (pf_get_state(slam, &state) != PF_OK || state != PF_STATE_STARTING) {
    return 5;
  }
  if (pf_version() != PF_VERSION) {
    return 6;
  }
  printf("planefold %d.%d.%d scalar %u bytes %lu\n", PF_VERSION_MAJOR, PF_VERSION_MINOR, PF_VERSION_PATCH,
         (unsigned)config.scalar, (unsigned long)memory.bytes);
  free(block);
  return 0;
}
