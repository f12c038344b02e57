#include "filter_slam/memory/place_maker.h"

#include "base/table_entries.h"
#include "filter/known_camera.h"
#include "memory/tuning.h"
#include "model/reference_camera.h"

namespace pf {

using model::ReferenceCamera;

bool PlaceMaker::has_camera() const { return data_.camera >= 0 && data_.generation == filter_.generation(); }

void PlaceMaker::drop() {
  if (has_camera()) filter_.unpin(data_.camera);
  data_.camera = -1;
}

void PlaceMaker::follow(const CameraView& view, Scalar depth, KeptPlace* scratch) {
  constexpr int kRows = 6;
  const Scalar apart2 = tuning::place::kApart * tuning::place::kApart;
  if (has_camera() && filter_.block_is_sound(data_.camera)) {
    const Block& camera = filter_.state().block[data_.camera];
    if (view_distance2(view.q_WC, view.c_W, depth, ReferenceCamera::q_WC(camera), ReferenceCamera::p_WC(camera),
                       data_.depth) < apart2)
      return;
    if (make(scratch)) places_.keep(*scratch);
  }
  drop();
  for (const int p : used_entries(places_))
    if (view_distance2(view.q_WC, view.c_W, depth, places_[p].q_WK, places_[p].p_WK, places_[p].depth) < apart2) return;
  if (filter_.room() < kRows && !features_.make_rows(kRows, frame_.report.t_ns)) return;
  data_.camera = filter_.add_reference_camera();
  if (data_.camera < 0) return;
  filter_.pin(data_.camera);
  data_.generation = filter_.generation();
  data_.id = ++data_.last_id;
  data_.depth = depth;
}

/// The most often observed points: first those that no other place has, and of the others as many as a place needs.
bool PlaceMaker::make(KeptPlace* out) const {
  using namespace tuning::place;
  if (!has_camera() || !filter_.block_is_sound(data_.camera)) return false;
  const Block& camera = filter_.state().block[data_.camera];
  *out = KeptPlace();
  out->id = data_.id;
  out->q_WK = ReferenceCamera::q_WC(camera).normalized();
  out->p_WK = ReferenceCamera::p_WC(camera);
  RowsOf<6, 6, 1> J;
  J.parts = 1;
  J.part[0] = Part::of(data_.camera, 0, 6);
  put<6, 6>(J.h, 6, 0, Mat6::Identity());
  out->covariance = filter_.blocks().covariance_of<6>(J);  // W is the map's: without what all of W may be off
  for (const bool second : {false, true})
    for (const int i : used_entries(map_.features)) {
      if (second && out->count >= kMinPoints) break;
      PlacePoint point;
      if (is_taken(map_.features[i].id) == second && make_point(i, &point)) add_point(point, out);
    }
  if (out->count < kMinPoints) return false;
  out->depth = median_depth(*out);
  return true;
}

bool PlaceMaker::is_taken(std::uint32_t id) const {
  for (const int p : used_entries(places_))
    for (int i = 0; i < places_[p].count; ++i)
      if (places_[p].point[i].id == id) return true;
  return false;
}

/// False where the feature is not worth keeping, or the camera does not see it.
bool PlaceMaker::make_point(int i, PlacePoint* out) const {
  const Scalar most = tuning::place::kMaxDepthSigma * tuning::place::kMaxDepthSigma;
  const Feature& f = map_.features[i];
  if (!f.has_appearance || f.is_target || f.was_missed || f.on_trial) return false;
  Vec3 x_K;
  Mat3 C;
  Vec2 pixel;
  if (!point_given(filter_, data_.camera, f.slot, &x_K, &C) || !project(filter_.lens(), x_K, &pixel) ||
      !is_in_image(settings_.camera, pixel, static_cast<Scalar>(settings_.border_px)))
    return false;
  const Scalar along = x_K.dot(C * x_K) / x_K.squaredNorm();
  if (!(along < most * x_K.squaredNorm()) || !(C(0, 0) > Scalar(0) && C(1, 1) > Scalar(0) && C(2, 2) > Scalar(0)))
    return false;
  const Block& camera = filter_.state().block[data_.camera];
  const Quat q_KW = ReferenceCamera::q_WC(camera).conjugate();
  const CameraView& first = map_.first_view(i);
  out->id = f.id;
  const int slot = f.slot;
  out->plane = is_planar(filter_.state().block[slot].kind) ? map_.planes.id_at(filter_.state().plane_of(slot)) : 0;
  out->observations = f.observations;
  set_place_point(x_K, C, (q_KW * first.q_WC).normalized(), q_KW * (first.c_W - ReferenceCamera::p_WC(camera)),
                  map_.appearance(i).patch, out);
  return true;
}

}  // namespace pf
