#pragma once

#include "base/arena.h"
#include "bundle/zoom_fit.h"
#include "filter/filter.h"

namespace pf {

/// Tests each match against all the others together, and rejects those that the others contradict (data snooping; Baarda 1968).
///
/// A consensus compares matches with one hypothesis, which does not fix the whole pose: the ellipse of a new feature stays wide, since its
/// depth is open. All the others together leave it its epipolar line only. With S = H P H^T + R_gate of the kept matches, G = S^-1 and g =
/// G r, match i lies at
///
///   e_i = G_ii^-1 g_i,   cov e_i = G_ii^-1,   d_i^2 = g_i^T G_ii^-1 g_i
///
/// from where the others predict it. The match with the largest d^2 is rejected while that is above the gate, one at a time, since a
/// wrong match makes right ones look wrong:
///
///   G <- G - G_:i G_ii^-1 G_i:,   g <- g - G_:i G_ii^-1 g_i
///
/// Points that move together support each other in that test. So before it, the new features are tested as a group against the older ones:
/// with the matches in order of age and S = L L^T, v = L^-1 r, the sum of v^2 over the rows of the newest is their normalised innovation
/// squared given all the older ones. Where chance does not explain it, all of them are rejected.
///
/// Derivation and measurements: lib/docs/theory/noise.md
struct MatchAges {
  const unsigned char* frames =
      nullptr;    ///< in which each match's feature was measured, up to 255; null: groups are not tested
  int least = 0;  ///< matches that a group of new ones is tested against, at least
};

/// Residuals of matches under their joint covariance.
struct JointFit {
  Scalar nis = 0;      ///< r^T S^-1 r
  Scalar log_det = 0;  ///< ln det S
  ZoomFit zoom;        ///< by all that were kept before any of them was rejected
};

class LeaveOneOut {
 public:
  bool layout(Arena& arena, int max_observations);

  /// Clears keep of the matches that it rejects. Between begin_update with the same observations, max_observations at most as in the
  /// filter, and finish_update. fit: of those that stay.
  /// False if S is not positive definite; then keep and fit are untouched.
  bool reject(Filter& filter, const PixelMeasurement* observations, int count, Scalar gate, const MatchAges& ages,
              unsigned char* keep, JointFit* fit);

 private:
  /// Row i of G, i + 1 numbers. All but the last lie in the filter's scratch.
  Scalar* row(int i) { return i + 1 < max_rows_ ? filter_->scratch_row(i) : last_row_; }
  void fill(const PixelMeasurement* observations);
  ZoomFit zoom_of(const PixelMeasurement* observations, const Scalar* v);
  void sort(const unsigned char* frames);
  int group_begin(const MatchAges& ages) const;
  bool factor();
  void invert_factor();
  void diagonal_of_inverse();
  void complete_inverse();
  int find_worst(Scalar gate) const;
  Scalar remove(int worst);

  int max_rows_ = 0;  ///< 2 max_observations
  Filter* filter_ = nullptr;
  Scalar* last_row_ = nullptr;  ///< of G: S, then its factor L, then L^-1, then G; lower triangles
  Scalar* g_ = nullptr;         ///< r, then v = L^-1 r, then g
  Scalar* spare_ = nullptr;     ///< 2 x max_rows
  Mat2* diagonal_ = nullptr;    ///< G_ii, max_observations
  int* index_ = nullptr;        ///< of the kept matches; -1 once rejected
  int kept_ = 0;
};

}  // namespace pf
