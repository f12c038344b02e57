#pragma once

#include <cstdlib>
#include <memory>

#include "planefold/planefold.h"

namespace pfsim {

/// A context of the library in its own block; slam is null when the config is not possible.
class Context {
 public:
  explicit Context(const pf_config_t& config) {
    pf_memory_t need;
    if (pf_memory_query(&config, &need) != PF_OK) return;
    const std::size_t bytes = (need.bytes + need.alignment - 1) / need.alignment * need.alignment;
    block_.reset(std::aligned_alloc(need.alignment, bytes));
    if (block_) pf_create(&config, block_.get(), bytes, &slam);
  }
  pf_slam_t* slam = nullptr;

 private:
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  std::unique_ptr<void, Free> block_;
};

}  // namespace pfsim
