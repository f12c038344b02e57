#pragma once

#include "base/arena.h"
#include "geometry/similarity_error.h"
#include "geometry/small_cholesky.h"
#include "keyframe_slam/adjustment/keyframe_adjustment.h"

/// How far parts of the map may have drifted against each other, and how a return to an old part is spread over what was made since
/// (lib/docs/theory/places.md).

namespace pf {

class Archive;

/// A return to a place.
struct LoopClosure {
  int place = 0;             ///< number of its keyframe; 0: none
  Vec3 at_W = Vec3::Zero();  ///< the camera, before it
  SimilarityError x =
      SimilarityError::Zero();  ///< of the map about the newest keyframe, about the camera, as a correction
  SimilarityCovariance prior = SimilarityCovariance::Zero(), posterior = SimilarityCovariance::Zero();  ///< of x
};

/// Of each keyframe and place the sum of what adjustments away from the map's first keyframe may have moved the newest keyframe until then,
/// as an error of a similarity about the origin of W: the map between two of them drifts by the difference of their sums. After a return
/// the chain goes on from the place that the camera came back to, and keyframes between the two visits hang on that place at both ends.
class DriftChain {
 public:
  /// max_parts: keyframes and places; 0: no room, and init(), add(), sum_of(), move() and carry() do nothing.
  bool layout(Arena& arena, int max_parts);
  void init();

  /// After the adjustment of the newest keyframe, which is at p_W. hangs_on: the newest of the others that are connected with it, from
  /// which the chain goes on; 0: the one before.
  void add(int number, int hangs_on, const MapDrift& drift, const Vec3& p_W);
  /// Of the newest keyframe.
  const SimilarityCovariance& sum() const { return data_->sum; }
  /// Of a keyframe or place; null where none is known.
  const SimilarityCovariance* sum_of(int number) const;
  void set_sum(int number, const SimilarityCovariance& sum);
  /// Forgets the sums of what is no keyframe or place any more: is_kept(number).
  template <typename F>
  void keep_only(F&& is_kept) {
    for (int i = 0; i < capacity_; ++i)
      if (link_[i].number != 0 && !is_kept(link_[i].number)) link_[i].number = 0;
  }

  /// Of two parts of the map against each other: an older one with its number and sum, and a younger one with its sum.
  SimilarityCovariance between(int number, const SimilarityCovariance& older,
                               const SimilarityCovariance& younger) const;
  /// Keyframes with larger numbers were made since the camera has last left a part that is at least as old.
  int left_at(int number) const { return number > data_->closed_at ? number : data_->closed_at; }
  /// The camera is back at a part with this number and sum, known with this covariance against it.
  void close(int number, const SimilarityCovariance& sum, const SimilarityCovariance& known);
  /// How often the chain has gone on from another keyframe than the one before.
  int breaks() const { return data_->breaks; }
  /// All of W is moved.
  void move(const Similarity& T);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Link {
    int number = 0;  ///< 0: free
    SimilarityCovariance sum = SimilarityCovariance::Zero();
  };
  struct Data {
    SimilarityCovariance sum = SimilarityCovariance::Zero();
    SimilarityCovariance hung = SimilarityCovariance::Zero();  ///< sum of the part of the last return
    int hung_on = 0;                                           ///< its number; 0: there was no return
    int closed_at = 0;                                         ///< number of the newest keyframe then
    int newest = 0;                                            ///< number of the last one that was added
    int breaks = 0;
  };

  Data* data_ = nullptr;  ///< null: no room
  Link* link_ = nullptr;
  int capacity_ = 0;
};

/// How a return to a part moves what was made since, by least squares:
///
///   x_i = C_i C⁻¹ x,   C_i+ = C_i - C_i C⁻¹ (C - C+) C⁻¹ C_i       C_i, C: drift of a part and of the newest keyframe since, C+: C after
///
/// The newest keyframe moves by x, and what is as old as the part, or was made before the camera left it for the last time, not at all.
class DriftSpread {
 public:
  /// False: the return says nothing that can be spread. The chain must not change while this is in use.
  bool begin(const DriftChain& chain, const LoopClosure& loop);
  /// Whether a keyframe or place was made since.
  bool is_since(int number) const { return number > left_at_; }
  /// Motion of a part with this number and sum, and its sum afterwards.
  Similarity move(int number, SimilarityCovariance* sum) const;
  /// The same of what moves with the newest keyframe.
  Similarity move_whole(SimilarityCovariance* sum) const {
    *sum = older_ + known_;
    return similarity_of(loop_->x, loop_->at_W);
  }
  /// Of the newest keyframe against the place, about the origin.
  const SimilarityCovariance& known() const { return known_; }
  const SimilarityCovariance& older() const { return older_; }  ///< sum of the place

 private:
  const DriftChain* chain_ = nullptr;
  const LoopClosure* loop_ = nullptr;
  SimilarityCovariance older_, known_, inverse_;
  int left_at_ = 0;
};

}  // namespace pf
