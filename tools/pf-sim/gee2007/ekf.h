#pragma once

#include <array>
#include <vector>

#include "algebra.h"

/// The filter of the paper's experiment: lib/docs/results/gee2007.md.

namespace pfsim::gee {

/// A derivative with respect to one block of the state; its columns are as many as the block has numbers.
struct Touch {
  int block;
  MatX J;
};

/// Two measured numbers: r = z - h(x), and the blocks that h looks at. H = [J ...], variance of the noise the same in both.
struct Innovation {
  Vec2 residual;
  std::vector<Touch> H;
};

/// State and covariance of a plain extended Kalman filter with its five operations; knows offsets and no meaning.
///
/// Blocks are named by numbers that stay; their places move when others go. Only the lower triangle of P is kept.
class Ekf {
 public:
  explicit Ekf(int capacity);

  int dimension() const { return n_; }
  int size(int block) const { return blocks_[static_cast<std::size_t>(block)].size; }
  VecX value(int block) const { return x_.segment(at(block), size(block)); }
  void set_value(int block, const VecX& value) { x_.segment(at(block), size(block)) = value; }

  /// Covariance between two blocks.
  MatX covariance(int a, int b) const;
  MatX covariance(int block) const { return covariance(block, block); }
  /// Standard deviation of one number of a block; 0 where its variance has become negative.
  double sigma(int block, int number) const;
  /// J P J^T for a derived quantity.
  MatX derived(const std::vector<Touch>& J) const;

  /// x = [x, value], P = J [P 0; 0 R] J^T with s = value: J of s with respect to blocks, and R already in the units of s.
  /// Gives the new block, -1 when there is no room.   src Gee 2007 (3)
  int augment(const VecX& value, const std::vector<Touch>& J, const MatX& R);
  /// A block becomes a function of itself and others: augment without noise, then remove the old.   src Gee 2007 (4)
  int transform(int block, const VecX& value, const std::vector<Touch>& J);
  void remove(int block);
  /// P += Q on a block's diagonal block.
  void add_noise(int block, const MatX& Q);
  /// P = J P J^T for square J of the first block, which stays where it is.
  void map_first(const MatX& J);
  /// All innovations at once; false, and nothing changed, when their covariance is not positive.
  bool update(const std::vector<Innovation>& innovations, double variance);

 private:
  struct Place {
    int at, size;
  };
  int at(int block) const { return blocks_[static_cast<std::size_t>(block)].at; }
  /// Columns of a block, all n rows, from the lower triangle.
  void columns(int block, MatX* out) const;
  /// sum of P[:, block] J^T.
  MatX times(const std::vector<Touch>& J) const;

  int capacity_, n_ = 0;
  VecX x_;
  MatX P_;
  std::vector<Place> blocks_;
};

}  // namespace pfsim::gee
