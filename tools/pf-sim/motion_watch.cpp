#include "motion_watch.h"

#include "statistics.h"

namespace pfsim {

using pf::sim::Mat3;
using pf::sim::Pose;
using pf::sim::Vec3;

void MotionWatch::look(pf_slam_t* slam, pf_status_t status, const Pose& truth, FrameRow& row) {
  if (frames_ == 0) return;
  pf_motion_t motion;
  if (since_ >= 0) ++since_;
  if (since_ >= 0 && pf_get_motion_since_mark(slam, &motion) != PF_OK) since_ = -1;  // the map of the mark is gone
  if (since_ >= 0 && since_ < frames_) return;
  if (since_ >= 0 && status == PF_OK) {
    // The truth's own motion, in its own camera K.
    const Mat3 R_KW = at_mark_.R_WC.transposed();
    const Vec3 theta = rotation_log(R_KW * truth.R_WC * pf::sim::rotation_of(motion.q_KC).transposed());
    const Vec3 p_KC = R_KW * (truth.p_WC - at_mark_.p_WC);
    const Vec3 e = p_KC - Vec3{motion.p_KC[0], motion.p_KC[1], motion.p_KC[2]};
    const double error[6] = {theta.x, theta.y, theta.z, e.x, e.y, e.z};
    row.nees_motion = static_cast<float>(normalised_error(error, motion.covariance, 6, 6, 0));
    row.nees_motion_rotation = static_cast<float>(normalised_error(error, motion.covariance, 3, 6, 0));
    row.nees_motion_translation = static_cast<float>(normalised_error(error + 3, motion.covariance, 3, 6, 3));
  }
  since_ = -1;
  if (status != PF_OK) return;
  const pf_status_t marked = pf_mark_pose(slam);
  without_room_ += marked == PF_ERROR_FULL;
  if (marked != PF_OK) return;
  since_ = 0;
  at_mark_ = truth;
}

}  // namespace pfsim
