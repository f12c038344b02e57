#include "filter_slam/pose/leave_one_out.h"

#include <algorithm>
#include <cmath>

#include "bundle/tuning.h"
#include "filter_slam/pose/consensus.h"
#include "filter_slam/pose/tuning.h"

namespace pf {
namespace {

using namespace tuning::leave_one_out;

/// Four sums side by side, so that none waits for the one before.
Scalar dot(const Scalar* a, const Scalar* b, int n) {
  Scalar s0 = 0, s1 = 0, s2 = 0, s3 = 0;
  int k = 0;
  for (; k + 4 <= n; k += 4) {
    s0 += a[k] * b[k];
    s1 += a[k + 1] * b[k + 1];
    s2 += a[k + 2] * b[k + 2];
    s3 += a[k + 3] * b[k + 3];
  }
  for (; k < n; ++k) s0 += a[k] * b[k];
  return (s0 + s1) + (s2 + s3);
}

}  // namespace

bool LeaveOneOut::layout(Arena& arena, int max_observations) {
  const std::size_t count = static_cast<std::size_t>(max_observations);
  max_rows_ = 2 * max_observations;
  last_row_ = arena.take<Scalar>(2 * count);
  g_ = arena.take<Scalar>(2 * count);
  spare_ = arena.take<Scalar>(4 * count);
  diagonal_ = arena.take<Mat2>(count);
  index_ = arena.take<int>(count);
  return arena.ok();
}

bool LeaveOneOut::reject(Filter& filter, const PixelMeasurement* observations, int count, Scalar gate,
                         const MatchAges& ages, unsigned char* keep, JointFit* fit) {
  filter_ = &filter;
  kept_ = 0;
  for (int i = 0; i < count; ++i)
    if (keep[i] != 0) index_[kept_++] = i;
  if (ages.frames != nullptr) sort(ages.frames);
  fill(observations);
  if (kept_ == 0 || !factor()) return false;
  invert_factor();
  for (int i = 2 * kept_ - 1; i >= 0; --i) {  // g <- L^-1 r; from the last on, since row i reads entries up to i
    Scalar v = 0;
    for (int k = 0; k <= i; ++k) v += row(i)[k] * g_[k];
    g_[i] = v;
  }
  // The rows of L^-1 and of v that stay are those of the older matches alone.
  const int older = ages.frames != nullptr ? group_begin(ages) : kept_;
  for (int a = older; a < kept_; ++a) keep[index_[a]] = 0;
  kept_ = older;
  const ZoomFit zoom = zoom_of(observations, g_);
  Scalar sum = 0, log_det = 0;
  for (int i = 2 * kept_ - 1; i >= 0; --i) {
    sum += g_[i] * g_[i];
    log_det -= 2 * std::log(row(i)[i]);
  }
  for (int i = 0; i < 2 * kept_; ++i) {  // g <- L^-T g
    const Scalar v = g_[i];
    g_[i] = 0;
    for (int k = 0; k <= i; ++k) g_[k] += row(i)[k] * v;
  }
  diagonal_of_inverse();
  int worst = find_worst(gate);
  if (worst >= 0) complete_inverse();
  for (; worst >= 0; worst = find_worst(gate)) {
    keep[index_[worst]] = 0;
    log_det += std::log(diagonal_[worst].determinant());  // det S = det S_rest det G_ii^-1
    sum = std::max(sum - remove(worst), Scalar(0));
  }
  *fit = {sum, log_det, zoom};
  return true;
}

/// How much longer the lens is, as one more unknown beside what S has of pose and map. It moves each pixel away from the principal point
/// c. With w = L^-1 h, h = measured - c:
///
///   s = w^T v / w^T w,   var(s) = max(1, (v^T v - s w^T v) / (2n - 1)) / w^T w
ZoomFit LeaveOneOut::zoom_of(const PixelMeasurement* observations, const Scalar* v) {
  const Camera& lens = filter_->lens();
  const int rows = 2 * kept_;
  Scalar* h = spare_;
  for (int a = 0; a < kept_; ++a) {
    const Vec2 from_centre = observations[index_[a]].measured - Vec2(lens.cx, lens.cy);
    h[2 * a] = from_centre.x();
    h[2 * a + 1] = from_centre.y();
  }
  Scalar ww = 0, wv = 0, vv = 0;
  for (int i = 0; i < rows; ++i) {
    const Scalar w = dot(row(i), h, i + 1);
    ww += w * w;
    wv += w * v[i];
    vv += v[i] * v[i];
  }
  ZoomFit zoom;
  if (kept_ < tuning::zoom_fit::kLeastPoints || !(ww > Scalar(0))) return zoom;
  zoom.log_ratio = wv / ww;
  zoom.variance = std::max(Scalar(1), (vv - zoom.log_ratio * wv) / static_cast<Scalar>(rows - 1)) / ww;
  return zoom;
}

/// Oldest first; equals stay in their order.
void LeaveOneOut::sort(const unsigned char* frames) {
  for (int a = 1; a < kept_; ++a)
    for (int b = a; b > 0 && frames[index_[b]] > frames[index_[b - 1]]; --b) std::swap(index_[b], index_[b - 1]);
}

/// Index at which the group of the newest features begins that the older ones contradict most; kept_ if they contradict none. With n rows
/// in the group, N in all, q = sum of v^2 over the group and s that of the older ones per row, at least 1 (where the model is wrong, it is
/// so for all):
///
///   z = ((q / (n s))^(1/3) - (1 - 2 / (9 n))) / sqrt(2 / (9 n))       Wilson and Hilferty 1931: normal, if q / s is chi-square
int LeaveOneOut::group_begin(const MatchAges& ages) const {
  int begin = kept_;
  Scalar all = 0, q = 0, worst = kGroupDeviations;
  for (int i = 0; i < 2 * kept_; ++i) all += g_[i] * g_[i];
  for (int a = kept_ - 1; a >= ages.least && 2 * a >= kept_ && ages.frames[index_[a]] < kYoung; --a) {
    q += g_[2 * a] * g_[2 * a] + g_[2 * a + 1] * g_[2 * a + 1];
    if (ages.frames[index_[a]] == ages.frames[index_[a - 1]]) continue;  // measured as often as the next one
    const Scalar n = static_cast<Scalar>(2 * (kept_ - a)), spread = 2 / (9 * n);
    const Scalar s = std::max(Scalar(1), (all - q) / static_cast<Scalar>(2 * a));
    const Scalar z = (std::pow(q / (n * s), Scalar(1) / 3) - (1 - spread)) / std::sqrt(spread);
    if (!(z > worst)) continue;
    worst = z;
    begin = a;
  }
  return begin;
}

/// G <- S, g <- r
void LeaveOneOut::fill(const PixelMeasurement* observations) {
  for (int a = 0; a < kept_; ++a) {
    const PixelMeasurement& o = observations[index_[a]];
    for (int b = 0; b <= a; ++b) {
      Mat2 S = filter_->innovation_block(index_[a], index_[b]);
      if (a == b) S += o.R_gate;
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < (a == b ? i + 1 : 2); ++j) row(2 * a + i)[2 * b + j] = S(i, j);
    }
    const Vec2 r = o.measured - o.predicted;
    g_[2 * a] = r.x();
    g_[2 * a + 1] = r.y();
  }
}

/// S = L L^T in place, row by row. False if S is not positive definite.
bool LeaveOneOut::factor() {
  for (int i = 0; i < 2 * kept_; ++i) {
    Scalar* L_i = row(i);
    for (int j = 0; j < i; ++j) L_i[j] = (L_i[j] - dot(L_i, row(j), j)) / row(j)[j];
    const Scalar pivot = L_i[i] - dot(L_i, L_i, i);
    if (!(pivot > Scalar(0))) return false;
    L_i[i] = std::sqrt(pivot);
  }
  return true;
}

/// L^-1 in place, row by row:  X_i: = (e_i - sum_k<i L_ik X_k:) / L_ii
void LeaveOneOut::invert_factor() {
  for (int i = 0; i < 2 * kept_; ++i) {
    Scalar* L_i = row(i);
    for (int j = 0; j < i; ++j) spare_[j] = 0;
    for (int k = 0; k < i; ++k) {
      const Scalar l = L_i[k];
      const Scalar* X_k = row(k);
      for (int j = 0; j <= k; ++j) spare_[j] -= l * X_k[j];
    }
    const Scalar inverse = Scalar(1) / L_i[i];
    for (int j = 0; j < i; ++j) L_i[j] = spare_[j] * inverse;
    L_i[i] = inverse;
  }
}

/// G_ii = sum_k X_ki^T X_ki, with X = L^-1
void LeaveOneOut::diagonal_of_inverse() {
  for (int a = 0; a < kept_; ++a) diagonal_[a].setZero();
  for (int k = 0; k < 2 * kept_; ++k) {
    const Scalar* X_k = row(k);
    for (int a = 0; 2 * a <= k; ++a) {
      const Scalar x = X_k[2 * a], y = 2 * a + 1 <= k ? X_k[2 * a + 1] : Scalar(0);
      diagonal_[a](0, 0) += x * x;
      diagonal_[a](1, 0) += x * y;
      diagonal_[a](1, 1) += y * y;
    }
  }
  for (int a = 0; a < kept_; ++a) diagonal_[a](0, 1) = diagonal_[a](1, 0);
}

/// G = X^T X in place: row i of G reads rows i and later of X only.
void LeaveOneOut::complete_inverse() {
  for (int i = 0; i < 2 * kept_; ++i) {
    for (int j = 0; j <= i; ++j) spare_[j] = 0;
    for (int k = i; k < 2 * kept_; ++k) {
      const Scalar* X_k = row(k);
      const Scalar x = X_k[i];
      for (int j = 0; j <= i; ++j) spare_[j] += x * X_k[j];
    }
    for (int j = 0; j <= i; ++j) row(i)[j] = spare_[j];
  }
}

/// The kept match with the largest d^2 above the gate, or -1.
int LeaveOneOut::find_worst(Scalar gate) const {
  int worst = -1;
  for (int a = 0; a < kept_; ++a) {
    if (index_[a] < 0) continue;
    const Scalar d2 = squared_distance(Vec2(g_[2 * a], g_[2 * a + 1]), diagonal_[a]);
    if (!(d2 > gate)) continue;
    gate = d2;
    worst = a;
  }
  return worst;
}

/// Takes a match out of G and g. Returns what it contributed to r^T G r.
Scalar LeaveOneOut::remove(int worst) {
  const int m = 2 * kept_, w = 2 * worst;
  Scalar* u = spare_;
  Scalar* v = spare_ + max_rows_;
  for (int i = 0; i < m; ++i) {
    u[i] = i >= w ? row(i)[w] : row(w)[i];
    v[i] = i > w ? row(i)[w + 1] : row(w + 1)[i];
  }
  const Mat2& G = diagonal_[worst];
  const Scalar det = G(0, 0) * G(1, 1) - G(0, 1) * G(1, 0);
  Mat2 C;
  C << G(1, 1), -G(0, 1), -G(1, 0), G(0, 0);
  C /= det;
  const Vec2 g_w(g_[w], g_[w + 1]);
  const Vec2 x = C * g_w;
  index_[worst] = -1;
  for (int i = 0; i < m; ++i) {
    g_[i] -= u[i] * x.x() + v[i] * x.y();
    const Scalar a = C(0, 0) * u[i] + C(0, 1) * v[i], b = C(1, 0) * u[i] + C(1, 1) * v[i];
    Scalar* G_i = row(i);
    for (int j = 0; j <= i; ++j) G_i[j] -= a * u[j] + b * v[j];
  }
  for (int a = 0; a < kept_; ++a) {
    const Scalar xy = row(2 * a + 1)[2 * a];
    diagonal_[a] << row(2 * a)[2 * a], xy, xy, row(2 * a + 1)[2 * a + 1];
  }
  return g_w.dot(x);
}

}  // namespace pf
