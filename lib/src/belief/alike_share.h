#pragma once

#include "base/scalar.h"

namespace pf {

class Archive;

/// How many views of the map look like another part of it: the probability that a place which agrees with an image is another one than the
/// camera's. At least one in a thousand, since a part that was never seen may be the one:
///
///   s = s_0 + (1 - s_0) alike / (kWeight + views),   s_0 = exp(-pose_belief::kMaxFrame)
///
/// Two doors that are equal teach it that a third one may be.
class AlikeShare {
 public:
  void init() { views_ = alike_ = 0; }
  /// A new part of the map: whether it looks like one that is elsewhere.
  void note(bool is_alike);
  /// ln s
  Scalar log_share() const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  Scalar views_ = 0, alike_ = 0;
};

}  // namespace pf
