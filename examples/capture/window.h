#ifndef PLANEFOLD_CAPTURE_WINDOW_H
#define PLANEFOLD_CAPTURE_WINDOW_H

#include <memory>
#include <string>

#include "canvas.h"
#include "show.h"

namespace pf::capture {

/// A window that shows the overlay, where there is a display and SDL2 was there at build time.
class Window {
 public:
  Window();
  ~Window();
  /// false: why is one line; the run goes on without a window.
  bool open(const std::string& title, int width, int height, std::string& why);
  bool is_open() const { return parts_ != nullptr; }
  void show(const Canvas& canvas);
  /// Next key that was pressed; waits for up to wait_ms.
  Key poll(int wait_ms);
  /// Where the pointer is, or the last click or tap was, in the picture that is shown [px].
  void clicked_place(double place[2]) const {
    place[0] = click_[0];
    place[1] = click_[1];
  }

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
  double click_[2] = {-1.0, -1.0};
};

}  // namespace pf::capture

#endif
