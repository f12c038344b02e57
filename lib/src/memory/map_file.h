#pragma once

#include <cstddef>
#include <cstdint>

#include "base/limits.h"
#include "geometry/camera.h"
#include "geometry/plane.h"
#include "map/anchor_table.h"
#include "map/plane_outline.h"
#include "memory/map_bytes.h"
#include "memory/place.h"

/// What a saved map holds, section by section (lib/docs/reference/map_format.md). Knows no back end.

namespace pf {

constexpr std::uint32_t kMaxSavedId = 0x7fffffffu;  ///< of features, planes and places

/// A plane that lies in its frame.
struct SavedPlane {
  std::uint32_t id = 0;
  std::uint32_t max_points = 0;  ///< most that it had at one time
  PlaneFrame frame;
  Mat3 covariance = Mat3::Zero();  ///< of (a, b, h)
  PlaneOutline outline;
};

void write_lens(const Camera& camera, MapWriter* out);
/// gravity_W: zero where it is not known.
void write_world(const Vec3& gravity_W, MapWriter* out);
/// Sections of many things, in the order of their ids: this, all of them, end_section().
void begin_planes(int count, MapWriter* out);
void write_plane(const SavedPlane& plane, MapWriter* out);
void begin_places(int count, MapWriter* out);
void write_place(const KeptPlace& place, MapWriter* out);
void begin_anchors(int count, MapWriter* out);
/// One that a place, or W, holds.
void write_anchor(const Anchor& anchor, MapWriter* out);
/// The section of the anchors of a map, hold(anchor) -> Anchor: as it is held by a place that is written. Nothing where there are none.
template <typename Hold>
void write_anchors(const AnchorTable& anchors, std::uint32_t map_id, MapWriter* out, Hold&& hold) {
  int count = 0;
  for (const int i : used_entries(anchors)) count += anchors[i].map_id == map_id ? 1 : 0;
  if (count == 0) return;
  begin_anchors(count, out);
  for_each_by_id(anchors, [&](int i) {
    if (anchors[i].map_id == map_id) write_anchor(hold(anchors[i]), out);
  });
  out->end_section();
}

/// Reads a saved map. Nothing of it is to be used before open() has said that all of it is good.
class SavedMap {
 public:
  /// Reads and checks every number. Null, or what is wrong with it. scratch: for one place.
  const char* open(const std::uint8_t* buffer, std::size_t bytes, KeptPlace* scratch);

  const Camera& lens() const { return lens_; }  ///< that the map was made with, without a readout
  const Vec3& gravity_W() const { return gravity_W_; }
  int num_planes() const { return num_planes_; }
  int num_places() const { return num_places_; }
  int num_anchors() const { return num_anchors_; }
  /// The greatest ids.
  std::uint32_t last_feature() const { return last_feature_; }
  std::uint32_t last_place() const { return last_place_; }

  /// use(plane), and use(place) with each place read into the scratch, in the order of their ids.
  template <typename F>
  void for_each_plane(F&& use) const {
    MapReader in(planes_.bytes, planes_.count);
    in.u32();
    for (int k = 0; k < num_planes_; ++k) {
      SavedPlane plane;
      read_plane(&in, &plane);
      use(plane);
    }
  }
  template <typename F>
  void for_each_place(KeptPlace* scratch, F&& use) const {
    MapReader in(places_.bytes, places_.count);
    in.u32();
    for (int k = 0; k < num_places_; ++k) {
      read_place(&in, scratch);
      use(*scratch);
    }
  }
  /// use(anchor): what was written of it.
  template <typename F>
  void for_each_anchor(F&& use) const {
    MapReader in(anchors_.bytes, anchors_.count);
    if (num_anchors_ > 0) in.u32();
    for (int k = 0; k < num_anchors_; ++k) {
      Anchor anchor;
      read_anchor(&in, &anchor);
      use(anchor);
    }
  }

 private:
  const char* read_lens(const MapSection& section);
  const char* read_world(const MapSection& section);
  const char* check_planes(const MapSection& section);
  const char* check_places(const MapSection& section, KeptPlace* scratch);
  const char* check_anchors(const MapSection& section);
  bool has_plane(std::uint32_t id) const;
  bool has_place(std::uint32_t id) const;
  /// Null, or what is wrong with it.
  static const char* read_plane(MapReader* in, SavedPlane* plane);
  static const char* read_place(MapReader* in, KeptPlace* place);
  static const char* read_point(MapReader* in, PlacePoint* point);
  static const char* read_anchor(MapReader* in, Anchor* anchor);

  MapSection planes_, places_, anchors_;
  Camera lens_;
  Vec3 gravity_W_ = Vec3::Zero();
  int num_planes_ = 0, num_places_ = 0, num_anchors_ = 0;
  std::uint32_t plane_id_[kMaxPlanes] = {}, place_id_[kMaxPlaces] = {};
  std::uint32_t last_feature_ = 0, last_place_ = 0;
};

}  // namespace pf
