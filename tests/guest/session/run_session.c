/* Runs a recorded session of observations and writes where the camera was, on any machine that has a C compiler.
 *
 * The session is what session.py writes: a head, then per frame its time and its observations. The result has one
 * record per frame. All memory is static; BLOCK_BYTES is what this machine gives the library.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <string.h>

#include "device_io.h"

#ifndef BLOCK_BYTES
#define BLOCK_BYTES (1024 * 1024)
#endif
#define MAX_SEEN 64

typedef struct session_head {
  uint32_t magic;
  int32_t frames, width, height, max_features, max_state_dim, max_observations, targets;
  double fx, fy, cx, cy, sigma_pixel;
  double q_WC[4], p_WC[3], sigma_rad, sigma_m;
  double points_W[PF_TARGET_MAX_POINTS][3];
} session_head_t;

typedef struct session_frame {
  int64_t t_ns;
  int32_t count, unused;
} session_frame_t;

typedef struct session_seen {
  uint32_t id, unused;
  double pixel[2];
} session_seen_t;

typedef struct result_frame {
  int64_t t_ns;
  int32_t status, features, state_dim, inliers;
  double q_WC[4], p_WC[3], sigma_p[3];
} result_frame_t;

static _Alignas(64) unsigned char block[BLOCK_BYTES];
static session_head_t head;
static session_seen_t seen[MAX_SEEN];
static pf_observation_t observations[MAX_SEEN];

static void print_number(const char* name, size_t value) {
  char digits[24];
  size_t at = sizeof(digits) - 1;
  digits[at] = 0;
  do {
    digits[--at] = (char)('0' + value % 10);
    value /= 10;
  } while (value > 0);
  device_print(name);
  device_print(" ");
  device_print(digits + at);
  device_print("\n");
}

static int fail(const char* what, pf_status_t status) {
  device_print(what);
  device_print(": ");
  device_print(pf_status_text(status));
  device_print("\n");
  return 1;
}

static pf_status_t start(pf_slam_t* slam) {
  pf_target_t target;
  int i;
  memset(&target, 0, sizeof(target));
  target.kind = PF_TARGET_POINTS;
  target.count = head.targets;
  memcpy(target.points_W, head.points_W, sizeof(target.points_W));
  memcpy(target.first_pose.q_WC, head.q_WC, sizeof(head.q_WC));
  memcpy(target.first_pose.p_WC, head.p_WC, sizeof(head.p_WC));
  for (i = 0; i < 3; ++i) {
    target.first_pose.covariance[7 * i] = head.sigma_rad * head.sigma_rad;
    target.first_pose.covariance[7 * (i + 3)] = head.sigma_m * head.sigma_m;
  }
  target.sigma = 0.001;
  return pf_start_from_target(slam, &target);
}

static int run_frame(pf_slam_t* slam) {
  session_frame_t frame;
  result_frame_t result;
  pf_pose_t pose;
  pf_report_t report;
  int32_t i;
  memset(&result, 0, sizeof(result));
  memset(&pose, 0, sizeof(pose));
  if (device_read(&frame, sizeof(frame)) != 0 || frame.count < 0 || frame.count > MAX_SEEN ||
      (frame.count > 0 && device_read(seen, (size_t)frame.count * sizeof(seen[0])) != 0)) {
    return fail("session", PF_ERROR_SIZE);
  }
  for (i = 0; i < frame.count; ++i) {
    observations[i].id = seen[i].id;
    observations[i].pixel[0] = seen[i].pixel[0];
    observations[i].pixel[1] = seen[i].pixel[1];
    observations[i].sigma_px = 0.0;
  }
  result.t_ns = frame.t_ns;
  result.status = pf_push_observations(slam, frame.t_ns, observations, (size_t)frame.count);
  if (result.status < 0) return fail("pf_push_observations", (pf_status_t)result.status);
  if (pf_get_pose(slam, &pose) >= 0) {
    memcpy(result.q_WC, pose.q_WC, sizeof(pose.q_WC));
    memcpy(result.p_WC, pose.p_WC, sizeof(pose.p_WC));
    for (i = 0; i < 3; ++i) result.sigma_p[i] = sqrt(pose.covariance[7 * (i + 3)]);
  }
  if (pf_get_report(slam, &report) >= 0) {
    result.features = report.features;
    result.state_dim = report.state_dim;
    result.inliers = report.inliers;
  }
  return device_write(&result, sizeof(result)) == 0 ? 0 : fail("result", PF_ERROR_SIZE);
}

int main(int argc, char** argv) {
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam;
  pf_status_t status;
  int32_t k;
  if (device_open_files(argc, argv) != 0 || device_read(&head, sizeof(head)) != 0 || head.magic != 0x31534650u) {
    device_print("the session cannot be read\n");
    return 1;
  }
  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = head.width;
  config.camera.height = head.height;
  config.camera.fx = head.fx;
  config.camera.fy = head.fy;
  config.camera.cx = head.cx;
  config.camera.cy = head.cy;
  config.capacity.max_features = head.max_features;
  config.capacity.max_state_dim = head.max_state_dim;
  config.capacity.max_observations = config.map.features_in_view = head.max_observations;
  config.measurement.sigma_px = head.sigma_pixel;
  status = pf_memory_query(&config, &need);
  if (status != PF_OK) return fail("pf_memory_query", status);
  status = pf_create(&config, block, sizeof(block), &slam);
  if (status != PF_OK) return fail("pf_create", status);
  status = start(slam);
  if (status != PF_OK) return fail("pf_start_from_target", status);
  for (k = 0; k < head.frames; ++k) {
    if (run_frame(slam) != 0) return 1;
  }
  device_close_files();
  print_number("block_bytes", need.bytes);
  print_number("stack_bytes", device_stack_used());
  device_print("done\n");
  return 0;
}
