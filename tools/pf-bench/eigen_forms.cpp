#include "eigen_forms.h"

#include <Eigen/Dense>

namespace bench {
namespace {

using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
using RowMajor = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

}  // namespace

struct EigenForms::State {
  const Problem& problem;
  Matrix start, P, H, body, point, PHt, S, K;
  Vector innovation, dx;

  /// Rows first .. of the symmetric matrix of which the lower triangle is kept, as columns.
  void columns(int first, int size, Matrix& out) const {
    out.topRows(first).noalias() = P.block(first, 0, size, first).transpose();
    out.middleRows(first, size) = P.block(first, first, size, size).selfadjointView<Eigen::Lower>();
    out.bottomRows(P.rows() - first - size) = P.block(first + size, first, P.rows() - first - size, size);
  }
};

EigenForms::EigenForms(const Problem& problem) : state_(new State{problem, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}}) {
  State& s = *state_;
  const int n = problem.n, m = problem.m;
  s.start = Eigen::Map<const RowMajor>(problem.dense_covariance().data(), n, n);
  s.H = Eigen::Map<const RowMajor>(problem.dense_rows().data(), m, n);
  s.P = s.start;
  s.body.resize(n, kBody);
  s.point.resize(n, kPoint);
  s.PHt.resize(n, m);
  s.S.resize(m, m);
  s.K.resize(n, m);
  s.innovation = Eigen::Map<const Vector>(problem.innovation.data(), m);
  s.dx.resize(n);
}

EigenForms::~EigenForms() = default;

void EigenForms::restore() { state_->P = state_->start; }

void EigenForms::rank_update() {
  State& s = *state_;
  s.columns(0, kBody, s.body);
  int b = 0;
  for (const pf::SparseRows& J : s.problem.J) {
    const Eigen::Map<const RowMajor> h(J.h, 2, J.columns());
    s.PHt.middleCols(b, 2).noalias() = s.body.lazyProduct(h.leftCols(kBody).transpose());
    int c = kBody;
    for (int i = 1; i < J.segments; ++i, c += kPoint) {
      s.columns(J.segment[i].first, kPoint, s.point);
      s.PHt.middleCols(b, 2).noalias() += s.point.lazyProduct(h.middleCols(c, kPoint).transpose());
    }
    b += 2;
  }
  b = 0;
  for (const pf::SparseRows& J : s.problem.J) {
    const Eigen::Map<const RowMajor> h(J.h, 2, J.columns());
    s.S.middleRows(b, 2).noalias() = h.leftCols(kBody).lazyProduct(s.PHt.topRows(kBody));
    int c = kBody;
    for (int i = 1; i < J.segments; ++i, c += kPoint) {
      s.S.middleRows(b, 2).noalias() +=
          h.middleCols(c, kPoint).lazyProduct(s.PHt.middleRows(J.segment[i].first, kPoint));
    }
    b += 2;
  }
  s.S.diagonal().array() += s.problem.variance;
  Eigen::LLT<Eigen::Ref<Matrix>> llt(s.S);
  llt.matrixL().transpose().solveInPlace<Eigen::OnTheRight>(s.PHt);
  s.dx.noalias() = s.PHt * llt.matrixL().solve(s.innovation);
  s.P.selfadjointView<Eigen::Lower>().rankUpdate(s.PHt, Scalar(-1));
}

void EigenForms::textbook() {
  State& s = *state_;
  const Matrix identity = Matrix::Identity(s.P.rows(), s.P.cols());
  s.PHt.noalias() = s.P * s.H.transpose();
  s.S.noalias() = s.H * s.PHt;
  s.S.diagonal().array() += s.problem.variance;
  s.K.noalias() = s.PHt * s.S.inverse();
  s.dx.noalias() = s.K * s.innovation;
  s.P = (identity - s.K * s.H) * s.P;
}

double EigenForms::difference(const pf::Triangle& P) const {
  double worst = 0;
  for (int i = 0; i < P.n; ++i) {
    for (int j = 0; j <= i; ++j) {
      worst = std::max(worst, std::abs(static_cast<double>(P.row(i)[j]) - static_cast<double>(state_->P(i, j))));
    }
  }
  return worst;
}

}  // namespace bench
