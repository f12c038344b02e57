#include "session/filter_reader.h"

#include "base/table_entries.h"
#include "filter_slam/filter_slam.h"
#include "observe/point.h"

namespace pf {

FilterReader::FilterReader(const Settings& settings, const Map& map, const FilterSlam& slam)
    : settings_(settings), map_(map), slam_(slam), filter_(slam.filter()) {}

int FilterReader::kept_views() const { return slam_.images().relocaliser().kept_views(); }

void FilterReader::pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const {
  slam_.predict_pose(t_ns, body, covariance);
  if (settings_.inertial) body->v_W = camera_velocity(*body, filter_.state().mounting);
}

bool FilterReader::motion_since_mark(MotionView* out) const {
  if (map_.mark.camera < 0) return false;
  out->mark_ns = map_.mark.t_ns;
  filter_.motion_since(map_.mark.camera, &out->q_KC, &out->p_KC, &out->covariance);
  return true;
}

const Camera& FilterReader::lens(Scalar covariance[kLensParameters][kLensParameters]) const {
  const State& state = filter_.state();
  const LensRows& rows = state.lens_rows;
  const int first = state.layout.row(BodyPart::kLens);
  for (int i = 0; i < rows.count; ++i)
    for (int j = 0; j < rows.count; ++j)
      covariance[rows.parameter[i]][rows.parameter[j]] = filter_.covariance()(first + i, first + j);
  return state.lens;
}

bool FilterReader::project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const {
  const State& state = filter_.state();
  const CameraAt camera = camera_at(state, Scalar(0));
  Mat26 J_camera;
  Mat23 J_point;
  if (!observe_point(state.lens, camera, p_W, pixel, &J_camera, &J_point)) return false;
  if (covariance == nullptr) return true;
  Body body;
  Mat6 P;
  pose_at(slam_.frame().report.t_ns, &body, &P);
  const Mat26 JP = J_camera.lazyProduct(P);
  *covariance = JP.lazyProduct(J_camera.transpose());
  const int lens_rows = state.lens_rows.count;
  if (lens_rows == 0) return true;
  Scalar h[2 * kLensParameters];
  put_lens(lens_jacobian(state.lens, camera.q_WC.conjugate() * (p_W - camera.p_W)), state.lens_rows, 0, lens_rows, h);
  const int first = state.layout.row(BodyPart::kLens);
  for (int i = 0; i < lens_rows; ++i) {
    const Vec2 by_i(h[i], h[lens_rows + i]);
    for (int j = 0; j < lens_rows; ++j)
      *covariance += filter_.covariance()(first + i, first + j) * by_i * Vec2(h[j], h[lens_rows + j]).transpose();
    for (int j = 0; j < Body::kPoseDim; ++j) {
      const Mat2 cross = filter_.covariance()(first + i, j) * by_i * J_camera.col(j).transpose();
      *covariance += cross + cross.transpose();
    }
  }
  return true;
}

void FilterReader::place_feature(int i, FeatureView* out) const {
  const Feature& f = map_.features[i];
  const State& state = filter_.state();
  out->kind = state.block[f.slot].kind;
  out->plane = is_planar(out->kind) ? map_.planes.id_at(state.plane_of(f.slot)) : 0;
  out->p_W = filter_.point(f.slot);
  out->covariance = filter_.covariance3(f.slot);
}

bool FilterReader::surface_of(int i, const Vec3& viewer_W, Vec3* normal_W) const {
  const State& state = filter_.state();
  const int slot = map_.features[i].slot;
  if (!is_planar(state.block[slot].kind)) return false;
  const Block& plane = state.block[state.plane_of(slot)];
  Scalar d;
  plane_normal(state.frame_of(plane), plane.xyz(), normal_W, &d);
  if (normal_W->dot(viewer_W - filter_.point(slot)) < 0) *normal_W = -*normal_W;
  return true;
}

MapCounts FilterReader::counts() const {
  const State& state = filter_.state();
  MapCounts counts;
  int unfolded_rows = 0;
  for (const int i : used_entries(map_.features)) {
    ++counts.features;
    const Block& block = state.block[map_.features[i].slot];
    switch (info(block.kind).form) {
      case FeatureForm::kPoint:
        ++counts.points;
        break;
      case FeatureForm::kFolded:
        ++(map_.features[i].on_trial ? counts.trial : counts.folded);
        break;
      case FeatureForm::kFixed:
        ++counts.fixed;
        break;
      default:
        ++counts.inverse_depths;
    }
    if (is_planar(block.kind)) unfolded_rows += 3 - block.size;
  }
  for (int s = 0; s < state.slots; ++s)
    if (info(state.block[s].kind).carries_points) unfolded_rows -= state.block[s].size;
  counts.planes = state.planes;
  if (const PatchKeeper* const keeper = slam_.upkeep().patches()) {
    counts.patches = keeper->patches().count();
    counts.cameras = keeper->patches().cameras();
  }
  if (const FilterMemory* const memory = slam_.upkeep().memory()) {
    counts.places = memory->table().count();
    counts.places_returned = memory->table().returned();
  }
  counts.state_dim = filter_.dim();
  counts.state_dim_held = filter_.blocks().held_dim();
  counts.state_dim_points_only = filter_.dim() + unfolded_rows;
  return counts;
}

}  // namespace pf
