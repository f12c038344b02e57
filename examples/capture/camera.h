#ifndef PLANEFOLD_CAPTURE_CAMERA_H
#define PLANEFOLD_CAPTURE_CAMERA_H

#include <planefold/planefold.h>

#include <cstdint>
#include <memory>
#include <string>

#include "options.h"
#include "source.h"

namespace pf::capture {

struct CameraFrame {
  pf_image_t image{};      ///< pixels are valid until the frame is released
  int64_t arrived_ns = 0;  ///< of the steady clock
  int64_t number = 0;      ///< from 0
  int32_t handle = -1;     ///< the camera's own
  bool has_truth = false;
  pf_pose_t truth{};
};

enum class CameraRead { kFrame, kNothing, kGone, kEnd, kFailed };

/// Something that gives frames at its own pace, whether anybody is ready or not. Used by one thread.
class Camera {
 public:
  virtual ~Camera() = default;
  virtual bool start(std::string& error) = 0;
  /// Waits for the next frame. kGone and kFailed: message is one line.
  virtual CameraRead next(int timeout_ms, CameraFrame& frame, std::string& message) = 0;
  virtual void release(const CameraFrame& frame) = 0;
  /// After kGone, with every frame released: true when it is there again and gives frames.
  virtual bool come_back() { return false; }
  virtual std::string name() const = 0;
  /// For report.json: {"device": .., "lost": ..}
  virtual std::string report() const = 0;
  virtual bool target(pf_target_t&) const { return false; }
};

/// A camera of this machine. null: error is one line. camera is that of --calib; rate_hz becomes what the device grants, or what was asked
/// for where that is known with the first frames only.
std::unique_ptr<Camera> open_device_camera(const Options& options, const pf_camera_t& camera, double& rate_hz,
                                           std::string& error);

/// A folder or a scene, played at the pace of its own timestamps.
std::unique_ptr<Camera> open_paced_camera(const Options& options, std::unique_ptr<Source> source);

/// Prints the cameras and IMUs of this machine; returns the exit code.
int list_devices();

}  // namespace pf::capture

#endif
