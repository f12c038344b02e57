#pragma once

#include "base/arena.h"
#include "filter/filter.h"
#include "filter/imu_path.h"

/// Mounting, delay and intrinsics of the inertial unit with which a map begins. Earlier maps may have estimated them.

namespace pf {

class Archive;

class KeptMounting {
 public:
  KeptMounting(const BodyLayout& layout, const ImuUnit& unit, const Filter& filter)
      : layout_(layout), unit_(unit), filter_(filter) {}

  /// Takes no memory where the mounting is not estimated.
  bool layout(Arena& arena);
  /// Maps begin with the mounting and the delay of the config.
  void init();
  /// Maps begin with the filter's present mounting and delay. Only where the filter has a pose.
  void keep();

  /// Values with which a map begins.
  const Mounting& initial() const { return kept_ != nullptr ? kept_->mounting : unit_.mounting; }
  /// Sets the block of a square row-major covariance of the layout's unit rows that belongs to initial().
  void put_covariance(Scalar* covariance) const;
  /// Present estimate of the unit's mounting on the camera, in metres.
  Mounting now() const;

  void carry(Archive& archive);  ///< base/archive.h

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
