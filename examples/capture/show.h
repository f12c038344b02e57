#ifndef PLANEFOLD_CAPTURE_SHOW_H
#define PLANEFOLD_CAPTURE_SHOW_H

#include <memory>
#include <string>
#include <vector>

#include "options.h"
#include "session.h"
#include "view.h"

namespace pf::capture {

enum class Key { kNone, kPause, kReset, kSave, kQuit, kClick, kAnchor };

/// Everything that is drawn: the overlay, its film, its window and single pictures of it. In a build without Cairo (on a board
/// without a screen, say) nothing is.
class Show {
 public:
  Show();
  ~Show();
  Show(const Show&) = delete;
  Show& operator=(const Show&) = delete;

  /// notes  lines on what there will not be (no ffmpeg, no display); the run goes on without
  void open(const Options& options, const Session& session, const std::string& title, const std::string& film,
            double rate_hz, std::vector<std::string>& notes);
  /// Remembers the frame and, where there is a film or a window, draws it.
  void add(const FrameView& view);
  /// Shows the frame that was added last again, with what was pointed at since.
  void redraw(const FrameView& view);
  /// false: the picture could not be written.
  bool save(const FrameView& view, const std::string& path);
  /// The next key that was pressed; waits for up to wait_ms.
  Key poll(int wait_ms);
  /// Where the last kClick was, or of kAnchor the pointer, as a pixel of the frame. false: outside of it.
  bool clicked_pixel(double pixel[2]) const;
  bool is_filming() const;
  /// The film ended early, on a full disk say.
  bool has_film_failed() const;
  /// false: the film is not complete.
  bool close_film();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace pf::capture

#endif
