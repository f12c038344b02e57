#include "frame/start/start_without_target.h"

#include <algorithm>

#include "base/elapsed.h"
#include "model/camera_at.h"

namespace pf {

bool StartWithoutTarget::layout(Arena& arena, int lens_rows) {
  record_.layout(arena);
  bundle_.layout(arena, lens_rows);
  return arena.ok();
}

void StartWithoutTarget::init() {
  data_ = Data();
  record_.init();
  bundle_.init();
}

void StartWithoutTarget::begin_record(const Quat& q_WC, const Vec3& p_W, std::int64_t t_ns) {
  record_.init(t_ns);
  bundle_.init();
  data_.base_q_WC = q_WC;
  data_.base_p_W = p_W;
  data_.begin_ns = t_ns;
}

void StartWithoutTarget::add_feature(std::uint32_t id, const Vec3& ray_C) {
  const int index = record_.add_feature(ray_C);
  if (index >= 0) data_.id[index] = id;
}

void StartWithoutTarget::begin_frame(const Quat& q_WC, const Vec3& p_W, std::int64_t t_ns, bool held) {
  const Quat q_KW = data_.base_q_WC.conjugate();
  data_.is_second = record_.frames() == 0;
  data_.others = 0;
  data_.t_ns = t_ns;
  data_.frame = record_.add_frame(t_ns, q_KW * q_WC, q_KW * (p_W - data_.base_p_W));
  if (held) record_.hold_newest();
}

void StartWithoutTarget::add_pixel(const Camera& camera, std::uint32_t id, const Vec2& pixel) {
  const int index = index_of(id);
  if (index < 0) {
    ++data_.others;
    return;
  }
  if (data_.is_second && camera.readout != Scalar(0)) move_ray(camera, index, pixel);
  record_.add_pixel(data_.frame, index, pixel);
}

/// Corrects a ray of the record's first frame to the frame's time. The motion was unknown then; it is how far the pixel has moved
/// since.
void StartWithoutTarget::move_ray(const Camera& camera, int index, const Vec2& pixel) {
  const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(data_.begin_ns, data_.t_ns)));
  Vec2 first;
  Vec3 ray_C;
  if (!project(camera, record_.ray(index), &first)) return;
  const Vec2 moved = (pixel - first) / dt;
  if (unproject(camera, first - row_time(camera, first.y()) * moved, &ray_C)) record_.set_ray(index, ray_C);
}

void StartWithoutTarget::log(StartOutcome outcome, const Hooks& hooks) const {
  if (outcome == StartOutcome::kStill) {
    if (data_.stills > 1) return;
    return hooks.say("the camera stands still while something moves in the image, by a record of ", record_.features(),
                     " features in ", record_.frames() + 1, " frames: the start waits");
  }
  int known = 0;
  for (int i = 0; i < record_.features(); ++i) known += bundle_.good(i) ? 1 : 0;
  hooks.say("first depths without a target: ", known, " of ", record_.features(), " features have one, from ",
            record_.frames() + 1, " frames in ", fixed(seconds(elapsed_ns(data_.begin_ns, data_.t_ns)), 2), " s");
}

StartOutcome StartWithoutTarget::solve(const Camera& camera, Scalar sigma_px, Scalar median_depth) {
  if (stands_still(lens_of_record(camera), record_, data_.others)) {
    if (data_.progress.checking || data_.progress.depth_known) return StartOutcome::kWait;
    data_.stills = std::min(data_.stills + 1, 2);
    return StartOutcome::kStill;
  }
  const StartOutcome outcome = bundle_.solve(camera, record_, sigma_px, median_depth);
  StartProgress& progress = data_.progress;
  if (progress.checking) {
    if (outcome == StartOutcome::kTooFew) init();
  } else if (outcome == StartOutcome::kSolved || outcome == StartOutcome::kSettled) {
    progress.depth_known = true;
    progress.recording = outcome != StartOutcome::kSettled;
  } else if (outcome == StartOutcome::kTooFew) {
    progress.recording = !progress.depth_known;
    if (progress.recording) record_.init();
  }
  return outcome;
}

CameraView StartWithoutTarget::follow(const Camera& camera, Scalar sigma_px, Scalar depth, Scalar* rho) {
  bundle_.follow(camera, record_, sigma_px, depth, rho);
  return view(record_.frames() - 1);
}

bool StartWithoutTarget::baseline_covariance(const Camera& camera, Scalar sigma_px, Scalar median_depth,
                                             Mat3* covariance) const {
  if (!bundle_.baseline_covariance(camera, record_, sigma_px, median_depth, covariance)) return false;
  const Mat3 R_WK = data_.base_q_WC.toRotationMatrix();
  *covariance = (R_WK * *covariance * R_WK.transpose()).eval();
  return true;
}

CameraView StartWithoutTarget::view(int k) const {
  const StartRecord::Frame& frame = record_.frame(k);
  return {data_.base_q_WC * frame.q_WC, data_.base_p_W + data_.base_q_WC * frame.p_W};
}

int StartWithoutTarget::index_of(std::uint32_t id) const {
  for (int i = 0; i < record_.features(); ++i)
    if (data_.id[i] == id) return i;
  return -1;
}

}  // namespace pf
