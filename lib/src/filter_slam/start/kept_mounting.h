#pragma once

#include "base/arena.h"
#include "filter/filter.h"
#include "filter/imu_path.h"

/// How the inertial unit is mounted on the camera, its delay and its intrinsics: what a map begins with, which earlier maps may have
/// estimated.

namespace pf {

class KeptMounting {
 public:
  KeptMounting(const BodyLayout& layout, const ImuUnit& unit, const Filter& filter)
      : layout_(layout), unit_(unit), filter_(filter) {}

  /// Takes nothing where the mounting is not estimated.
  bool layout(Arena& arena);
  /// Maps begin with the mounting and the delay of the config.
  void init();
  /// Maps begin with the mounting and the delay as the filter knows them now. The filter has a pose.
  void keep();

  /// What a map begins with.
  const Mounting& initial() const { return kept_ != nullptr ? kept_->mounting : unit_.mounting; }
  /// Sets the block of a square row-major covariance of the layout's unit rows that belongs to initial().
  void put_covariance(Scalar* covariance) const;
  /// Where the unit is on the camera, as far as it is known; in metres.
  Mounting now() const;

 private:
  struct Kept {
    static constexpr int kRows = 7 + Intrinsics::kRows;
    Mounting mounting;
    Scalar covariance[kRows * kRows];  ///< row-major, of num_rows() rows
  };

  /// Of the mounting and the delay in the body's layout.
  int first_row() const { return layout_.row(BodyPart::kGravity) + 2; }
  int num_rows() const { return layout_.unit_rows() - first_row(); }

  const BodyLayout& layout_;
  const ImuUnit& unit_;
  const Filter& filter_;
  Kept* kept_ = nullptr;  ///< null where the mounting is not estimated
};

}  // namespace pf
