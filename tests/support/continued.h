#pragma once

// A context that goes on from what pf_save_map has written of it, and from nothing else.

#include <planefold/planefold.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "unity.h"

namespace pf {

inline std::vector<std::uint8_t> saved_to_continue(const pf_slam_t* slam) {
  std::size_t bytes = 0, used = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_map_size(slam, PF_MAP_CONTINUE, &bytes));
  std::vector<std::uint8_t> map(bytes);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_save_map(slam, PF_MAP_CONTINUE, map.data(), map.size(), &used));
  TEST_ASSERT_EQUAL_size_t(bytes, used);
  return map;
}

/// In the same block, whose bytes are all overwritten before.
inline void continue_anew(const pf_config_t& config, std::size_t bytes, pf_slam_t* slam) {
  const std::vector<std::uint8_t> map = saved_to_continue(slam);
  void* const block = slam;  // a context is the first that lies in its block
  std::memset(block, 0xa5, bytes);
  pf_slam_t* same = nullptr;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, bytes, &same));
  TEST_ASSERT_EQUAL_PTR(slam, same);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_load_map(slam, map.data(), map.size()));
  TEST_ASSERT_TRUE(saved_to_continue(slam) == map);
}

/// What a frame has changed, as numbers that are compared to the last bit.
inline std::vector<double> numbers_of(const pf_slam_t* slam) {
  std::vector<double> all;
  const auto add = [&](const double* values, std::size_t count) { all.insert(all.end(), values, values + count); };
  pf_pose_t pose;
  if (pf_get_pose(slam, &pose) == PF_OK) {
    add(pose.q_WC, 4), add(pose.p_WC, 3), add(pose.covariance, 36), add(pose.v_W, 3), add(pose.w_C, 3);
    const double id = pose.map_id;
    add(&id, 1);
  }
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
  for (const double value :
       {1.0 * report.state, 1.0 * report.frames, 1.0 * report.attempts, 1.0 * report.inliers, 1.0 * report.state_dim,
        1.0 * report.state_dim_held, 1.0 * report.patches, 1.0 * report.places, 1.0 * report.kept_views,
        1.0 * report.keyframes, report.nis, report.log_odds, report.sigma_info_px, report.correlation_frames})
    all.push_back(value);
  std::vector<pf_feature_t> features(1000);
  std::size_t count = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(slam, features.data(), features.size(), &count));
  for (std::size_t i = 0; i < count; ++i) {
    all.push_back(features[i].id);
    add(features[i].p_W, 3), add(features[i].covariance, 9);
  }
  std::vector<pf_plane_t> planes(64);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_planes(slam, planes.data(), planes.size(), &count));
  for (std::size_t i = 0; i < count; ++i) {
    all.push_back(planes[i].id);
    add(planes[i].p_WP, 3), add(planes[i].R_WP, 9), add(&planes[i].area, 1);
  }
  std::vector<pf_anchor_t> anchors(64);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_anchors(slam, anchors.data(), anchors.size(), &count));
  for (std::size_t i = 0; i < count; ++i) add(anchors[i].p_WA, 3), add(anchors[i].covariance, 36);
  return all;
}

}  // namespace pf
