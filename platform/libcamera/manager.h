#ifndef PLANEFOLD_PLATFORM_LIBCAMERA_MANAGER_H
#define PLANEFOLD_PLATFORM_LIBCAMERA_MANAGER_H

#include <libcamera/libcamera.h>
#include <planefold_platform/libcamera.h>

#include <memory>
#include <string>

namespace pf::libcamera {

/// libcamera's manager of cameras. A process may have only one at a time, so it is shared by all that are open; null: error is a
/// line. It keeps watching for cameras that are plugged in, from a thread of its own.
std::shared_ptr<::libcamera::CameraManager> share_manager(std::string& error);

/// A camera by its number in the manager's order, or by part of its id or model; empty name: the first. null: error is a line.
std::shared_ptr<::libcamera::Camera> find_camera(::libcamera::CameraManager& manager, const std::string& name,
                                                 std::string& error);

/// Fills in what can be known of a camera that is not acquired.
void describe(::libcamera::Camera& camera, pf_libcamera_device_t& device);

}  // namespace pf::libcamera

#endif
