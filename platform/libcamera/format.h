#ifndef PLANEFOLD_PLATFORM_LIBCAMERA_FORMAT_H
#define PLANEFOLD_PLATFORM_LIBCAMERA_FORMAT_H

#include <libcamera/libcamera.h>
#include <planefold_platform/libcamera.h>

#include <memory>
#include <string>

namespace pf::libcamera {

::libcamera::PixelFormat pixel_format(uint32_t format);

/// One stream for video, or for a viewfinder where the camera has no such role; null where it has neither.
std::unique_ptr<::libcamera::CameraConfiguration> default_configuration(::libcamera::Camera& camera);

/// A valid configuration of one stream in the size of the options, with the first of their formats that the camera has in it;
/// format says which. null: error is a line without the camera's name.
std::unique_ptr<::libcamera::CameraConfiguration> negotiate(::libcamera::Camera& camera,
                                                            const pf_libcamera_options_t& options, uint32_t& format,
                                                            std::string& error);

/// Frame rate, exposure and focus as controls for the start of the stream. false: error is a line without the camera's name.
bool wanted_controls(const ::libcamera::Camera& camera, const pf_libcamera_options_t& options,
                     ::libcamera::ControlList& controls, std::string& error);

}  // namespace pf::libcamera

#endif
