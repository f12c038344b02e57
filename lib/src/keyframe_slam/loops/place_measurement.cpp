#include "keyframe_slam/loops/place_measurement.h"

#include <algorithm>

#include "frame/ellipse.h"
#include "geometry/small_cholesky.h"
#include "geometry/symmetric_eigen.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/tracking/tuning.h"

namespace pf {

using namespace tuning::keyframe_tracking;

bool PlaceMeasurement::layout(Arena& arena) {
  if (settings_.kept.places == 0) return arena.ok();
  point_ = arena.take<Searched>(kCapacity);
  return pose_.layout(arena, kCapacity);
}

bool PlaceMeasurement::is_listed(int count, std::uint32_t id) const {
  return std::any_of(point_, point_ + count, [&](const Searched& s) { return s.point->id == id; });
}

/// As a point of the window that hangs together with the newest keyframe: where it is says nothing of the window's drift.
bool PlaceMeasurement::is_seen(std::uint32_t id) const {
  const int row = map_.tables().features.entry_of(id);
  return row >= 0 && map_.keyframes.pixels(map_.keyframes.newest())[row].seen;
}

/// By the covariance of the point in its place.
Mat2 PlaceMeasurement::spread_of(const Searched& s, const Mat26& J_pose) const {
  const Mat23 J = pixel_by_place_point(s.place->q_WK, J_pose);
  return J.lazyProduct(s.point->covariance_K()).lazyProduct(J.transpose()) + Mat2::Identity() * (kMapSigma * kMapSigma);
}

bool PlaceMeasurement::expect(const PosePrior& about, Searched* s) const {
  Mat26 J;
  if (!project_from_pose(map_.camera(), about.q_WC, about.p_W, s->p_W, Scalar(1), about.p_W, &s->predicted, &J))
    return false;
  const Mat26 JP = J.lazyProduct(about.covariance);
  s->innovation = JP.lazyProduct(J.transpose()) + spread_of(*s, J);
  return is_in_image(settings_.camera, s->predicted, static_cast<Scalar>(settings_.border_px)) &&
         is_covariance(s->innovation);
}

/// The most often observed ones first.
int PlaceMeasurement::list(const int* places, int count, const PosePrior& about) {
  int listed = 0;
  for (int a = 0; a < std::min(count, kMaxPlaces); ++a) {
    const KeptPlace& place = map_.places[places[a]];
    for (int i = 0; i < place.count; ++i) {
      Searched& s = point_[listed];
      s.place = &place;
      s.point = &place.point[i];
      s.p_W = place.position_W(i);
      if (!is_listed(listed, s.point->id) && !is_seen(s.point->id) && expect(about, &s)) ++listed;
    }
  }
  std::sort(point_, point_ + listed, [](const Searched& a, const Searched& b) {
    return a.point->observations != b.point->observations ? a.point->observations > b.point->observations
                                                          : a.point->id < b.point->id;
  });
  return listed;
}

bool PlaceMeasurement::find(const PosePrior& about, Searched* s, int* searched) const {
  Appearance appearance;
  restore_patch(s->point->patch, &appearance.patch);
  SearchTask task;
  task.appearance = &appearance;
  task.first_view = first_view_of(*s->place, *s->point);
  task.predicted = s->predicted;
  task.innovation = s->innovation;
  task.gate = settings_.gate;
  task.p_W = s->p_W;
  task.q_WC = about.q_WC;
  task.c_W = about.p_W;
  const SearchOutcome outcome = images_.search(task);
  *searched += outcome.comparable ? 1 : 0;
  if (!outcome.found || squared_distance(outcome.pixel - s->predicted, s->innovation) > settings_.gate) return false;
  const Scalar image = static_cast<Scalar>(settings_.camera.width) * static_cast<Scalar>(settings_.camera.height);
  s->measured = at_frame_time(map_.camera(), about.body(), s->p_W, Scalar(1), outcome.pixel);
  s->noise = noise_.match(outcome.noise, outcome.level_scale);
  s->area = std::min(image, ellipse_area(s->innovation, settings_.gate));
  return true;
}

int PlaceMeasurement::search(int found, int first, int end, const PosePrior& about, int* searched) {
  for (int c = first; c < end; ++c)
    if (find(about, &point_[c], searched)) std::swap(point_[found++], point_[c]);
  return found;
}

/// Consensus of what was found, and its evidence.
void PlaceMeasurement::fit(int found, int searched, const PosePrior& about, PlaceSighting* out) {
  for (int c = 0; c < found; ++c) {
    const Searched& s = point_[c];
    Vec2 z;
    Mat26 J = Mat26::Zero();
    project_from_pose(map_.camera(), about.q_WC, about.p_W, s.p_W, Scalar(1), about.p_W, &z, &J);
    pose_.match(c) = {{s.p_W, Scalar(1), s.measured}, noise_.correlation_frames() * s.noise + spread_of(s, J)};
  }
  const Scalar bound =
      std::max(kBoundWidth * static_cast<Scalar>(settings_.camera.width), kBoundSigmas * noise_.sigma_gate());
  out->pose = {about.q_WC, about.p_W};
  out->inliers = pose_.find(map_.camera(), found, about, bound, settings_.min_inliers, &out->pose, &out->information);
  out->consensus = PoseConsensus();
  out->consensus.searched = searched;
  if (out->inliers == 0) return;
  out->consensus.inliers = out->inliers;
  out->consensus.log_density =
      log_density(map_.camera(), &pose_.match(0), found, pose_.inliers(), about, out->pose, out->information);
  for (int c = 0; c < found; ++c)
    if (pose_.is_inlier(c)) out->consensus.log_chance += log_chance_density(point_[c].area);
}

/// In wide ellipses a few points first: with their pose the others are searched for in small ones.
PlaceSighting PlaceMeasurement::measure(const int* places, int count, const PosePrior& about,
                                        const PoseBelief& belief) {
  PlaceSighting out;
  int listed = list(places, count, about), found = 0, searched = 0;
  Scalar widest = 0;
  for (int c = 0; c < listed; ++c) widest = std::max(widest, symmetric_eigenvalues(point_[c].innovation)(1));
  PosePrior then = about;
  int scouts = 0;
  if (settings_.gate * widest > kWideEllipse * kWideEllipse && listed > kScouts) {
    scouts = kScouts;
    found = search(0, 0, scouts, about, &searched);
    fit(found, searched, about, &out);
    SmallCholesky<6> prior, posterior;
    if (out.inliers > 0 && PoseBelief::is_enough(belief.evidence(out.consensus)) && prior.factor(about.covariance) &&
        posterior.factor(Mat6(out.information + prior.inverse()))) {
      then.q_WC = out.pose.q_WC;
      then.p_W = out.pose.p_WC;
      then.covariance = posterior.inverse();
      int kept = scouts;
      for (int c = scouts; c < listed; ++c)
        if (expect(then, &point_[c])) std::swap(point_[kept++], point_[c]);
      listed = kept;
    }
  }
  found = search(found, scouts, listed, then, &searched);
  fit(found, searched, about, &out);
  return out;
}

}  // namespace pf
