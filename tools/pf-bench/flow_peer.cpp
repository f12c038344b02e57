#include "flow_peer.h"

#include <dlfcn.h>

namespace bench {

FlowPeer::FlowPeer() {
#ifdef PF_BENCH_FLOW_MODULE
  void* module = dlopen(PF_BENCH_FLOW_MODULE, RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) {
    name_ = std::string("the module with OpenCV cannot be loaded: ") + dlerror();
    return;
  }
  time_us_ = reinterpret_cast<Time>(dlsym(module, "pf_bench_flow_us"));
  const auto name = reinterpret_cast<const char* (*)()>(dlsym(module, "pf_bench_flow_name"));
  name_ = name != nullptr ? name() : "OpenCV";
#else
  name_ = "built without OpenCV (Debian: libopencv-video-dev)";
#endif
}

double FlowPeer::time_us(const uint8_t* previous, const uint8_t* next, int width, int height) const {
  int points = 0;
  int tracked = 0;
  return time_us_(previous, next, width, height, &points, &tracked);
}

}  // namespace bench
