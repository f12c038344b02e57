#include "ekf.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace pfsim::gee {

Ekf::Ekf(int capacity) : capacity_(capacity), x_(VecX::Zero(capacity)), P_(MatX::Zero(capacity, capacity)) {}

void Ekf::columns(int block, MatX* out) const {
  const int first = at(block), count = size(block), rest = n_ - first - count;
  out->resize(n_, count);
  out->topRows(first) = P_.block(first, 0, count, first).transpose();
  out->middleRows(first, count) = MatX(P_.block(first, first, count, count).selfadjointView<Eigen::Lower>());
  out->bottomRows(rest) = P_.block(first + count, first, rest, count);
}

MatX Ekf::covariance(int a, int b) const {
  if (a == b) return P_.block(at(a), at(a), size(a), size(a)).selfadjointView<Eigen::Lower>();
  if (at(a) > at(b)) return P_.block(at(a), at(b), size(a), size(b));
  return P_.block(at(b), at(a), size(b), size(a)).transpose();
}

double Ekf::sigma(int block, int number) const {
  const int i = at(block) + number;
  return std::sqrt(std::max(0.0, P_(i, i)));
}

MatX Ekf::times(const std::vector<Touch>& J) const {
  MatX out = MatX::Zero(n_, J.empty() ? 0 : J[0].J.rows()), part;
  for (const Touch& touch : J) {
    columns(touch.block, &part);
    out.noalias() += part.lazyProduct(touch.J.transpose());
  }
  return out;
}

MatX Ekf::derived(const std::vector<Touch>& J) const {
  const MatX right = times(J);
  MatX out = MatX::Zero(right.cols(), right.cols());
  for (const Touch& touch : J) out += touch.J * right.middleRows(at(touch.block), size(touch.block));
  return 0.5 * (out + out.transpose());
}

int Ekf::augment(const VecX& value, const std::vector<Touch>& J, const MatX& R) {
  const int count = static_cast<int>(value.size());
  if (n_ + count > capacity_) return -1;
  MatX own = R;
  if (!J.empty()) {
    P_.block(n_, 0, count, n_) = times(J).transpose();
    own += derived(J);
  } else {
    P_.block(n_, 0, count, n_).setZero();
  }
  P_.block(n_, n_, count, count) = own;
  x_.segment(n_, count) = value;
  blocks_.push_back({n_, count});
  n_ += count;
  return static_cast<int>(blocks_.size()) - 1;
}

int Ekf::transform(int block, const VecX& value, const std::vector<Touch>& J) {
  const int made = augment(value, J, MatX::Zero(value.size(), value.size()));
  if (made >= 0) remove(block);
  return made;
}

void Ekf::remove(int block) {
  const int first = at(block), count = size(block), rest = n_ - first - count;
  // The first columns keep their rows above; what lies below and to the right closes up. Copies go towards the start.
  for (int c = 0; c < first; ++c)
    for (int r = first; r < first + rest; ++r) P_(r, c) = P_(r + count, c);
  for (int c = first; c < first + rest; ++c)
    for (int r = c; r < first + rest; ++r) P_(r, c) = P_(r + count, c + count);
  for (int r = first; r < first + rest; ++r) x_(r) = x_(r + count);
  n_ -= count;
  for (Place& place : blocks_)
    if (place.at > first) place.at -= count;
  blocks_[static_cast<std::size_t>(block)] = {-1, 0};
}

void Ekf::add_noise(int block, const MatX& Q) { P_.block(at(block), at(block), size(block), size(block)) += Q; }

void Ekf::map_first(const MatX& J) {
  const int count = static_cast<int>(J.rows());
  const MatX own = P_.topLeftCorner(count, count).selfadjointView<Eigen::Lower>();
  P_.topLeftCorner(count, count) = J * own * J.transpose();
  const MatX below = P_.block(count, 0, n_ - count, count);
  P_.block(count, 0, n_ - count, count) = below.lazyProduct(J.transpose());
}

bool Ekf::update(const std::vector<Innovation>& innovations, double variance) {
  const int m = 2 * static_cast<int>(innovations.size());
  if (m == 0) return true;
  MatX PHt(n_, m), S(m, m), first;
  VecX r(m);
  columns(0, &first);  // most innovations look at the camera
  MatX part;
  for (int i = 0; i < m; i += 2) {
    const Innovation& innovation = innovations[static_cast<std::size_t>(i / 2)];
    auto out = PHt.middleCols<2>(i);
    out.setZero();
    for (const Touch& touch : innovation.H) {
      if (touch.block != 0) columns(touch.block, &part);
      out += (touch.block == 0 ? first : part).lazyProduct(touch.J.transpose());
    }
    r.segment<2>(i) = innovation.residual;
  }
  for (int i = 0; i < m; i += 2) {
    auto out = S.middleRows<2>(i);
    out.setZero();
    for (const Touch& touch : innovations[static_cast<std::size_t>(i / 2)].H)
      out += touch.J * PHt.middleRows(at(touch.block), size(touch.block));
  }
  S = (0.5 * (S + S.transpose())).eval();
  S.diagonal().array() += variance;
  const Eigen::LLT<MatX> cholesky(S);
  if (cholesky.info() != Eigen::Success || !r.allFinite()) return false;
  // P - K S K^T = P - V V^T with V = P H^T L^-T.
  cholesky.matrixU().solveInPlace<Eigen::OnTheRight>(PHt);
  cholesky.matrixL().solveInPlace(r);
  x_.head(n_) += PHt * r;
  P_.topLeftCorner(n_, n_).selfadjointView<Eigen::Lower>().rankUpdate(PHt, -1.0);
  return true;
}

}  // namespace pfsim::gee
