#pragma once

#include "filter/filter.h"
#include "filter/imu_log.h"
#include "frame/settings.h"
#include "inertial/rate_alignment.h"
#include "inertial/unit_evidence.h"
#include "inertial/unit_reason.h"

/// While samples do not move the body, since the unit is rejected or since its clock or its axes are not known: compares the camera's own
/// rates with the gyroscope's (RateAlignment). Where they fit, samples can be used; where they do not, the fit gives the reason. What each
/// reason means to a user: lib/docs/guide/unknown_unit.md.

namespace pf {

class Archive;

class RateCheck {
 public:
  RateCheck(const Settings& settings, const Filter& filter, const ImuLog& imu, const Frame& frame)
      : settings_(settings), filter_(filter), imu_(imu), frame_(frame) {}

  void init();
  /// Starts the comparison anew.
  void begin() {
    data_.rates.init();
    data_.begin.t_ns = 0;
  }
  /// Notes a frame whose prediction had no samples. doubts: how often the unit was rejected; each rejection lengthens the agreement that is
  /// required. True where the reason why no clock and no axes fit has just been found.
  bool note(const UnitFrame& frame, bool is_rejected, int doubts);
  /// Clock and axes that fit; null: none. After use() samples are used.
  const RateFit* fit() const { return data_.has_fit ? &data_.fit : nullptr; }
  void use() {
    data_.is_open = data_.has_fit = false;
    data_.reason = UnitReason::kNone;
  }
  /// Images contradict the samples: starts the comparison anew, with that as the reason.
  void contradict() {
    begin();
    data_.reason = UnitReason::kContradicts;
  }

  /// True where the clock or the axes are open and not found yet.
  bool is_open() const { return data_.is_open; }
  bool finds_axes() const;
  /// Why the samples do not move the body. *value: its number; *R_CB: the axes that fit, both as far as the reason has them.
  UnitReason reason(Scalar* value, Mat3* R_CB) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// The frame that the next interval of rates begins at.
  struct RateBegin {
    std::int64_t t_ns = 0;  ///< 0: there is none
    Quat q_WC = Quat::Identity();
    std::uint32_t generation = 0;  ///< of the filter: once it begins again from a record, its poses are others
  };
  struct Data {
    RateAlignment rates;
    RateBegin begin;
    int until_fit = 0;  ///< frames
    RateFit fit;
    bool has_fit = false;
    bool is_open = false;
    UnitReason reason = UnitReason::kNone;
    Scalar value = 0;
    Mat3 R_CB = Mat3::Identity();
  };

  double wanted_span(bool is_rejected, int doubts) const;
  bool is_believed(const RateFit& fit) const;
  bool find_reason(double at_s);
  Scalar mean_rate() const;

  const Settings& settings_;
  const Filter& filter_;
  const ImuLog& imu_;
  const Frame& frame_;
  Data data_;
};

}  // namespace pf
