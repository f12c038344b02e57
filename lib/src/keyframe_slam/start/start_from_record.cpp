#include <algorithm>

#include "base/elapsed.h"
#include "frame/start/tuning.h"
#include "geometry/so3.h"
#include "keyframe_slam/start/start.h"
#include "keyframe_slam/tracking/tuning.h"

/// KeyframeStart where a record has been solved.

namespace pf {

using namespace tuning::keyframe_start;
namespace assumed = tuning::filter_start;

/// Velocities between the last frames of the record.
void KeyframeStart::set_speeds(Body* body) const {
  const StartRecord& record = without_.record();
  const int last = record.frames() - 1, before = std::max(0, last - kSpeedFrames);
  if (!settings_.constant_velocity || before >= last) return;
  const CameraView then = without_.view(before), now = without_.view(last);
  const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(record.frame(before).t_ns, record.frame(last).t_ns)));
  body->v_W = (now.c_W - then.c_W) / dt;
  body->w_C = log_so3(then.q_WC.conjugate() * now.q_WC) / dt;
}

/// Depths and poses of the solved record. The frame becomes a keyframe, and velocities are those of the record's last frames.
void KeyframeStart::take_record() {
  data_.solved_before = 0;
  const StartRecord& record = without_.record();
  const int last = record.frames() - 1;
  const CameraView now = without_.view(last);
  for (int k = 0; k <= last && data_.second.given; ++k) {
    if (!data_.second.is_frame(record.frame(k).t_ns)) continue;
    data_.second.estimated = true;
    data_.second.estimate_W = without_.view(k).c_W;
  }
  KeyframeMap& map = parts_.map;
  for (int i = 0; i < map.capacity(); ++i) {
    if (!map.used(i)) continue;
    const int index = without_.index_of(map.feature(i).id);
    KeyframePoint& point = map.point(i);
    if (index >= 0 && without_.bundle().good(index)) {
      point.ray_K = record.ray(index).normalized();
      point.rho = without_.bundle().rho(index) / record.ray(index).norm();
      point.has_depth = true;
    } else if (index >= 0) {
      map.drop(i);
      continue;
    } else {
      point.has_depth = false;  // by poses that are no longer
    }
    for (int k = last; k >= 0; --k) {
      if (record.frame(k).t_ns != map.feature(i).last_seen_ns) continue;
      point.seen_from = without_.view(k);
      break;
    }
  }
  Body body = parts_.motion.body();
  body.q_WC = now.q_WC;
  body.p_W = now.c_W;
  set_speeds(&body);
  Mat6 P = Mat6::Identity() * (kRotationSigma * kRotationSigma);
  P.bottomRightCorner<3, 3>() *= settings_.start_depth * settings_.start_depth;
  parts_.motion.set(body, P, kSpeedSigma * settings_.start_depth, assumed::kStartRate);
  map.add_keyframe(parts_.frame.report.t_ns, now.q_WC, now.c_W);
  for (int t = 0; t < parts_.frame.match_count(); ++t) {
    const Match& match = parts_.frame.match(t);
    if (match.feature >= 0 && match.status == MatchStatus::kInlier) map.point(match.feature).seen_from = now;
  }
  for (int i = 0; i < map.capacity(); ++i)
    if (map.used(i) && map.point(i).has_depth) map.point(i).variance = parts_.adjustment.variance_of(i);
  if (!progress().recording) without_.init();
}

}  // namespace pf
