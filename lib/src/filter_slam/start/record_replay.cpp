#include "filter_slam/start/record_replay.h"

#include <algorithm>

#include "base/elapsed.h"
#include "frame/noise_model.h"
#include "geometry/so3.h"

namespace pf {

void RecordReplay::run() {
  std::int64_t before_ns = record_.begin_ns();
  for (int k = 0; k < record_.record().frames(); ++k) {
    predict_to(record_.record().frame(k), before_ns);
    update_with(k);
    before_ns = record_.record().frame(k).t_ns;
  }
}

void RecordReplay::predict_to(const StartRecord::Frame& frame, std::int64_t before_ns) {
  const Scalar dt = static_cast<Scalar>(seconds(std::min(elapsed_ns(before_ns, frame.t_ns), BodyMotion::kMaxGapNs)));
  Body now = filter_.state().body;
  const Quat q_WC = record_.base_q_WC() * frame.q_WC;
  const Vec3 p_W = record_.base_p_W() + record_.base_q_WC() * frame.p_W * unit_;
  now.v_W = (p_W - now.p_W) / dt;
  now.w_C = log_so3(now.q_WC.conjugate() * q_WC) / dt;
  Transition transition;
  // Residuals of zero do not show whether the gyroscope agrees with the bundle's rotations, which come from the pixels alone.
  if (settings_.inertial)
    motion_.predict_coasting(now, before_ns, frame.t_ns, &transition);
  else
    motion_.predict(now, before_ns, frame.t_ns, settings_.motion_noise, &transition);
  transition.mean.q_WC = q_WC;
  transition.mean.p_W = p_W;
  filter_.predict(transition);
}

/// Its pixels are those of the frame's own time: with rows they would constrain the camera's velocity, which nothing has measured.
void RecordReplay::update_with(int k) {
  Camera global_shutter = filter_.lens();
  global_shutter.readout = Scalar(0);
  int count = 0;
  for (int i = 0; i < map_.features.capacity() && count < settings_.max_observations; ++i) {
    const Feature& f = map_.features[i];
    if (!map_.features.used(i) || f.is_target || !record_.record().seen(k, record_.index_of(f.id))) continue;
    PixelMeasurement& o = update_.observation(count);
    if (!filter_.predict_pixel(global_shutter, f.slot, &o)) continue;
    o.measured = o.predicted;
    o.set_noise(NoiseModel::search_update());
    ++count;
  }
  if (count == 0) return;
  filter_.begin_update(update_.observations(), count);
  filter_.finish_update(update_.observations(), count, nullptr, nullptr);
}

void RecordReplay::set_velocities() {
  const StartRecord& record = record_.record();
  const int frames = record.frames();
  const StartRecord::Frame& a = record.frame(frames > 4 ? frames - 4 : 0);
  const StartRecord::Frame& b = record.frame(frames - 1);
  if (b.t_ns <= a.t_ns) return;
  const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(a.t_ns, b.t_ns)));
  Body now = filter_.state().body;
  now.v_W = record_.base_q_WC() * (b.p_W - a.p_W) * unit_ / dt;
  now.w_C = log_so3(a.q_WC.conjugate() * b.q_WC) / dt;
  filter_.set_mean(now);
}

}  // namespace pf
