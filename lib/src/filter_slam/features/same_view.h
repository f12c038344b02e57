#pragma once

#include "model/body.h"

/// Whether a frame shows a view that has updated the map already: lib/docs/theory/noise.md, "At rest".

namespace pf {

class Archive;

/// The error of a match (lens, warp, first view) depends on the view, and repeats in every frame of a camera at rest. So a view counts as
/// often as it takes to be worth one independent measurement, tau frames; in those after them the map is considered and not estimated
/// (Schmidt), until the camera sees something else.
class SameView {
 public:
  void init() { data_ = Data(); }

  /// Whether the camera at this predicted pose has been in the present view for `enough` tracked frames.
  bool is_learnt(const Body& body, Scalar median_depth, Scalar focal_px, Scalar enough) const {
    return static_cast<Scalar>(data_.frames) >= enough && !has_moved(body, median_depth, focal_px);
  }
  /// Notes a tracked frame.
  void note(const Body& body, Scalar median_depth, Scalar focal_px);
  /// Notes any other frame.
  void forget() { data_.frames = 0; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    Quat q_WC = Quat::Identity();  ///< of the first frame of the view
    Vec3 p_W = Vec3::Zero();
    int frames = 0;  ///< in the view; 0: there is none
  };

  bool has_moved(const Body& body, Scalar median_depth, Scalar focal_px) const;

  Data data_;
};

}  // namespace pf
