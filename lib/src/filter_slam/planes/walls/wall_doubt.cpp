#include "filter_slam/planes/walls/wall_doubt.h"

#include "filter_slam/features/wall_rays.h"
#include "filter_slam/planes/plane_points.h"
#include "filter_slam/planes/tuning.h"
#include "model/camera_at.h"

namespace pf {
namespace {

using namespace tuning::plane_doubt;

/// The image in cells: those whose middle shows the wall, with no other before it, and those with points that do not lie on it.
class Cover {
 public:
  Cover(const Filter& filter, const Map& map, int wall)
      : filter_(filter), camera_(camera_at(filter.state(), Scalar(0))) {
    const Camera& lens = filter.lens();
    for (int k = 0; k < kCells * kCells; ++k) {
      const Vec2 pixel((static_cast<Scalar>(k % kCells) + Scalar(0.5)) * static_cast<Scalar>(lens.width) / kCells,
                       (static_cast<Scalar>(k / kCells) + Scalar(0.5)) * static_cast<Scalar>(lens.height) / kCells);
      Vec3 ray_C;
      Scalar range = 0;
      if (unproject(lens, pixel, &ray_C) && first_wall(filter, map, camera_.p_W, camera_.q_WC * ray_C, &range) == wall)
        wall_ |= 1u << k;
    }
  }
  void add(const Vec3& p_W) {
    const Camera& lens = filter_.lens();
    Vec2 pixel;
    if (!project(lens, Vec3(camera_.q_WC.conjugate() * (p_W - camera_.p_W)), &pixel)) return;
    const int column = static_cast<int>(pixel.x() * kCells / static_cast<Scalar>(lens.width));
    const int row = static_cast<int>(pixel.y() * kCells / static_cast<Scalar>(lens.height));
    if (column >= 0 && column < kCells && row >= 0 && row < kCells) hidden_ |= 1u << (row * kCells + column);
  }
  /// Whether at most half of what should show the wall is free of such points.
  bool is_wide() const { return 2 * bits(wall_ & hidden_) >= bits(wall_); }

 private:
  static int bits(unsigned set) {
    int count = 0;
    for (; set != 0; set &= set - 1) ++count;
    return count;
  }

  const Filter& filter_;
  CameraAt camera_;
  unsigned wall_ = 0, hidden_ = 0;
};

}  // namespace

void WallDoubt::judge(int plane_entry) {
  PlaneEntry& wall = map_.planes[plane_entry];
  const State& state = filter_.state();
  const Block& block = state.block[wall.slot];
  const FoldRule rule = fold_rule(settings_, wall);
  const Scalar noise = rule.roughness * rule.roughness;
  const Scalar side = plane_distance(state.frame_of(block), block.xyz(), camera_at(state, Scalar(0)).p_W);
  Cover cover(filter_, map_, plane_entry);
  int on_it = outline_plane(filter_, map_, plane_entry, nullptr).folded, refused = 0, behind = 0;
  for (int i = 0; i < map_.features.capacity(); ++i) {
    Scalar d, variance;
    Mat3 covariance;
    // What is out of sight behind the wall lies on another one.
    if (!map_.features.used(i) || map_.features[i].last_seen_ns != frame_.report.t_ns) continue;
    const int slot = map_.features[i].slot;
    // A point of another plane is known well enough, and is no less on that one than here.
    const bool elsewhere = is_planar(state.block[slot].kind) && state.plane_of(slot) != wall.slot;
    if (!elsewhere && !(certain_.is_settled(i) && certain_.is_certain(i, &covariance))) continue;
    if (!is_before_wall(filter_, map_, plane_entry, filter_.point(slot))) continue;
    if (!filter_.distance(wall.slot, slot, &d, &variance)) continue;
    if (d * d > kRefusedGate * (variance + noise)) {
      ++refused;
      behind += d * side < Scalar(0);
      cover.add(filter_.point(slot));
    } else if (d * d < rule.gate * (variance + noise)) {
      ++on_it;
    }
  }
  const auto contradict = [on_it](int points) { return points >= kMinRefused && points > kRefusedShare * on_it; };
  // Points vouch for a wall that patches are refused on, half as many where not one is off it.
  const bool vouched = on_it >= (refused > 0 ? kMinRefused : kMinRefused / 2);
  const bool denied =
      (wall.outliers >= kMinRefused && wall.outliers > on_it) || (wall.is_refused_by_patches() && !vouched);
  if (!wall.doubted && (denied || contradict(behind) || (contradict(refused) && cover.is_wide()))) {
    settings_.hooks.say("wall ", wall.id, " rejected: ", on_it, " points lie on it, ", refused, " do not (", behind,
                        " behind it); ", static_cast<int>(wall.outliers), " points left it, ",
                        wall.refused / PlaneEntry::kRefusedParts, " patches were found elsewhere");
    doubt(plane_entry);
  } else if (wall.doubted && on_it >= kMinRefused && on_it > refused) {
    wall.doubted = false;
    wall.outliers = wall.upheld = wall.refused = 0;
    settings_.hooks.say("wall ", wall.id, " accepted again: ", on_it, " points lie on it, ", refused, " do not");
  }
}

void WallDoubt::doubt(int plane_entry) {
  PlaneEntry& wall = map_.planes[plane_entry];
  const int plane = wall.slot;
  const bool has_taught = filter_.state().block[plane].children > 0 || wall.refused + wall.upheld + wall.outliers > 0;
  if (has_taught && wall.prior[0] > Scalar(0)) {
    filter_.forget_prior(plane, wall.prior_covariance(), kDoubtedPrior);
    for (Scalar& c : wall.prior) c = Scalar(0);
  }
  filter_.state().for_each_planar(plane, [&](int slot) {
    const int feature = filter_.state().block[slot].owner;
    if (!filter_.unfold(slot, settings_.plane_distance)) features_.drop(&feature, 1);
  });
  wall.doubted = true;
  wall.outliers = wall.upheld = wall.refused = 0;
  wall.seen = wall.support = wall.plan;
}

}  // namespace pf
