#pragma once

#include "api/context.h"
#include "filter_slam/planes/plane_keeper.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/test_cameras.h"

namespace pf {

/// Planes and features of a camera at the origin, without what finds them in images.
struct PlaneKeeperBench {
  Settings settings;
  TestFilter filter{true};
  Map map;
  Frame frame;
  FeatureKeeper features{settings, *filter, map, frame};
  PlaneKeeper planes{settings, *filter, map, frame, features};
  TestArena arena;

  PlaneKeeperBench() {
    pf_config_t config;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
    config.camera = {PF_CAMERA_PINHOLE,  640, 480, 525, 525, 320, 240, {0}, 0, PF_CAMERA_EXACT,
                     PF_TIMESTAMPS_REAL, 0,   0,   0,   {0}};
    TEST_ASSERT_SAME(Status::kOk, settings_from(config, &settings, nullptr));
    TEST_ASSERT_TRUE(map.layout(*arena, 40, 4, 0, 8));
    TEST_ASSERT_TRUE(frame.layout(*arena, 80));
    TEST_ASSERT_TRUE(features.layout(*arena, 40));
    TEST_ASSERT_TRUE(planes.layout(*arena, 40));
    map.init();
    frame.init();
    planes.init();
    filter->set_lens(settings.camera, LensPrior());
    filter->set_mean(Body());
  }
};

}  // namespace pf
