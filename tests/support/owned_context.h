// A context of the library in a block of its own, for tests that push observations.
#ifndef PLANEFOLD_TESTS_OWNED_CONTEXT_H
#define PLANEFOLD_TESTS_OWNED_CONTEXT_H

#include <planefold/planefold.h>

#include <cstdint>
#include <vector>

#include "unity.h"

/// The default settings, with a pinhole of 320x240.
inline pf_config_t pinhole_config() {
  pf_config_t config;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = 320;
  config.camera.height = 240;
  config.camera.fx = config.camera.fy = 280;
  config.camera.cx = 159.5;
  config.camera.cy = 119.5;
  return config;
}

struct OwnedContext {
  std::vector<unsigned char> block;
  pf_slam_t* slam = nullptr;

  explicit OwnedContext(const pf_config_t& config) {
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
    block.resize(need.bytes + need.alignment);
    unsigned char* begin = block.data() + need.alignment - reinterpret_cast<uintptr_t>(block.data()) % need.alignment;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, begin, need.bytes, &slam));
  }
  OwnedContext(const OwnedContext&) = delete;
};

#endif
