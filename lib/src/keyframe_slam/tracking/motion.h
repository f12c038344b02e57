#pragma once

#include <cstdint>

#include "filter/motion.h"
#include "frame/settings.h"
#include "geometry/similarity.h"
#include "vision/appearance.h"

/// The body of the window: pose and velocities with their covariance, predicted by the motion model and corrected by measured poses.

namespace pf {

class Archive;

class KeyframeMotion {
 public:
  static constexpr int kMaxRows = BodyLayout::kVelocityRows;
  using Covariance = Eigen::Matrix<Scalar, kMaxRows, kMaxRows>;
  using Wide6 = Eigen::Matrix<double, 6, 6>;  ///< of a measured pose

  explicit KeyframeMotion(const Settings& settings) : settings_(settings) {}

  void init() { data_ = Data(); }
  /// Sets the body. pose: covariance of (theta, p); speed, rate: standard deviations of the velocities [m/s, rad/s].
  void set(const Body& body, const Mat6& pose, Scalar speed, Scalar rate);

  /// Known change of the velocities in camera axes, until the next frame.
  void push_control(const Vec3& dv_C, const Vec3& dw_C) {
    data_.dv_C += dv_C;
    data_.dw_C += dw_C;
  }
  void forget_control() { data_.dv_C = data_.dw_C = Vec3::Zero(); }
  /// The body as something else has predicted it to the frame's time, in place of advance(); or as it was before a measurement.
  /// max_nis: another prediction can be tried, and a pose with a NIS above this contradicts this one; 0: there is no other.
  void set_prediction(const Body& body, const Covariance& P, Scalar max_nis = 0) {
    data_.body = body;
    data_.P = P;
    data_.max_nis = max_nis;
    data_.measured.is_set = false;
  }
  /// Predicts the body from one frame's time to the next, with the control that was pushed. Without measurements its speed decays.
  void advance(std::int64_t before_ns, std::int64_t t_ns, bool coasting_or_lost, bool nothing_measured);
  /// Updates the body with a pose that was measured with covariance R. The pose becomes the measured one, which allows for the prediction
  /// already; velocities and covariance follow by Kalman's gain
  ///
  ///   K = P Hᵀ S⁻¹,   P+ = P - K S Kᵀ,   S = P_pp + R,   H = (I 0)
  ///
  /// where the pose's part is (I - K_p) P_pp (I - K_p)ᵀ + K_p R K_pᵀ with I - K_p = R S⁻¹, and its covariance with the velocities
  /// K_v R: where the pose was hardly known before, rounding would leave nothing of the difference. In double in both libraries, and R with
  /// it: where matches leave a direction open, float inverts their information to what is no covariance.
  ///
  /// False where P_pp + R is no covariance; nothing has changed then.
  bool correct(const Quat& q_WC, const Vec3& p_W, const Wide6& R);
  /// Moves the body with the map after an adjustment. The velocities rotate and scale with it.
  void move(const Quat& q_WC, const Vec3& p_W) {
    data_.body.v_W = q_WC * (data_.body.q_WC.conjugate() * data_.body.v_W);
    data_.body.q_WC = q_WC;
    data_.body.p_W = p_W;
  }
  /// Sets the velocities alone, and leaves their covariance.
  void set_velocities(const Vec3& v_W, const Vec3& w_C) {
    data_.body.v_W = v_W;
    data_.body.w_C = w_C;
  }
  /// With an inertial unit: what this frame's pixels alone have measured of the pose. A fit x to them and to the prediction x_p, with its
  /// covariance P, is
  ///
  ///   (P⁻¹ + R⁻¹) x = P⁻¹ x_p + R⁻¹ z,   z = x + R P⁻¹ (x - x_p)
  struct MeasuredPose {
    bool is_set = false;
    Quat q_WC = Quat::Identity();
    Vec3 p_W = Vec3::Zero();
    Mat6 R = Mat6::Zero();
  };
  const MeasuredPose& measured() const { return data_.measured; }
  Scalar max_nis() const { return data_.max_nis; }  ///< of set_prediction()
  /// All of W is moved.
  void move(const Similarity& T);
  /// Sets the pose's covariance alone, and drops its correlation with the velocities.
  void set_pose_covariance(const Mat6& pose);

  const Body& body() const { return data_.body; }
  CameraView view() const { return {data_.body.q_WC, data_.body.p_W}; }
  Mat6 pose_covariance() const { return data_.P.topLeftCorner<6, 6>(); }
  /// Of (theta, p, v, w).
  const Covariance& covariance() const { return data_.P; }
  bool is_sound() const;
  /// Body and pose covariance at t_ns, predicted if it is after now_ns.
  void predict_pose(std::int64_t now_ns, std::int64_t t_ns, Body* body, Mat6* covariance) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// What is kept between frames.
  struct Data {
    Body body;
    Covariance P = Covariance::Zero();  ///< of (theta, p, v, w); without velocities their rows are zero
    Vec3 dv_C = Vec3::Zero(), dw_C = Vec3::Zero();
    MeasuredPose measured;
    Scalar max_nis = 0;
  };

  /// With an inertial unit too: it moves another body, and this one where its samples cannot.
  bool has_velocity() const { return settings_.constant_velocity || settings_.inertial; }
  BodyLayout layout() const { return settings_.inertial ? BodyLayout::with_constant_velocity() : settings_.body; }
  void predict(const Body& body, Scalar dt, const MotionNoise& noise, Transition* transition) const;
  static void apply(const Transition& transition, Data* data);
  void damp(Scalar dt);

  const Settings& settings_;
  Data data_;
};

}  // namespace pf
