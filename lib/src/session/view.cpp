#include "session/view.h"

#include <algorithm>
#include <cmath>

#include "filter/gauge_information.h"
#include "filter_slam/filter_slam.h"
#include "keyframe_slam/keyframe_slam.h"
#include "session/filter_reader.h"
#include "session/keyframe_reader.h"
#include "track/template_warp.h"

namespace pf {

namespace {

/// Gravity is exact, and the normal's error is alpha x_W + beta y_W.
TiltView tilt_against(const Vec3& gravity_W, const PlaneView& plane) {
  TiltView out;
  const Vec3 g_W = gravity_W / gravity_W.norm();
  const Mat2 C = plane.covariance.topLeftCorner<2, 2>();
  const Vec2 h(g_W.dot(plane.R_WP.col(0)), g_W.dot(plane.R_WP.col(1)));
  out.known = true;
  out.up = -plane.normal_W.dot(g_W);
  out.sigma_up = std::sqrt(std::max(Scalar(0), h.dot(C * h)));
  out.sigma_tilt = std::sqrt(std::max(Scalar(0), C.trace()));
  return out;
}

/// The same against the gravity that an inertial unit measures, independent of the plane: g may be rotated by d about two axes.
TiltView tilt_against(const InertialView& unit, const PlaneView& plane) {
  TiltView out = tilt_against(unit.gravity_W, plane);
  const Vec3 g_W = unit.gravity_W.normalized();
  Mat2 C;
  C << unit.covariance[0][0], unit.covariance[0][1], unit.covariance[1][0], unit.covariance[1][1];
  const Vec2 by_d(plane.normal_W.dot(unit.axis_W[0].cross(g_W)), plane.normal_W.dot(unit.axis_W[1].cross(g_W)));
  out.sigma_up = std::sqrt(out.sigma_up * out.sigma_up + std::max(Scalar(0), by_d.dot(C * by_d)));
  out.sigma_tilt = std::sqrt(out.sigma_tilt * out.sigma_tilt + std::max(Scalar(0), C.trace()));
  return out;
}

}  // namespace

View::View(const Settings& settings, const Map& map, const FilterSlam& slam)
    : settings_(settings),
      map_(map),
      frame_(slam.frame()),
      tracking_(slam.tracking()),
      noise_(slam.images().noise()),
      filter_(&slam) {}

View::View(const Settings& settings, const Map& map, const KeyframeSlam& slam)
    : settings_(settings),
      map_(map),
      frame_(slam.frame()),
      tracking_(slam.tracking()),
      noise_(slam.noise()),
      keyframes_(&slam) {}

/// f(reader of the back end that there is)
template <typename F>
decltype(auto) View::read(F&& f) const {
  return !kHasWindow || filter_ != nullptr ? f(FilterReader(settings_, map_, *filter_))
                                           : f(KeyframeReader(settings_, map_, *keyframes_));
}

int View::kept_views() const {
  return read([](const auto& reader) { return reader.kept_views(); });
}

const Camera& View::lens(Scalar covariance[kLensParameters][kLensParameters]) const {
  for (int i = 0; i < kLensParameters; ++i)
    for (int j = 0; j < kLensParameters; ++j) covariance[i][j] = Scalar(0);
  return read([&](const auto& reader) -> const Camera& { return reader.lens(covariance); });
}

void View::pose_at(std::int64_t t_ns, Body* body, Mat6* covariance) const {
  read([&](const auto& reader) { reader.pose_at(t_ns, body, covariance); });
}

bool View::motion_since_mark(MotionView* out) const {
  return read([&](const auto& reader) { return reader.motion_since_mark(out); });
}

Status View::save_map(const Vec3& gravity_W, MapWriter* out) const {
  const bool is_there =
      kHasMemory && settings_.kept.places > 0 && tracking_.has_pose() && tracking_.state() != SlamState::kStarting;
  if (!is_there) return Status::kState;
  return !kHasWindow || filter_ != nullptr ? filter_->upkeep().memory()->save(gravity_W, tracking_.map_id(), out)
                                           : keyframes_->mapping().saving().save(gravity_W, tracking_.map_id(), out);
}

bool View::project(const Vec3& p_W, Vec2* pixel, Mat2* covariance) const {
  return read([&](const auto& reader) { return reader.project(p_W, pixel, covariance); });
}

MapCounts View::counts() const {
  return read([](const auto& reader) { return reader.counts(); });
}

FeatureView View::feature(int i) const {
  const Feature& f = map_.features[i];
  FeatureView out;
  out.id = f.id;
  out.external_id = f.external_id;
  out.is_target = f.is_target;
  out.observations = f.observations;
  out.attempts = f.attempts;
  out.on_trial = f.on_trial;
  out.log_odds = static_cast<Scalar>(f.log_odds);
  read([&](const auto& reader) { reader.place_feature(i, &out); });
  return out;
}

PlaneView View::plane(int i) const {
  return read([&](const auto& reader) { return reader.plane(i); });
}

TiltView View::tilt(int i, const PlaneView& plane, const Vec3& given_W) const {
  if (given_W.norm() > Scalar(0)) return tilt_against(given_W, plane);
  if (filter_ != nullptr) return FilterReader(settings_, map_, *filter_).tilt(i);
  InertialView unit;
  return inertial(&unit) && unit.metric ? tilt_against(unit, plane) : TiltView();
}

bool View::hit(const Vec2& pixel, HitView* hit) const {
  return read([&](const auto& reader) { return reader.hit(pixel, hit); });
}

bool View::template_of(std::uint32_t id, TemplateView* out) const {
  if (!map_.has_templates()) return false;
  const int i = map_.features.entry_of(id);
  if (i < 0 || !map_.features[i].has_appearance) return false;
  const PlanarTemplate& shape = map_.shape(i);
  const Camera& camera = settings_.camera;
  Vec3 ray;
  if (!unproject(camera, template_centre(shape), &ray) || !(ray.z() > Scalar(0))) return false;
  *out = {&shape, map_.mask(i), &map_.appearance(i).patch, Vec3::Zero(), Scalar(0)};
  const CameraView& first = map_.first_view(i);
  if (read([&](const auto& reader) { return reader.surface_of(i, first.c_W, &out->normal_W); })) return true;
  TemplateWarp warp;
  warp.ray_0 = ray.head<2>() / ray.z();
  const Vec2 slope = shape.has_normal ? Vec2(shape.slope[0], shape.slope[1]) : warp.facing();
  out->normal_W = first.q_WC * warp.normal_of(slope);
  // A slope rotates the normal by no more than itself over the normal's length.
  const Scalar trace = static_cast<Scalar>(shape.covariance[0] + shape.covariance[2]) / 2;
  const Scalar apart = static_cast<Scalar>(shape.covariance[0] - shape.covariance[2]) / 2;
  const Scalar cross = static_cast<Scalar>(shape.covariance[1]);
  const Scalar length = Vec3(slope.x(), slope.y(), 1 - slope.dot(warp.ray_0)).norm();
  out->sigma_normal = std::sqrt(trace + std::sqrt(apart * apart + cross * cross)) / length;
  return true;
}

bool View::inertial(InertialView* out) const {
  return filter_ != nullptr ? read_inertial(settings_, *filter_, out) : read_inertial(settings_, *keyframes_, out);
}

UnitDoubt View::unit_doubt() const {
  return filter_ != nullptr ? read_unit_doubt(settings_, *filter_) : read_unit_doubt(settings_, *keyframes_);
}

bool View::gauge_information(double* scratch, double* information) const {
  return pf::gauge_information(filter_->filter(), scratch, information);
}

const PatchStore* View::patches() const {
  return filter_ != nullptr && filter_->upkeep().patches() != nullptr ? &filter_->upkeep().patches()->patches()
                                                                      : nullptr;
}

std::uint8_t TemplateView::grey(int x, int y) const {
  const int from_x = static_cast<int>(patch->centre_x[0] + 0.5f) - shape->side / 2 + x;
  const int from_y = static_cast<int>(patch->centre_y[0] + 0.5f) - shape->side / 2 + y;
  return patch->pixels[0][from_y * SourcePatch::kSize + from_x];
}

}  // namespace pf
