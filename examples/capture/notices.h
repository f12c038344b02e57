#ifndef PLANEFOLD_CAPTURE_NOTICES_H
#define PLANEFOLD_CAPTURE_NOTICES_H

#include <deque>
#include <mutex>
#include <string>
#include <utility>

namespace pf::capture {

/// Lines for the user, from any thread, to be read by another.
class Notices {
 public:
  void add(std::string line) {
    const std::lock_guard<std::mutex> lock(mutex_);
    lines_.push_back(std::move(line));
  }

  /// The oldest, once. false: there is none.
  bool take(std::string& line) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (lines_.empty()) {
      return false;
    }
    line = std::move(lines_.front());
    lines_.pop_front();
    return true;
  }

 private:
  std::mutex mutex_;
  std::deque<std::string> lines_;
};

}  // namespace pf::capture

#endif
