#include "map/wall_votes.h"

namespace pf {

using namespace tuning::plane_doubt;

void WallCover::add(const Vec3& p_W) {
  Vec2 pixel;
  if (!project(camera_, Vec3(view_.q_WC.conjugate() * (p_W - view_.c_W)), &pixel)) return;
  const int column = static_cast<int>(pixel.x() * kCells / static_cast<Scalar>(camera_.width));
  const int row = static_cast<int>(pixel.y() * kCells / static_cast<Scalar>(camera_.height));
  if (column >= 0 && column < kCells && row >= 0 && row < kCells) hidden_ |= 1u << (row * kCells + column);
}

int WallCover::bits(unsigned set) {
  int count = 0;
  for (; set != 0; set &= set - 1) ++count;
  return count;
}

bool WallVotes::add(Scalar d, Scalar variance, Scalar gate) {
  if (d * d > kRefusedGate * variance) {
    ++off;
    behind += d < Scalar(0);
    return true;
  }
  on += d * d < gate * variance;
  return false;
}

bool WallVotes::contradict(const PlaneEntry& wall) const {
  const auto contradicts = [&](int points) { return points >= kMinRefused && points > kRefusedShare * on; };
  // Points outweigh patches that were rejected on a wall: half as many are enough where not one is off it.
  const bool vouched = on >= (off > 0 ? kMinRefused : kMinRefused / 2);
  const bool denied =
      (wall.outliers >= kMinRefused && wall.outliers > on) || (wall.is_refused_by_patches() && !vouched);
  return denied || contradicts(behind) || (contradicts(off) && hide_most);
}

}  // namespace pf
