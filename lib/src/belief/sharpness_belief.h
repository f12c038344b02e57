#pragma once

#include "base/scalar.h"

namespace pf {

class Archive;

/// The question whether an image is as sharp as those before it, so that as much of the map is found in it. Of x, measure_sharpness():
///
///   as sharp        x ~ N(m, s²)                           m, s²: of the images whose poses were used
///   less sharp      x anywhere in kRange below m           by smear or focus, one image in ten
///
/// What is sharper than m is as sharp.
class SharpnessBelief {
 public:
  void init();
  /// An image of this sharpness. Until the first one is learned from, all are as sharp.
  void note(Scalar log_sharpness);
  /// A frame without an image.
  void note_none() { is_noted_ = false; }
  /// The frame's pose is used.
  void learn();
  /// Probability that this frame's image is as sharp as those before it; 1 where nothing is known of it.
  Scalar as_sharp() const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  Scalar now_ = 0, mean_ = 0, variance_ = 0;
  int learned_ = 0;  ///< frames
  bool is_noted_ = false;
};

}  // namespace pf
