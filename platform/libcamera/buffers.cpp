#include <sys/mman.h>

#include <cerrno>
#include <cstring>

#include "camera.h"
#include "luma.h"

using pf::libcamera::Slot;

bool pf_libcamera::map(std::string& error) {
  libcamera::Stream* stream = configuration->at(0).stream();
  allocator = std::make_unique<libcamera::FrameBufferAllocator>(camera);
  if (allocator->allocate(stream) <= 0) {
    error = "gives no buffers; lower the size, or the number of buffers";
    return false;
  }
  const auto& buffers = allocator->buffers(stream);
  const auto stride = static_cast<size_t>(info.stride);
  const size_t bytes =
      stride * static_cast<size_t>(info.height - 1) + pf::libcamera::row_bytes(info.format, info.width);
  slots.clear();
  slots.resize(buffers.size() < PF_LIBCAMERA_MAX_BUFFERS ? buffers.size() : PF_LIBCAMERA_MAX_BUFFERS);
  info.buffers = static_cast<int32_t>(slots.size());
  for (size_t i = 0; i < slots.size(); ++i) {
    Slot& slot = slots[i];
    slot.buffer = buffers[i].get();
    slot.request = camera->createRequest(i);
    if (slot.request == nullptr || slot.request->addBuffer(stream, slot.buffer) != 0) {
      error = "makes no request";
      return false;
    }
    const libcamera::FrameBuffer::Plane& plane = slot.buffer->planes()[0];
    slot.fd = plane.fd.get();
    slot.offset = plane.offset == libcamera::FrameBuffer::Plane::kInvalidOffset ? 0 : plane.offset;
    slot.length = plane.length;
    if (slot.length < bytes) {
      error = "gives buffers that are too small for its pictures";
      return false;
    }
    slot.mapped_bytes = slot.offset + slot.length;
    void* mapped = mmap(nullptr, slot.mapped_bytes, PROT_READ, MAP_SHARED, slot.fd, 0);
    if (mapped == MAP_FAILED) {
      error = std::string("gives buffers that cannot be mapped (") + std::strerror(errno) + ")";
      return false;
    }
    slot.mapped = static_cast<uint8_t*>(mapped);
    if (info.direct == 0) {
      slot.grey.resize(static_cast<size_t>(info.width) * static_cast<size_t>(info.height));
    }
  }
  return true;
}

void pf_libcamera::unmap() {
  for (Slot& slot : slots) {
    if (slot.mapped != nullptr) {
      munmap(slot.mapped, slot.mapped_bytes);
    }
  }
  slots.clear();
  allocator.reset();
}

void pf_libcamera::stop() {
  if (streaming && !vanished) {
    camera->stop();  // every request is completed or cancelled when it returns
  }
  streaming = false;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    completed.clear();
  }
  unmap();
}
