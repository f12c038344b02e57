#include "memory/place_table.h"

namespace pf {

int PlaceTable::count() const {
  int count = 0;
  for (int i = 0; i < capacity_; ++i) count += used(i) ? 1 : 0;
  return count;
}

/// Entry of the most redundant one of a full table and of one more, which is the entry behind the last.
int PlaceTable::most_redundant(const KeptPlace& another) const {
  const auto at = [&](int i) -> const KeptPlace& { return i < capacity_ ? place_[i] : another; };
  int worst = capacity_;
  Scalar nearest = -1;
  for (int i = 0; i <= capacity_; ++i)
    for (int j = i + 1; j <= capacity_; ++j) {
      const KeptPlace &a = at(i), &b = at(j);
      if (a.map_id != b.map_id) continue;
      const Scalar d2 = view_distance2(a.q_WK, a.p_WK, a.depth, b.q_WK, b.p_WK, b.depth);
      if (nearest >= Scalar(0) && !(d2 < nearest)) continue;
      nearest = d2;
      const bool a_goes = a.count != b.count ? a.count < b.count : j == capacity_ || a.id < b.id;
      worst = a_goes ? i : j;
    }
  return worst;
}

void PlaceTable::leave(std::uint32_t map_id) {
  for (const int i : used_entries(*this)) {
    place_[i].is_back = false;
    if (is_present(i)) place_[i].map_id = map_id;
  }
}

void PlaceTable::join(std::uint32_t map_id) {
  for (const int i : used_entries(*this))
    if (place_[i].map_id == map_id) place_[i].map_id = 0;
}

int PlaceTable::entry_for(const KeptPlace& place) const {
  for (int i = 0; i < capacity_; ++i)
    if (!used(i)) return i;
  return most_redundant(place);
}

int PlaceTable::keep(const KeptPlace& place) {
  const int at = entry_for(place);
  if (at == capacity_) return -1;
  place_[at] = place;
  return at;
}

void PlaceTable::move(const Similarity& T) {
  for (const int i : used_entries(*this)) {
    if (is_present(i)) move(T, &place_[i]);
  }
}

void PlaceTable::move(const Similarity& T, KeptPlace* place) {
  const float f = static_cast<float>(T.s);
  place->q_WK = (T.q * place->q_WK).normalized();
  place->p_WK = T.of(place->p_WK);
  place->covariance = T.of_pose_covariance(place->covariance);
  place->depth *= T.s;
  for (int k = 0; k < place->count; ++k) {
    PlacePoint& point = place->point[k];
    point.rho /= f;
    for (float& c : point.covariance) c *= f * f;
    for (float& c : point.c_K) c *= f;
  }
}

}  // namespace pf
