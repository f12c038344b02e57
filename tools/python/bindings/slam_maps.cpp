#include <nanobind/stl/vector.h>

#include <vector>

#include "context.h"
#include "docs.h"

namespace pf::python {

namespace {

/// All of a list that the library copies out, however many there are.
template <class T>
std::vector<T> list(Context& self, const char* call,
                    pf_status_t (*ask)(const pf_slam_t*, T* out, size_t capacity, size_t* count)) {
  std::vector<T> all(32);
  size_t count = 0;
  while (self.run(call, [&](const pf_slam_t* context) { return ask(context, all.data(), all.size(), &count); }) ==
         PF_NOTE_TRUNCATED) {
    all.resize(count);
  }
  all.resize(count);
  return all;
}

}  // namespace

void add_maps(nb::class_<Context>& slam) {
  slam.def_prop_ro(
      "features", [](Context& self) { return list<pf_feature_t>(self, "features", pf_get_features); },
      doc::pf_get_features);
  slam.def_prop_ro(
      "planes", [](Context& self) { return list<pf_plane_t>(self, "planes", pf_get_planes); }, doc::pf_get_planes);
  slam.def_prop_ro(
      "anchors", [](Context& self) { return list<pf_anchor_t>(self, "anchors", pf_get_anchors); }, doc::pf_get_anchors);
  slam.def_prop_ro(
      "matches", [](Context& self) { return list<pf_match_t>(self, "matches", pf_get_matches); }, doc::pf_get_matches);
  slam.def_prop_ro(
      "patches", [](Context& self) { return list<pf_patch_t>(self, "patches", pf_get_patches); }, doc::pf_get_patches);
  slam.def_prop_ro(
      "imu_samples", [](Context& self) { return list<pf_imu_sample_t>(self, "imu_samples", pf_get_imu_samples); },
      doc::pf_get_imu_samples);
}

}  // namespace pf::python
