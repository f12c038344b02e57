#ifndef PLANEFOLD_CAPTURE_TRACK_ROWS_H
#define PLANEFOLD_CAPTURE_TRACK_ROWS_H

#include <planefold/planefold.h>

#include <cstdint>
#include <string>
#include <vector>

#include "source.h"
#include "view.h"

namespace pf::capture {

/// Rows of tracks.csv and planes.csv: every feature that was looked for, and every plane, in every frame.
class TrackRows {
 public:
  static constexpr const char* kTracksHeader =
      "frame,id,status,kind,predicted_u,predicted_v,s_uu,s_uv,s_vv,measured_u,measured_v,plane,trial,surface,depth\n";
  static constexpr const char* kPlanesHeader =
      "frame,id,members,trial,normal_x,normal_y,normal_z,distance,sigma,area\n";

  /// surface and depth are what the source knows of its last frame at a feature's pixel; empty where it knows nothing.
  void add(const FrameView& view, Source& source, std::string& tracks, std::string& planes);

 private:
  void add_depth(const pf_match_t& track, int32_t width, int32_t height, std::string& tracks) const;

  std::vector<float> depth_;
  std::vector<int32_t> surface_;
  bool has_depth_ = false;
};

const char* match_name(int32_t status);

}  // namespace pf::capture

#endif
