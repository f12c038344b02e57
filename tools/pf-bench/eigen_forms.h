#pragma once

#include <memory>

#include "covariance_problem.h"

namespace bench {

/// The same update written with Eigen on a full square matrix, compiled for this machine.
class EigenForms {
 public:
  explicit EigenForms(const Problem& problem);
  ~EigenForms();

  void restore();
  void rank_update();  ///< touched columns only, LLT, triangular solve, selfadjointView::rankUpdate
  void textbook();     ///< K = P H^T S^-1, P = (I - K H) P, all dense

  /// Largest difference of the lower triangle from P, for a check that both compute the same.
  double difference(const pf::Triangle& P) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace bench
