#ifndef PLANEFOLD_CAPTURE_PROGRESS_H
#define PLANEFOLD_CAPTURE_PROGRESS_H

#include <cstdint>
#include <ctime>

#include "view.h"

namespace pf::capture {

/// One line on stderr that says how far the run is: rewritten in place on a terminal, a new line every two seconds elsewhere.
class Progress {
 public:
  explicit Progress(bool quiet);
  void show(const FrameView& view);
  /// Ends the line, so that what follows begins a new one.
  void end();

 private:
  bool quiet_;
  bool terminal_;
  bool open_ = false;
  double last_s_ = -1e9;
};

}  // namespace pf::capture

#endif
