#pragma once

#include "geometry/similarity_error.h"
#include "keyframe_slam/adjustment/keyframe_adjustment.h"

/// How far the map about the newest keyframe may have drifted against older parts of it (lib/docs/theory/places.md).

namespace pf {

class Archive;

/// Sum of what each adjustment away from the map's first keyframe may have moved the newest one, as an error of a similarity about the
/// origin of W: the map between two keyframes drifts by the difference of their sums. After a return the chain goes on from the place that
/// the camera came back to, and keyframes between the two visits hang on that place at both ends.
class DriftChain {
 public:
  void init() { data_ = Data(); }
  /// After the adjustment of a keyframe that is at p_W.
  void add(const MapDrift& drift, const Vec3& p_W);
  const SimilarityCovariance& sum() const { return data_.sum; }
  /// Of two parts of the map against each other: an older one with its number and sum, and a younger one with its sum.
  SimilarityCovariance between(int number, const SimilarityCovariance& older,
                               const SimilarityCovariance& younger) const;
  /// Keyframes with larger numbers were made since the camera has last left a place that it knew.
  int left_at(int number) const { return number > data_.closed_at ? number : data_.closed_at; }
  /// The camera is back at a place with this number and sum, known with this covariance against it. last: number of the newest keyframe.
  void close(int number, const SimilarityCovariance& sum, const SimilarityCovariance& known, int last) {
    data_ = {sum + known, sum, number, last};
  }
  /// All of W is moved.
  void move(const Similarity& T) {
    data_.sum = moved_covariance(T, data_.sum);
    data_.hung = moved_covariance(T, data_.hung);
  }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Data {
    SimilarityCovariance sum = SimilarityCovariance::Zero();
    SimilarityCovariance hung = SimilarityCovariance::Zero();  ///< sum of the place of the last return
    int hung_on = 0;                                           ///< its number; 0: there was no return
    int closed_at = 0;                                         ///< number of the newest keyframe then
  };
  Data data_;
};

}  // namespace pf
