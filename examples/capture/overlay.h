#ifndef PLANEFOLD_CAPTURE_OVERLAY_H
#define PLANEFOLD_CAPTURE_OVERLAY_H

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "canvas.h"
#include "map_panel.h"
#include "session.h"
#include "view.h"

namespace pf::capture {

constexpr int kOverlayStripHeight = 40;  ///< of the line below the picture [px]

Colour state_colour(int32_t state);

/// Draws a frame with what was looked for and found in it, the map from above, and the state.
///
///   +----------------------+-----------+
///   |                      | map, from |
///   |  frame               | above     |
///   |                      +-----------+
///   |                      | numbers   |
///   +----------------------+-----------+
///   | state  text          time line   |
///   +----------------------------------+
class Overlay {
 public:
  /// title  what is written into the picture, e.g. the source
  Overlay(const Session& session, const std::string& title);

  /// Remembers what later pictures show of this frame (tails, path, time line). Call for every frame, in order.
  void add(const FrameView& view);
  /// Draws the frame that was added last.
  const Canvas& draw(const FrameView& view);

  /// Pixel of the frame at a place of the picture. false: the place is outside of the frame.
  bool pixel_at(const double place[2], double pixel[2]) const;

  int width() const { return canvas_.width(); }
  int height() const { return canvas_.height(); }

 private:
  struct Tail {
    std::deque<std::pair<double, double>> pixels;
    int64_t last_frame = 0;
  };

  void draw_image(const pf_image_t& image);
  void draw_target(const FrameView& view);
  void draw_patches(const FrameView& view);
  void draw_tracks(const FrameView& view);
  void draw_hits(const FrameView& view);
  void draw_anchors(const FrameView& view);
  void draw_numbers(const FrameView& view, double x, double y, double width);
  void draw_strip(const FrameView& view);
  void draw_time_line(const FrameView& view);
  void remember_state(int32_t state);

  const Session& session_;
  std::string title_;
  double zoom_;
  int image_width_, image_height_, panel_width_;
  Canvas canvas_;
  MapPanel map_;
  std::map<uint32_t, Tail> tails_;
  std::vector<int32_t> time_line_;  ///< the worst state of column_frames_ frames each
  int64_t column_frames_ = 1;
  int64_t frames_ = 0;
  std::vector<unsigned char> grey_;  ///< the frame as BGRX
};

}  // namespace pf::capture

#endif
