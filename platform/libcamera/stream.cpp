#include <linux/dma-buf.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <exception>

#include "camera.h"
#include "format.h"
#include "luma.h"
#include "nodes.h"

namespace pf::libcamera {

namespace {

constexpr int64_t kSilentNs = 1000000000;  ///< without a frame: worth a look whether the device is still there

int64_t clock_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<int64_t>(now.tv_sec) * 1000000000 + now.tv_nsec;
}

/// Tells the kernel that the processor begins or ends reading; memory that needs none of it refuses, which is as well.
void synchronise(const Slot& slot, bool begin) {
  dma_buf_sync sync{};
  sync.flags = (begin ? DMA_BUF_SYNC_START : DMA_BUF_SYNC_END) | DMA_BUF_SYNC_READ;
  int result = 0;
  do {
    result = ioctl(slot.fd, DMA_BUF_IOCTL_SYNC, &sync);
  } while (result != 0 && (errno == EINTR || errno == EAGAIN));
}

/// When a frame was taken, of CLOCK_MONOTONIC. false: the frame has to be dropped.
///
/// SensorTimestamp is documented as CLOCK_BOOTTIME, which runs on while the machine sleeps; most pipelines hand on the kernel's
/// monotonic time all the same. A time that lies ahead of the monotonic clock can only be the former.
bool time_of(::libcamera::Request& request, const ::libcamera::FrameMetadata& buffer, int64_t arrived_ns,
             pf_stamps_t& stamps, uint32_t& stamp, int64_t& t_ns) {
  const auto sensor = request.metadata().get(::libcamera::controls::SensorTimestamp);
  int64_t device_ns = sensor ? *sensor : static_cast<int64_t>(buffer.timestamp);
  if (device_ns > arrived_ns + PF_STAMP_AHEAD_NS) {
    device_ns -= clock_ns(CLOCK_BOOTTIME) - clock_ns(CLOCK_MONOTONIC);
  }
  const pf_stamp_choice_t choice =
      pf_choose_stamp(&stamps, pf_possible_stamp(device_ns, arrived_ns), arrived_ns, arrived_ns, &t_ns);
  if (choice == PF_STAMP_ARRIVAL) {
    stamp = PF_LIBCAMERA_STAMP_ARRIVAL;
  } else if (choice == PF_STAMP_DEVICE) {
    stamp = sensor ? PF_LIBCAMERA_STAMP_SENSOR : PF_LIBCAMERA_STAMP_BUFFER;
  }
  return choice != PF_STAMP_DROP;
}

/// Frames that are missing in front of this one, by its number.
uint32_t count_lost(pf_libcamera& camera, uint32_t sequence) {
  const uint32_t step = camera.has_sequence ? sequence - camera.last_sequence : 1;
  camera.has_sequence = true;
  camera.last_sequence = sequence;
  return step > 1 && step < 0x80000000u ? step - 1 : 0;
}

void queue(pf_libcamera& camera, Slot& slot) {
  slot.request->reuse(::libcamera::Request::ReuseBuffers);
  camera.camera->queueRequest(slot.request.get());  // a camera that left meanwhile says so by its signal
}

int depart(pf_libcamera& camera, char message[PF_LIBCAMERA_MESSAGE]) {
  refuse(message, std::string(camera.info.device.id) + ": is gone; was it unplugged?");
  if (!camera.gone) {
    camera.gone = true;
    ++camera.info.departures;
  }
  return PF_LIBCAMERA_GONE;
}

/// Fills in a frame; false: it is damaged.
bool take(pf_libcamera& camera, const Completed& done, pf_libcamera_frame_t& frame) {
  Slot& slot = camera.slots[done.slot];
  pf_libcamera_info_t& info = camera.info;
  const ::libcamera::FrameMetadata& buffer = slot.buffer->metadata();
  const auto stride = static_cast<size_t>(info.stride);
  const size_t bytes = stride * static_cast<size_t>(info.height - 1) + row_bytes(info.format, info.width);
  frame.arrived_ns = done.arrived_ns;
  frame.sequence = buffer.sequence;
  frame.lost_before = count_lost(camera, buffer.sequence);
  frame.buffer = static_cast<int32_t>(done.slot);
  info.lost += frame.lost_before;
  if (buffer.status != ::libcamera::FrameMetadata::FrameSuccess || buffer.planes().empty() ||
      buffer.planes()[0].bytesused < bytes ||
      !time_of(*slot.request, buffer, done.arrived_ns, camera.stamps, info.stamp, frame.image.t_ns)) {
    return false;
  }
  ::libcamera::ControlList& metadata = slot.request->metadata();
  const auto duration_us = metadata.get(::libcamera::controls::FrameDuration);
  const auto exposure_us = metadata.get(::libcamera::controls::ExposureTime);
  info.rate_hz = duration_us && *duration_us > 0 ? 1e6 / static_cast<double>(*duration_us) : 0.0;
  info.exposure_s = exposure_us ? 1e-6 * static_cast<double>(*exposure_us) : 0.0;
  const uint8_t* plane = slot.mapped + slot.offset;
  frame.image.width = info.width;
  frame.image.height = info.height;
  synchronise(slot, true);
  if (info.direct != 0) {
    frame.image.pixels = plane;
    frame.image.stride = info.stride;
  } else {
    to_grey(info.format, plane, stride, info.width, info.height, slot.grey.data());
    synchronise(slot, false);
    frame.image.pixels = slot.grey.data();
    frame.image.stride = info.width;
  }
  pf_keep_stamp(&camera.stamps, frame.image.t_ns, frame.arrived_ns);
  slot.held = true;
  ++info.frames;
  return true;
}

}  // namespace

int64_t monotonic_ns() { return clock_ns(CLOCK_MONOTONIC); }

}  // namespace pf::libcamera

using pf::libcamera::refuse;
using pf::libcamera::Slot;

void pf_libcamera::on_completed(libcamera::Request* request) {
  const int64_t now_ns = pf::libcamera::monotonic_ns();
  if (request->status() == libcamera::Request::RequestCancelled) {
    return;
  }
  const std::lock_guard<std::mutex> lock(mutex);
  completed.push_back({static_cast<size_t>(request->cookie()), now_ns});
  changed.notify_all();
}

void pf_libcamera::on_disconnected() {
  const std::lock_guard<std::mutex> lock(mutex);
  departed = true;
  changed.notify_all();
}

int pf_libcamera_start(pf_libcamera_t* camera, char message[PF_LIBCAMERA_MESSAGE]) {
  if (camera == nullptr || camera->camera == nullptr) {
    return refuse(message, "no camera is open");
  }
  if (camera->streaming) {
    return 0;
  }
  try {
    const std::string name = camera->camera->id() + ": ";
    libcamera::ControlList controls(camera->camera->controls());
    std::string error;
    if (!pf::libcamera::wanted_controls(*camera->camera, camera->options, controls, error) || !camera->map(error)) {
      camera->unmap();
      return refuse(message, name + error);
    }
    const int result = camera->camera->start(&controls);
    if (result != 0) {
      camera->unmap();
      return refuse(message, name + "does not begin to stream (" + std::strerror(-result) + ")");
    }
    camera->streaming = true;
    camera->alive_ns = pf::libcamera::monotonic_ns();
    camera->gone_nodes = pf::libcamera::count_gone_nodes();
    camera->has_sequence = false;
    for (Slot& slot : camera->slots) {
      const int queued = camera->camera->queueRequest(slot.request.get());
      if (queued != 0) {
        camera->stop();
        return refuse(message, name + "does not take a request (" + std::strerror(-queued) + ")");
      }
    }
    return 0;
  } catch (const std::exception& exception) {
    camera->stop();
    return refuse(message, std::string("libcamera: ") + exception.what());
  }
}

int pf_libcamera_stop(pf_libcamera_t* camera, char[PF_LIBCAMERA_MESSAGE]) {
  if (camera != nullptr) {
    camera->stop();
  }
  return 0;
}

int pf_libcamera_read(pf_libcamera_t* camera, int timeout_ms, pf_libcamera_frame_t* frame,
                      char message[PF_LIBCAMERA_MESSAGE]) {
  if (camera == nullptr || frame == nullptr) {
    return refuse(message, "camera or frame is null");
  }
  *frame = {};
  frame->buffer = -1;
  if (camera->gone) {
    return pf::libcamera::depart(*camera, message);
  }
  if (!camera->streaming) {
    return refuse(message, std::string(camera->info.device.id) + ": does not stream; call pf_libcamera_start first");
  }
  pf::libcamera::Completed done{};
  {
    std::unique_lock<std::mutex> lock(camera->mutex);
    camera->changed.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                             [&] { return camera->departed || !camera->completed.empty(); });
    // Not every pipeline of libcamera watches for the device to leave.
    camera->vanished = !camera->departed && camera->completed.empty() &&
                       pf::libcamera::monotonic_ns() - camera->alive_ns > pf::libcamera::kSilentNs &&
                       pf::libcamera::count_gone_nodes() > camera->gone_nodes;
    if (camera->departed || camera->vanished) {
      return pf::libcamera::depart(*camera, message);
    }
    if (camera->completed.empty()) {
      return PF_LIBCAMERA_NOTHING;
    }
    camera->alive_ns = camera->completed.front().arrived_ns;
    done = camera->completed.front();
    camera->completed.pop_front();
  }
  if (!pf::libcamera::take(*camera, done, *frame)) {
    ++camera->info.damaged;
    pf::libcamera::queue(*camera, camera->slots[done.slot]);
    frame->buffer = -1;
    return PF_LIBCAMERA_NOTHING;
  }
  return PF_LIBCAMERA_FRAME;
}

void pf_libcamera_release(pf_libcamera_t* camera, const pf_libcamera_frame_t* frame) {
  if (camera == nullptr || frame == nullptr || frame->buffer < 0 ||
      static_cast<size_t>(frame->buffer) >= camera->slots.size()) {
    return;
  }
  Slot& slot = camera->slots[static_cast<size_t>(frame->buffer)];
  if (!slot.held) {
    return;
  }
  slot.held = false;
  if (camera->info.direct != 0) {
    pf::libcamera::synchronise(slot, false);
  }
  if (!camera->gone && camera->streaming) {
    pf::libcamera::queue(*camera, slot);
  }
}
