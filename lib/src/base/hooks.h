#pragma once

#include <cstdint>

#include "base/log_line.h"

namespace pf {

/// The caller's functions: a clock and a log for lines of text. Either may be null.
struct Hooks {
  std::int64_t (*clock_ns)(void* user) = nullptr;
  void (*log)(void* user, const char* line) = nullptr;
  void* user = nullptr;

  std::int64_t now() const { return clock_ns != nullptr ? clock_ns(user) : 0; }
  /// Logs one line of texts, whole numbers and fixed() ones. Without a log nothing is built.
  template <class... Parts>
  void say(const Parts&... parts) const {
    if (log == nullptr) return;
    const LogPart part[] = {parts...};
    write(part, sizeof...(parts));
  }

 private:
  [[gnu::cold]] void write(const LogPart* part, int parts) const;
};

/// Adds the time that a scope takes to a stage.
class StageTimer {
 public:
  StageTimer(const Hooks& hooks, std::int64_t* stage_ns) : hooks_(hooks), stage_ns_(stage_ns), begin_(hooks.now()) {}
  ~StageTimer() { *stage_ns_ += hooks_.now() - begin_; }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  const Hooks& hooks_;
  std::int64_t* stage_ns_;
  std::int64_t begin_;
};

}  // namespace pf
