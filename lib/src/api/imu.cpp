#include <cmath>
#include <cstring>

#include "api/context.h"
#include "api/copy.h"

namespace {

constexpr double kMaxGyro = 1000.0;  // [rad/s]
constexpr double kMaxAccel = 1e5;    // [m/s^2]

bool within(const double* v, double max) {
  return std::fabs(v[0]) <= max && std::fabs(v[1]) <= max && std::fabs(v[2]) <= max;
}

/// With w not negative.
void copy_rotation(const pf::Quat& q, double* out) {
  const pf::Scalar sign = q.w() < 0 ? pf::Scalar(-1) : pf::Scalar(1), parts[4] = {q.w(), q.x(), q.y(), q.z()};
  for (int i = 0; i < 4; ++i) out[i] = static_cast<double>(sign * parts[i]);
}

}  // namespace

pf_status_t pf_push_imu(pf_slam_t* slam, const pf_imu_sample_t* samples, size_t count) {
  PF_BEGIN_CHANGE(slam);
  if (samples == nullptr && count > 0) return PF_ERROR_NULL;
  const pf::ImuLog& imu = slam->session.imu();
  for (size_t i = 0; i < count; ++i) {
    const pf_imu_sample_t& s = samples[i];
    if (!pf::finite(s.gyro, 3) || !pf::finite(s.accel, 3)) return PF_ERROR_NONFINITE;
    if (!within(s.gyro, kMaxGyro) || !within(s.accel, kMaxAccel)) return PF_ERROR_RANGE;
    if (i > 0 ? s.t_ns <= samples[i - 1].t_ns : imu.any() && s.t_ns <= imu.counts().last_ns) return PF_ERROR_TIME;
  }
  for (size_t i = 0; i < count; ++i) {
    pf::ImuSample sample = {samples[i].t_ns, {}, {}};
    for (int k = 0; k < 3; ++k) {
      sample.gyro[k] = static_cast<pf::Scalar>(samples[i].gyro[k]);
      sample.accel[k] = static_cast<pf::Scalar>(samples[i].accel[k]);
    }
    slam->session.push_imu(sample);
  }
  return in_call.end(PF_OK);
}

pf_status_t pf_get_imu_report(const pf_slam_t* slam, pf_imu_report_t* report) {
  PF_REQUIRE_CONTEXT(slam);
  if (report == nullptr) return PF_ERROR_NULL;
  const pf::ImuCounts& c = slam->session.imu().counts();
  *report = pf_imu_report_t();
  report->samples = c.samples;
  report->since_frame = c.since_frame;
  report->last_frame = c.last_interval;
  report->late = c.late;
  report->saturated = c.saturated;
  report->gaps = c.gaps;
  report->missing = c.missing;
  report->first_t_ns = c.first_ns;
  report->last_t_ns = c.last_ns;
  report->longest_ns = c.longest_ns;
  report->rate_hz = slam->session.imu().rate_hz();
  report->median_s = 1e-9 * static_cast<double>(c.median_ns);
  report->kept = slam->session.imu().held();
  report->used = slam->session.settings().inertial && slam->session.imu().any() ? 1 : 0;
  const pf::UnitDoubt doubt = slam->session.view().unit_doubt();
  report->rejected = doubt.doubted ? 1 : 0;
  report->rejected_s = 1e-9 * static_cast<double>(doubt.doubted_ns);
  report->reason = static_cast<int32_t>(doubt.reason);
  report->reason_value = static_cast<double>(doubt.reason_value);
  copy_rotation(pf::Quat(doubt.reason_R_CB.transpose()), report->reason_q_BC);
  report->gyro_density = static_cast<double>(doubt.gyro_density);
  report->accel_density = static_cast<double>(doubt.accel_density);
  return PF_OK;
}

pf_status_t pf_get_inertial(const pf_slam_t* slam, pf_inertial_t* inertial) {
  PF_REQUIRE_CONTEXT(slam);
  if (inertial == nullptr) return PF_ERROR_NULL;
  const pf::View view = slam->session.view();
  pf::InertialView unit;
  if (!view.inertial(&unit)) return PF_NOTE_NOTHING;
  *inertial = pf_inertial_t();
  pf::copy(unit.gravity_W, 3, inertial->gravity_W);
  pf::copy(unit.gyro_bias, 3, inertial->gyro_bias);
  pf::copy(unit.accel_bias, 3, inertial->accel_bias);
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) inertial->covariance[8 * i + j] = static_cast<double>(unit.covariance[i][j]);
  pf::repair_covariance(inertial->covariance, 8);
  for (int k = 0; k < 2; ++k) pf::copy(unit.axis_W[k], 3, inertial->gravity_axes_W[k]);
  inertial->metric = unit.metric ? 1 : 0;
  inertial->from_motion = unit.from_motion ? 1 : 0;
  inertial->resting = unit.resting ? 1 : 0;
  inertial->rests = static_cast<uint32_t>(unit.rests);
  inertial->map_id = view.tracking().map_id();
  copy_rotation(unit.q_BC, inertial->q_BC);
  pf::copy(unit.p_BC, 3, inertial->p_BC);
  inertial->delay_s = unit.delay_s;
  inertial->readout_s = unit.readout_s;
  for (int i = 0; i < 9; ++i) {
    inertial->gyro_matrix[i] = static_cast<double>(unit.intrinsics.D_w(i / 3, i % 3));
    inertial->accel_matrix[i] = static_cast<double>(unit.intrinsics.D_a(i / 3, i % 3));
  }
  static_assert(sizeof inertial->sigma == 18 * sizeof(double));
  double sigma[18];
  for (int i = 0; i < 18; ++i) sigma[i] = static_cast<double>(unit.sigma[i]);
  std::memcpy(&inertial->sigma, sigma, sizeof sigma);
  return PF_OK;
}

pf_status_t pf_get_imu_samples(const pf_slam_t* slam, pf_imu_sample_t* samples, size_t capacity, size_t* count) {
  PF_REQUIRE_CONTEXT(slam);
  if (count == nullptr || (samples == nullptr && capacity > 0)) return PF_ERROR_NULL;
  *count = static_cast<size_t>(slam->session.imu().held());
  const size_t n = *count < capacity ? *count : capacity;
  for (size_t i = 0; i < n; ++i) {
    const pf::ImuSample& s = slam->session.imu()[static_cast<int>(i)];
    samples[i].t_ns = s.t_ns;
    for (int k = 0; k < 3; ++k) {
      samples[i].gyro[k] = static_cast<double>(s.gyro[k]);
      samples[i].accel[k] = static_cast<double>(s.accel[k]);
    }
  }
  return *count > capacity ? PF_NOTE_TRUNCATED : PF_OK;
}
