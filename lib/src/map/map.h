#pragma once

#include "map/anchor_table.h"
#include "map/feature_table.h"
#include "map/plane_table.h"
#include "vision/appearance.h"
#include "vision/planar_template.h"

/// The map beside the filter: features, their appearances, planes and anchors, as plain tables behind one handle. Rows hold no pointers, so
/// that they can be copied and written to a file.

namespace pf {

class Archive;

/// The pose that the caller marked.
struct Mark {
  int camera = -1;        ///< slot of its reference camera, which it pins; -1: there is none
  std::int64_t t_ns = 0;  ///< of the frame
};

class Map {
 public:
  FeatureTable features;
  PlaneTable planes;
  AnchorTable anchors;
  Mark mark;
  Vec3 target_normal_W = Vec3::Zero();  ///< of the plane of the target's points; zero: they have none
  bool target_withdrawn = false;        ///< the target's points are no longer measured

  /// template_px: side of templates with masks; 0: there are none, and they take no memory.
  bool layout(Arena& arena, int max_features, int max_planes, int template_px = 0, int max_anchors = 0) {
    features.layout(arena, max_features);
    planes.layout(arena, max_planes);
    anchors.layout(arena, max_anchors);
    appearance_ = arena.take<Appearance>(static_cast<std::size_t>(max_features));
    first_view_ = arena.take<CameraView>(static_cast<std::size_t>(max_features));
    template_side_ = template_px;
    mask_size_ = template_px * template_px;
    if (template_px > 0) {
      template_ = arena.take<PlanarTemplate>(static_cast<std::size_t>(max_features));
      mask_ = arena.take<std::uint8_t>(static_cast<std::size_t>(max_features * mask_size_));
    }
    return arena.ok();
  }
  void init() {
    features.init();
    planes.init();
    anchors.init();
    mark = Mark();
    target_normal_W.setZero();
    target_withdrawn = false;
  }

  /// Appearance of a feature at first sight. Valid if the feature `has_appearance`.
  Appearance& appearance(int feature) { return appearance_[feature]; }
  const Appearance& appearance(int feature) const { return appearance_[feature]; }
  /// The camera that saw it then: a constant in W that does not follow when the map moves.
  CameraView& first_view(int feature) { return first_view_[feature]; }
  const CameraView& first_view(int feature) const { return first_view_[feature]; }
  /// Of a feature with an appearance, where has_templates().
  bool has_templates() const { return mask_size_ > 0; }
  PlanarTemplate& shape(int feature) { return template_[feature]; }
  const PlanarTemplate& shape(int feature) const { return template_[feature]; }
  std::uint8_t* mask(int feature) { return mask_ + feature * mask_size_; }
  const std::uint8_t* mask(int feature) const { return mask_ + feature * mask_size_; }

  void carry(Archive& archive, int slots);  ///< base/archive.h; slots: of blocks

 private:
  int template_side_ = 0, mask_size_ = 0;
  Appearance* appearance_ = nullptr;    ///< of each row of the feature table
  CameraView* first_view_ = nullptr;    ///< the same
  PlanarTemplate* template_ = nullptr;  ///< the same; null without masks
  std::uint8_t* mask_ = nullptr;        ///< the same, mask_size_ each
};

}  // namespace pf
