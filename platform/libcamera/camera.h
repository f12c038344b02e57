#ifndef PLANEFOLD_PLATFORM_LIBCAMERA_CAMERA_H
#define PLANEFOLD_PLATFORM_LIBCAMERA_CAMERA_H

#include <libcamera/libcamera.h>
#include <planefold_platform/libcamera.h>
#include <planefold_platform/stamps.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace pf::libcamera {

/// A buffer of the camera, the request that goes to the camera with it, and the grey levels made of it.
struct Slot {
  std::unique_ptr<::libcamera::Request> request;
  ::libcamera::FrameBuffer* buffer = nullptr;  ///< the allocator's
  uint8_t* mapped = nullptr;                   ///< begin of the memory that the first plane lies in; null: not mapped
  size_t mapped_bytes = 0;
  size_t offset = 0, length = 0;  ///< of the first plane
  int fd = -1;                    ///< the allocator's
  std::vector<uint8_t> grey;      ///< where pixels are not direct
  bool held = false;              ///< by the caller
};

struct Completed {
  size_t slot;
  int64_t arrived_ns;
};

int64_t monotonic_ns();

/// One line for message; returns -1.
int refuse(char message[PF_LIBCAMERA_MESSAGE], const std::string& line);

}  // namespace pf::libcamera

struct pf_libcamera {
  // Order matters: what is declared later is gone first.
  std::shared_ptr<libcamera::CameraManager> manager;
  std::shared_ptr<libcamera::Camera> camera;
  std::unique_ptr<libcamera::CameraConfiguration> configuration;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator;
  std::vector<pf::libcamera::Slot> slots;

  pf_libcamera_options_t options{};
  pf_libcamera_info_t info{};
  bool acquired = false;
  bool streaming = false;
  bool gone = false;      ///< as the caller knows
  bool vanished = false;  ///< gone, and libcamera does not know
  int gone_nodes = 0;     ///< of other cameras, when the stream began
  int64_t alive_ns = 0;   ///< when the last frame came, or the stream began
  bool has_sequence = false;
  uint32_t last_sequence = 0;
  pf_stamps_t stamps{};

  std::mutex mutex;  ///< over what libcamera's thread touches: the next two
  std::condition_variable changed;
  std::deque<pf::libcamera::Completed> completed;
  bool departed = false;

  ~pf_libcamera() { leave(); }

  /// Acquires and configures the camera. false: error is a line.
  bool enter(std::shared_ptr<libcamera::Camera> found, std::string& error);
  /// Stops and gives everything back; never fails.
  void leave();
  bool map(std::string& error);
  void unmap();
  void stop();

  // Called from libcamera's thread.
  void on_completed(libcamera::Request* request);
  void on_disconnected();
};

#endif
