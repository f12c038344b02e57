#include "manager.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "format.h"

namespace pf::libcamera {

namespace {

std::string model_of(const ::libcamera::Camera& camera) {
  const auto model = camera.properties().get(::libcamera::properties::Model);
  return model ? *model : std::string();
}

}  // namespace

std::shared_ptr<::libcamera::CameraManager> share_manager(std::string& error) {
  static std::mutex mutex;
  static std::weak_ptr<::libcamera::CameraManager> shared;
  const std::lock_guard<std::mutex> lock(mutex);
  std::shared_ptr<::libcamera::CameraManager> manager = shared.lock();
  if (manager != nullptr) {
    return manager;
  }
  if (std::getenv("LIBCAMERA_LOG_LEVELS") == nullptr) {
    ::libcamera::logSetTarget(::libcamera::LoggingTargetNone);
  }
  manager = std::shared_ptr<::libcamera::CameraManager>(new ::libcamera::CameraManager,
                                                        [](::libcamera::CameraManager* started) {
                                                          started->stop();
                                                          delete started;
                                                        });
  const int result = manager->start();
  if (result != 0) {
    error = std::string("libcamera does not start: ") + std::strerror(-result) + "; is udev running?";
    return nullptr;
  }
  shared = manager;
  return manager;
}

std::shared_ptr<::libcamera::Camera> find_camera(::libcamera::CameraManager& manager, const std::string& name,
                                                 std::string& error) {
  const std::vector<std::shared_ptr<::libcamera::Camera>> cameras = manager.cameras();
  const std::string count = std::to_string(cameras.size());
  if (cameras.empty()) {
    error =
        "libcamera finds no camera; is it plugged in, and does this user belong to the group video? "
        "LIBCAMERA_LOG_LEVELS=*:INFO shows what libcamera tries";
    return nullptr;
  }
  if (name.find_first_not_of("0123456789") == std::string::npos && name.size() < 6) {
    const size_t number = name.empty() ? 0 : std::strtoul(name.c_str(), nullptr, 10);
    if (number < cameras.size()) {
      return cameras[number];
    }
    error = "libcamera:" + name + ": there is no such camera; they are numbered from 0, and there are " + count;
    return nullptr;
  }
  for (const auto& camera : cameras) {
    if (camera->id() == name) {
      return camera;
    }
  }
  for (const auto& camera : cameras) {
    if (camera->id().find(name) != std::string::npos || model_of(*camera).find(name) != std::string::npos) {
      return camera;
    }
  }
  error = "libcamera:" + name + ": none of " + count + " cameras has an id or model like this; pf-capture --list";
  return nullptr;
}

void describe(::libcamera::Camera& camera, pf_libcamera_device_t& device) {
  device = {};
  std::snprintf(device.id, sizeof(device.id), "%s", camera.id().c_str());
  std::snprintf(device.model, sizeof(device.model), "%s", model_of(camera).c_str());
  const auto configuration = default_configuration(camera);
  if (configuration != nullptr) {
    for (const ::libcamera::PixelFormat& pixels : configuration->at(0).formats().pixelformats()) {
      for (uint32_t format = 1; format < PF_LIBCAMERA_FORMATS; ++format) {
        device.formats |= pixels == pixel_format(format) ? 1u << format : 0u;
      }
    }
  }
}

}  // namespace pf::libcamera

int pf_libcamera_list(pf_libcamera_device_t* devices, int capacity) {
  std::string error;
  const auto manager = pf::libcamera::share_manager(error);
  if (manager == nullptr) {
    return 0;
  }
  int count = 0;
  for (const auto& camera : manager->cameras()) {
    if (devices != nullptr && count < capacity) {
      pf::libcamera::describe(*camera, devices[count]);
    }
    ++count;
  }
  return count;
}

const char* pf_libcamera_version(void) { return ::libcamera::CameraManager::version().c_str(); }
