#include "keyframe_slam/loops/drift_chain.h"

#include "base/archive.h"
#include "base/elapsed.h"

namespace pf {

bool DriftChain::layout(Arena& arena, int max_parts) {
  capacity_ = max_parts;
  if (capacity_ == 0) return arena.ok();
  data_ = arena.take<Data>(1);
  link_ = arena.take<Link>(static_cast<std::size_t>(capacity_));
  return arena.ok();
}

void DriftChain::init() {
  if (data_ == nullptr) return;
  *data_ = Data();
  keep_only([](int) { return false; });
}

const SimilarityCovariance* DriftChain::sum_of(int number) const {
  for (int i = 0; i < capacity_; ++i)
    if (link_[i].number == number) return &link_[i].sum;
  return nullptr;
}

void DriftChain::set_sum(int number, const SimilarityCovariance& sum) {
  Link* to = nullptr;
  for (int i = 0; i < capacity_; ++i)
    if (link_[i].number == number || (to == nullptr && link_[i].number == 0)) to = link_ + i;
  if (to != nullptr) *to = {number, sum};
}

/// Where the newest keyframe is not connected with the one before, the camera has been found elsewhere in the map.
void DriftChain::add(int number, int hangs_on, const MapDrift& drift, const Vec3& p_W) {
  if (data_ == nullptr) return;
  const SimilarityCovariance* from = hangs_on > 0 && hangs_on != data_->newest ? sum_of(hangs_on) : nullptr;
  if (from != nullptr) {
    const bool is_since = data_->hung_on > 0 && hangs_on > data_->closed_at;
    const Data before = *data_;
    *data_ = {*from,
              is_since ? before.hung : *from,
              is_since ? before.hung_on : hangs_on,
              is_since ? before.closed_at : before.newest,
              before.newest,
              before.breaks};
    count_frame(&data_->breaks);
  }
  data_->newest = number;
  if (drift.any) {
    SimilarityCovariance Q = SimilarityCovariance::Zero();
    Q.topLeftCorner<6, 6>() = drift.Q.cast<double>();
    Q(6, 6) = static_cast<double>(drift.sigma_scale) * static_cast<double>(drift.sigma_scale);
    data_->sum += similarity_covariance_at(-p_W, Q);
  }
  set_sum(number, data_->sum);
}

SimilarityCovariance DriftChain::between(int number, const SimilarityCovariance& older,
                                         const SimilarityCovariance& younger) const {
  const bool hangs_between = data_->hung_on > 0 && number > data_->hung_on && number <= data_->closed_at;
  return hangs_between ? SimilarityCovariance(older - data_->hung + younger - data_->hung)
                       : SimilarityCovariance(younger - older);
}

void DriftChain::close(int number, const SimilarityCovariance& sum, const SimilarityCovariance& known) {
  *data_ = {sum + known, sum, number, data_->newest, data_->newest, data_->breaks};
  count_frame(&data_->breaks);
}

void DriftChain::move(const Similarity& T) {
  if (data_ == nullptr) return;
  data_->sum = moved_covariance(T, data_->sum);
  data_->hung = moved_covariance(T, data_->hung);
  for (int i = 0; i < capacity_; ++i)
    if (link_[i].number != 0) link_[i].sum = moved_covariance(T, link_[i].sum);
}

void DriftChain::carry(Archive& archive) {
  if (data_ == nullptr) return;
  auto& [sum, hung, hung_on, closed_at, newest, breaks] = *data_;
  archive.numbers(sum, hung);
  archive.counts(hung_on, closed_at, newest, breaks);
  for (int i = 0; i < capacity_; ++i) {
    archive.counts(link_[i].number);
    if (link_[i].number != 0) archive.numbers(link_[i].sum);
  }
}

bool DriftSpread::begin(const DriftChain& chain, const LoopClosure& loop) {
  const SimilarityCovariance* older = chain.sum_of(loop.place);
  SmallCholesky<7, double> prior;
  if (older == nullptr || !prior.factor(loop.prior)) return false;
  chain_ = &chain;
  loop_ = &loop;
  older_ = *older;
  known_ = similarity_covariance_at(-loop.at_W, loop.posterior);
  inverse_ = prior.inverse();
  left_at_ = chain.left_at(loop.place);
  return true;
}

Similarity DriftSpread::move(int number, SimilarityCovariance* sum) const {
  if (!is_since(number)) return Similarity();
  const SimilarityCovariance C = similarity_covariance_at(loop_->at_W, chain_->between(loop_->place, older_, *sum));
  const SimilarityCovariance B = C.lazyProduct(inverse_), gain = loop_->prior - loop_->posterior;
  *sum = older_ + similarity_covariance_at(-loop_->at_W, C - B.lazyProduct(gain).lazyProduct(B.transpose()));
  return similarity_of(B.lazyProduct(loop_->x), loop_->at_W);
}

}  // namespace pf
