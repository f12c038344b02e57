#pragma once

#include "map/plane_search.h"

namespace pf {

/// The layers beside a plane reach this many times as far as its own points may.
inline constexpr int kPlaneLayer = 4;

/// A plane through three points.
struct PlaneHypothesis {
  Vec3 o_W = Vec3::Zero();
  Vec3 n_W = Vec3::UnitZ();
  int score = 0;
};

/// Points within the radius of a plane's origin, counted by their distance from the plane.
struct PlaneLayers {
  int on = 0;        ///< within the distance
  int side[2] = {};  ///< beyond it, within kPlaneLayer distances, behind the plane and before it
  int near = 0;      ///< within those that chance is judged against
  int around = 0;    ///< at any
};

PlaneLayers count_layers(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings,
                         const Vec3& o_W, const Vec3& n_W);

/// Refits a hypothesis to a plane with its members, or rejects it.
class PlaneRefit {
 public:
  PlaneRefit(const PlaneCandidate* candidates, int count, const PlaneSearchSettings& settings, const Vec3& viewer_W)
      : candidates_(candidates), count_(count), settings_(settings), viewer_W_(viewer_W) {}

  /// Fits and collects in turn, rejects points of high leverage, and tests the rest. False if it is no plane.
  bool run(const PlaneHypothesis& hypothesis);

  const PlaneFit& fit() const { return fit_; }
  const int* members() const { return members_; }
  int member_count() const { return member_count_; }

 private:
  void collect(const Vec3& o_W, const Vec3& n_W);
  int farthest(const Vec3& o_W) const;
  bool refit();
  void keep_connected();
  bool reject_high_leverage();
  bool passes() const;
  bool chance_explains(const PlaneLayers& layers) const;

  const PlaneCandidate* candidates_;
  int count_;
  const PlaneSearchSettings& settings_;
  const Vec3& viewer_W_;
  PlaneFit fit_;
  int members_[kMaxPlaneMembers];
  int member_count_ = 0;
};

}  // namespace pf
