#include "base/archive.h"
#include "filter_slam/planes/plane_keeper.h"

namespace pf {

void OwnPlaces::carry(Archive& archive) {
  for (int i = 0; i < map_.features.capacity(); ++i) {
    auto& [id, plane, place_W, ray_W, N, b] = own_[i];
    archive.any(id, plane);
    archive.numbers(place_W, ray_W, N, b);
  }
}

void VerticalTable::carry(Archive& archive) {
  for (int k = 0; told_ != nullptr && k < map_.planes.capacity(); ++k) {
    auto& [id, generation, row] = told_[k];
    auto& [sigma, before, n_W, g_W] = row;
    archive.any(id, generation);
    archive.numbers(sigma, before, n_W, g_W);
  }
}

void PlaneDiscovery::carry(Archive& archive) { archive.any(searches_); }

void WallFolding::carry(Archive& archive) {
  auto& [random, met_late] = data_;
  archive.any(random);
  archive.flags(met_late);
}

/// CertainPoints ask for the scale in each frame.
void PlaneKeeper::carry(Archive& archive) {
  places_.carry(archive);
  discovery_.carry(archive);
  walls_.carry(archive);
  verticals_.carry(archive);
}

}  // namespace pf
