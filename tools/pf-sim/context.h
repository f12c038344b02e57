#pragma once

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "planefold/planefold_research.h"

namespace pfsim {

/// Lets a config have the values of planefold_research.h.
inline void allow_research(pf_config_t* config) {
  pf_research_t research;
  pf_research_default(&research);
  pf_config_set_research(config, &research);
}

/// The window as back end, with as many features in view as pf-capture gives it.
inline void use_window(pf_config_t& config) {
  constexpr std::int32_t kWindowFeatures = 150;
  config.backend = PF_BACKEND_WINDOW;
  config.map.features_in_view = std::min(kWindowFeatures, config.window.points);
}

/// A context of the library in its own block; slam is null when the config is not possible.
class Context {
 public:
  explicit Context(const pf_config_t& config) {
    pf_memory_t need;
    if (pf_memory_query(&config, &need) != PF_OK) return;
    bytes_ = (need.bytes + need.alignment - 1) / need.alignment * need.alignment;
    block_.reset(std::aligned_alloc(need.alignment, bytes_));
    if (block_) pf_create(&config, block_.get(), bytes_, &slam);
  }
  pf_slam_t* slam = nullptr;

  /// A context is nothing but its block: a copy of the bytes, put back to the same place, is the context as it was.
  void save(std::vector<unsigned char>* bytes) const {
    bytes->resize(bytes_);
    std::memcpy(bytes->data(), block_.get(), bytes_);
  }
  void restore(const std::vector<unsigned char>& bytes) { std::memcpy(block_.get(), bytes.data(), bytes_); }

 private:
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  std::unique_ptr<void, Free> block_;
  std::size_t bytes_ = 0;
};

}  // namespace pfsim
