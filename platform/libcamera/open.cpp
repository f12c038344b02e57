#include <cstdio>
#include <exception>

#include "camera.h"
#include "format.h"
#include "luma.h"
#include "manager.h"

namespace pf::libcamera {

int refuse(char message[PF_LIBCAMERA_MESSAGE], const std::string& line) {
  if (message != nullptr) {
    std::snprintf(message, PF_LIBCAMERA_MESSAGE, "%s", line.c_str());
  }
  return -1;
}

namespace {

bool are_valid(const pf_libcamera_options_t& options) {
  return options.width >= 1 && options.height >= 1 && options.width <= 16384 && options.height <= 16384 &&
         options.format < PF_LIBCAMERA_FORMATS && options.buffers >= 2 && options.buffers <= PF_LIBCAMERA_MAX_BUFFERS &&
         options.rate_hz >= 0.0 && options.rate_hz <= 10000.0 && options.exposure_s >= 0.0 &&
         options.exposure_s <= 100.0;
}

}  // namespace

}  // namespace pf::libcamera

using pf::libcamera::refuse;

bool pf_libcamera::enter(std::shared_ptr<libcamera::Camera> found, std::string& error) {
  camera = std::move(found);
  pf::libcamera::describe(*camera, info.device);
  const std::string name = camera->id() + ": ";
  if (camera->acquire() != 0) {
    error = name + "another program uses it; close that first";
    return false;
  }
  acquired = true;
  configuration = pf::libcamera::negotiate(*camera, options, info.format, error);
  if (configuration == nullptr) {
    error.insert(0, name);
    return false;
  }
  if (camera->configure(configuration.get()) != 0) {
    error = name + "refuses " + configuration->at(0).toString();
    return false;
  }
  libcamera::ControlList controls(camera->controls());
  if (!pf::libcamera::wanted_controls(*camera, options, controls, error)) {
    error.insert(0, name);
    return false;
  }
  info.width = options.width;
  info.height = options.height;
  info.stride = static_cast<int32_t>(configuration->at(0).stride);
  info.direct = options.direct != 0 && pf::libcamera::has_grey_plane(info.format) ? 1 : 0;
  camera->requestCompleted.connect(this, &pf_libcamera::on_completed);
  camera->disconnected.connect(this, &pf_libcamera::on_disconnected);
  return true;
}

void pf_libcamera::leave() {
  stop();
  if (camera != nullptr) {
    camera->requestCompleted.disconnect(this);
    camera->disconnected.disconnect(this);
    if (vanished) {
      // libcamera 0.0.3 ends the program when it stops a camera whose requests the device still holds, and also when it
      // destroys one that was not stopped. So this one is kept for ever.
      new std::shared_ptr<libcamera::Camera>(camera);
    } else if (acquired) {
      camera->release();
    }
  }
  acquired = false;
  configuration.reset();
  camera.reset();
}

void pf_libcamera_options_default(pf_libcamera_options_t* options) {
  *options = {};
  options->buffers = 6;
}

int pf_libcamera_open(const char* name, const pf_libcamera_options_t* options, pf_libcamera_t** camera,
                      char message[PF_LIBCAMERA_MESSAGE]) {
  if (options == nullptr || camera == nullptr) {
    return refuse(message, "options or camera is null");
  }
  *camera = nullptr;
  if (!pf::libcamera::are_valid(*options)) {
    return refuse(message, "a field of the options is out of its range; libcamera.h says what is possible");
  }
  try {
    auto opened = std::make_unique<pf_libcamera>();
    std::string error;
    opened->options = *options;
    opened->manager = pf::libcamera::share_manager(error);
    if (opened->manager == nullptr) {
      return refuse(message, error);
    }
    auto found = pf::libcamera::find_camera(*opened->manager, name != nullptr ? name : "", error);
    if (found == nullptr || !opened->enter(std::move(found), error)) {
      return refuse(message, error);
    }
    *camera = opened.release();
    return 0;
  } catch (const std::exception& exception) {
    return refuse(message, std::string("libcamera: ") + exception.what());
  }
}

void pf_libcamera_close(pf_libcamera_t* camera) { delete camera; }

void pf_libcamera_get_info(const pf_libcamera_t* camera, pf_libcamera_info_t* info) {
  if (camera != nullptr && info != nullptr) {
    *info = camera->info;
  }
}

int pf_libcamera_return(pf_libcamera_t* camera, char message[PF_LIBCAMERA_MESSAGE]) {
  if (camera == nullptr || !camera->gone) {
    return refuse(message, "the camera is not gone");
  }
  try {
    const std::string id = camera->info.device.id;
    std::string error;
    if (camera->camera != nullptr) {
      camera->leave();
      // A manager that has not noticed that the device left would crash when it comes back.
      camera->manager.reset();
    }
    if (camera->manager == nullptr) {
      camera->manager = pf::libcamera::share_manager(error);
    }
    if (camera->manager == nullptr) {
      return refuse(message, error);
    }
    std::shared_ptr<libcamera::Camera> found = camera->manager->get(id);
    if (found == nullptr) {
      return refuse(message, id + ": is not there");
    }
    {
      const std::lock_guard<std::mutex> lock(camera->mutex);
      camera->departed = false;
      camera->completed.clear();
    }
    camera->vanished = false;
    if (!camera->enter(std::move(found), error)) {
      camera->leave();
      return refuse(message, error);
    }
    if (pf_libcamera_start(camera, message) != 0) {
      camera->leave();
      return -1;
    }
    camera->gone = false;
    return 0;
  } catch (const std::exception& exception) {
    return refuse(message, std::string("libcamera: ") + exception.what());
  }
}
