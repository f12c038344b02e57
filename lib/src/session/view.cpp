#include "session/view.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "filter/gauge_information.h"
#include "filter/scale_row.h"
#include "filter_slam/filter_slam.h"
#include "geometry/so3.h"
#include "keyframe_slam/keyframe_slam.h"
#include "observe/point.h"
#include "track/template_warp.h"

namespace pf {

View::View(const Settings& settings, const Map& map, const FilterSlam& loop)
    : settings_(settings),
      map_(map),
      frame_(loop.frame()),
      tracking_(loop.tracking()),
      noise_(loop.noise()),
      loop_(&loop) {}

View::View(const Settings& settings, const Map& map, const KeyframeSlam& window)
    : settings_(settings),
      map_(map),
      frame_(window.frame()),
      tracking_(window.tracking()),
      noise_(window.noise()),
      window_(&window) {}

const Filter& View::filter() const { return loop_->filter(); }
bool View::used() const { return report().frames > 0; }
std::int64_t View::last_ns() const { return report().t_ns; }
SlamState View::state() const { return tracking_.state(); }
std::uint32_t View::map_id() const { return tracking_.map_id(); }
bool View::has_pose() const { return tracking_.has_pose(); }
const FrameReport& View::report() const { return frame_.report; }
const NoiseModel& View::noise() const { return noise_; }
int View::match_count() const { return frame_.match_count(); }
const Match& View::match(int i) const { return frame_.match(i); }
int View::state_dim() const { return filter().dim(); }

int View::kept_views() const { return window_ != nullptr ? window_->kept_views() : loop_->relocaliser().kept_views(); }

void View::pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const {
  if (window_ != nullptr) return window_pose_at(t_ns, body, covariance);
  // Of a frame that repeats the one before, the pose is that one's.
  loop_->motion().predict_pose(t_ns > last_ns() ? loop_->motion_begin_ns(loop_->filter_ns()) : t_ns, t_ns, body,
                               covariance);
  if (settings_.inertial) body->v_W = camera_velocity(*body, filter().state().mounting);
}

bool View::inertial(InertialView* out) const {
  if (!settings_.inertial || !has_pose()) return false;
  const Body& body = filter().state().body;
  const int gravity = settings_.body.row(BodyPart::kGravity), gyro = settings_.body.row(BodyPart::kGyroBias);
  out->gravity_W = settings_.unit.gravity * body.gravity_W();
  out->gyro_bias = body.gyro_bias;
  out->accel_bias = body.accel_bias;
  for (int k = 0; k < 2; ++k) out->axis_W[k] = body.q_WG.toRotationMatrix().col(k);
  const auto row = [&](int i) { return i < 2 ? gravity + i : gyro + i - 2; };  // the accelerometer's bias follows
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      out->covariance[i][j] = filter().covariance()(std::max(row(i), row(j)), std::min(row(i), row(j)));
  out->metric = filter().is_metric();
  out->from_motion = out->metric && loop_->metric().is_from_motion();
  out->resting = loop_->hold()->holds();
  out->rests = loop_->hold()->rests();
  for (int i = 0; i < 8; ++i) out->sigma[i] = std::sqrt(std::max(Scalar(0), out->covariance[i][i]));
  describe_mounting(out);
  ScaleRow l;
  if (out->metric && find_scale_row(filter(), &l))
    out->sigma[16] = std::sqrt(std::max(Scalar(0), filter().variance_of(l)));
  return true;
}

/// With R_CB_true = Exp(mu) R_CB and m_true = m + e_m:
///
///   R_BC_true = Exp(-R_BC mu) R_BC,   p_BC = -R_BC m:   e = -R_BC e_m - R_BC [m]x mu
void View::describe_mounting(InertialView* out) const {
  const Mounting mounting = loop_->start().mounting().now();
  const BodyLayout& layout = settings_.body;
  const Mat3 R_BC = mounting.R_CB.transpose();
  out->q_BC = Quat(R_BC);
  out->p_BC = -(R_BC * mounting.p_C);
  out->delay_s = seconds(settings_.unit.delay_ns) + static_cast<double>(mounting.delay);
  for (int i = 8; i < 17; ++i) out->sigma[i] = Scalar(-1);
  const int turn = layout.row(BodyPart::kMountRotation), place = layout.row(BodyPart::kMountPlace);
  const auto put_sigmas = [&](int first, const Mat3* by_turn, const Mat3* by_place) {
    RowsOf<3, 6, 2> J;
    J.parts = 0;
    const int columns = by_turn != nullptr && by_place != nullptr ? 6 : 3;
    int column = 0;
    const auto add = [&](int row, const Mat3* by) {
      if (by == nullptr) return;
      J.part[J.parts++] = Part::body(row, 3);
      put<3, 3>(J.h, columns, column, *by);
      column += 3;
    };
    add(turn, by_turn);
    add(place, by_place);
    const Mat3 C = filter().covariance_of<3>(J);
    for (int i = 0; i < 3; ++i) out->sigma[first + i] = std::sqrt(std::max(Scalar(0), C(i, i)));
  };
  const Mat3 by_turn = -R_BC.lazyProduct(hat(mounting.p_C)), minus = -R_BC;
  if (turn >= 0) put_sigmas(8, &minus, nullptr);
  if (place >= 0) put_sigmas(11, turn >= 0 ? &by_turn : nullptr, &minus);
  if (layout.has(BodyPart::kDelay))
    out->sigma[14] = std::sqrt(std::max(Scalar(0), filter().variance(layout.row(BodyPart::kDelay))));
  out->readout_s = static_cast<double>(filter().lens().readout);
  const LensRows& lens = filter().state().lens_rows;
  if (lens.has_readout())
    out->sigma[15] = std::sqrt(std::max(Scalar(0), filter().variance(layout.row(BodyPart::kLens) + lens.count - 1)));
}

bool View::unit_doubted() const { return loop_ != nullptr && loop_->watch().doubted(); }
std::int64_t View::unit_doubted_ns() const { return loop_ != nullptr ? loop_->watch().doubted_ns() : 0; }

bool View::motion_since_mark(MotionView* out) const {
  if (window_ != nullptr) return window_motion_since_mark(out);
  if (map_.mark.camera < 0) return false;
  out->mark_ns = map_.mark.t_ns;
  filter().motion_since(map_.mark.camera, &out->q_KC, &out->p_KC, &out->covariance);
  return true;
}

const Camera& View::lens(Scalar covariance[kLensParameters][kLensParameters]) const {
  for (int i = 0; i < kLensParameters; ++i)
    for (int j = 0; j < kLensParameters; ++j) covariance[i][j] = Scalar(0);
  if (window_ != nullptr) return window_lens(covariance);
  const State& state = filter().state();
  const LensRows& rows = state.lens_rows;
  const int first = state.layout.row(BodyPart::kLens);
  for (int i = 0; i < rows.count; ++i)
    for (int j = 0; j < rows.count; ++j)
      covariance[rows.parameter[i]][rows.parameter[j]] = filter().covariance()(first + i, first + j);
  return state.lens;
}

bool View::project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const {
  if (window_ != nullptr) return window_project(p_W, pixel, covariance);
  const State& state = filter().state();
  const CameraAt camera = camera_at(state, Scalar(0));
  Mat26 J_camera;
  Mat23 J_point;
  if (!observe_point(state.lens, camera, p_W, pixel, &J_camera, &J_point)) return false;
  if (covariance == nullptr) return true;
  Body body;
  Mat6 P;
  pose_at(last_ns(), &body, &P);
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
      *covariance += filter().covariance()(first + i, first + j) * by_i * Vec2(h[j], h[lens_rows + j]).transpose();
    for (int j = 0; j < Body::kPoseDim; ++j) {
      const Mat2 cross = filter().covariance()(first + i, j) * by_i * J_camera.col(j).transpose();
      *covariance += cross + cross.transpose();
    }
  }
  return true;
}

bool View::gauge_information(double* scratch, double* information) const {
  return pf::gauge_information(filter(), scratch, information);
}

FeatureView View::feature(int i) const {
  if (window_ != nullptr) return window_feature(i);
  const Feature& f = map_.features[i];
  const State& state = filter().state();
  FeatureView out;
  out.id = f.id;
  out.external_id = f.external_id;
  out.is_target = f.is_target;
  out.observations = f.observations;
  out.attempts = f.attempts;
  out.kind = state.block[f.slot].kind;
  out.plane = is_planar(out.kind) ? map_.planes.id_at(state.plane_of(f.slot)) : 0;
  out.p_W = filter().point(f.slot);
  out.covariance = filter().covariance3(f.slot);
  return out;
}

int View::patch_capacity() const {
  return loop_ != nullptr && loop_->patches() != nullptr ? loop_->patches()->patches().capacity() : 0;
}
bool View::has_patch(int i) const { return loop_->patches()->patches().used(i); }

PatchView View::patch(int i) const {
  const StoredPatch& p = loop_->patches()->patches()[i];
  return {p.id,          p.wait.waits() ? 0 : p.plane, static_cast<int>(p.status), p.frames, p.corner,
          &p.covariance, static_cast<Scalar>(p.weight)};
}

std::uint8_t TemplateView::grey(int x, int y) const {
  const int from_x = static_cast<int>(patch->centre_x[0] + 0.5f) - shape->side / 2 + x;
  const int from_y = static_cast<int>(patch->centre_y[0] + 0.5f) - shape->side / 2 + y;
  return patch->pixels[0][from_y * SourcePatch::kSize + from_x];
}

/// Normal of the plane that a feature lies on, towards a viewer. False where it lies on none.
bool View::surface_of(int i, const Vec3& viewer_W, Vec3* normal_W) const {
  if (window_ != nullptr) return window_surface_of(i, viewer_W, normal_W);
  const State& state = filter().state();
  const int slot = map_.features[i].slot;
  if (!is_planar(state.block[slot].kind)) return false;
  const Block& plane = state.block[state.plane_of(slot)];
  Scalar d;
  plane_normal(state.frame_of(plane), plane.xyz(), normal_W, &d);
  if (normal_W->dot(viewer_W - filter().point(slot)) < 0) *normal_W = -*normal_W;
  return true;
}

bool View::template_of(std::uint32_t id, TemplateView* out) const {
  if (!map_.has_templates()) return false;
  int i = 0;
  while (i < map_.features.capacity() && !(map_.features.used(i) && map_.features[i].id == id)) ++i;
  if (i == map_.features.capacity() || !map_.features[i].has_appearance) return false;
  const PlanarTemplate& shape = map_.shape(i);
  const Camera& camera = settings_.camera;
  Vec3 ray;
  if (!unproject(camera, template_centre(shape), &ray) || !(ray.z() > Scalar(0))) return false;
  *out = {&shape, map_.mask(i), &map_.appearance(i).patch, Vec3::Zero(), Scalar(0)};
  const CameraView& first = map_.first_view(i);
  if (surface_of(i, first.c_W, &out->normal_W)) return true;
  TemplateWarp warp;
  warp.ray_0 = ray.head<2>() / ray.z();
  const Vec2 slope = shape.has_normal ? Vec2(shape.slope[0], shape.slope[1]) : warp.facing();
  out->normal_W = first.q_WC * warp.normal_of(slope);
  // A slope turns the normal by no more than itself over the normal's length.
  const Scalar trace = static_cast<Scalar>(shape.covariance[0] + shape.covariance[2]) / 2;
  const Scalar apart = static_cast<Scalar>(shape.covariance[0] - shape.covariance[2]) / 2;
  const Scalar cross = static_cast<Scalar>(shape.covariance[1]);
  const Scalar length = Vec3(slope.x(), slope.y(), 1 - slope.dot(warp.ray_0)).norm();
  out->sigma_normal = std::sqrt(trace + std::sqrt(apart * apart + cross * cross)) / length;
  return true;
}

MapCounts View::counts() const {
  if (window_ != nullptr) return window_counts();
  const State& state = filter().state();
  MapCounts counts;
  int unfolded_rows = 0;
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!map_.features.used(i)) continue;
    ++counts.features;
    const Block& block = state.block[map_.features[i].slot];
    switch (info(block.kind).form) {
      case FeatureForm::kPoint:
        ++counts.points;
        break;
      case FeatureForm::kFolded:
        ++counts.folded;
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
  if (loop_->patches() != nullptr) {
    counts.patches = loop_->patches()->patches().count();
    counts.cameras = loop_->patches()->patches().cameras();
  }
  counts.state_dim = filter().dim();
  counts.state_dim_held = filter().blocks().held_dim();
  counts.state_dim_points_only = filter().dim() + unfolded_rows;
  return counts;
}

}  // namespace pf
