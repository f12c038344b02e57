#include "world.h"

namespace pfsim::gee {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kHalf = 2.0;    // walls at +-2 m
constexpr double kMargin = 0.1;  // points on no wall keep this distance from all [m]
constexpr double kRadius = 1.0;  // of the circle [m]

/// The room's axes in the world. Oblique: the direction of the world's y, where eq. 5 and the rays of inverse depth have their
/// pole, is 30 degrees off every wall and 45 degrees above every level line of sight.
Mat3 room_axes(bool upright) {
  Mat3 R_W_room;
  if (upright) {
    R_W_room << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // room (x, y, z) to world (x, -z, y)
    return R_W_room.transpose();
  }
  const Vec3 y_room = Vec3(0.5, 0.5, std::sqrt(0.5));  // the world's y in the room
  const Vec3 x_room = Vec3(1, -1, 0).normalized();
  Mat3 R_room_W;
  R_room_W << x_room, y_room, x_room.cross(y_room);
  return R_room_W;
}

}  // namespace

World::World(const WorldOptions& options, std::uint64_t seed)
    : options_(options),
      camera_(Camera::with_field_of_view(options.fov_deg)),
      layout_(seed, 21),
      noise_(seed, 22),
      R_room_W_(room_axes(options.upright)) {
  const Mat3 R_W_room = R_room_W_.transpose();
  // The known square, seen obliquely from the first pose.
  const Vec7 start = pose(0);
  const Mat3 R_WC = rotation_of(start.head<4>());
  const Mat3 slant = R_WC * Eigen::AngleAxisd(options.target_slant_deg * kPi / 180, Vec3::UnitY()).toRotationMatrix();
  const Vec3 centre = start.tail<3>() + options.target_distance * R_WC.col(2);
  for (int k = 0; k < kTarget; ++k)
    points_.push_back({centre + slant * (options.target_size * Vec3(k % 2 - 0.5, k / 2 - 0.5, 0)), -1});
  const double h = options.half_height, inside = kHalf - kMargin;
  for (int k = 0; k < 200; ++k) {
    const double z = layout_.uniform(-h, h);
    if (k < 100) {
      const int wall = layout_.below(4);
      const double along = layout_.uniform(-kHalf, kHalf), across = wall < 2 ? kHalf : -kHalf;
      points_.push_back({R_W_room * (wall % 2 ? Vec3(across, along, z) : Vec3(along, across, z)), wall});
    } else {
      double x = 0, y = 0;
      do {
        x = layout_.uniform(-inside, inside);
        y = layout_.uniform(-inside, inside);
      } while (std::hypot(x, y) < options_.clear_radius);
      points_.push_back({R_W_room * Vec3(x, y, z), -1});
    }
  }
}

Vec7 World::pose(int frame) const {
  const double angle = 2 * kPi * frame / options_.frames_per_loop;
  const Vec3 radial(std::cos(angle), std::sin(angle), 0), down(0, 0, -1);
  const Vec3 forward = options_.look_inward ? Vec3(-radial) : radial;
  Mat3 R_room_C;
  R_room_C << down.cross(forward), down, forward;
  const Mat3 R_W_room = R_room_W_.transpose();
  Vec7 v;
  v << quaternion_of(R_W_room * R_room_C), R_W_room * radial * kRadius;
  return v;
}

bool World::in_view(int id, int frame) const {
  if (id < kTarget && options_.target_frames > 0 && frame >= options_.target_frames) return false;
  const Vec7 v = pose(frame);
  Vec2 z = Vec2::Zero();
  const Vec3& p = points_[static_cast<std::size_t>(id)].p_W;
  const double depth = rotation_of(v.head<4>()).col(2).dot(p - v.tail<3>());
  return depth > options_.nearest && project(camera_, v, p, &z) && camera_.sees(z);
}

std::vector<Measurement> World::observe(int frame) {
  std::vector<Measurement> seen;
  const Vec7 v = pose(frame);
  for (int id = 0; id < static_cast<int>(points_.size()); ++id) {
    if (!in_view(id, frame)) continue;
    Vec2 z = Vec2::Zero();
    project(camera_, v, points_[static_cast<std::size_t>(id)].p_W, &z);
    const double ex = noise_.normal(), ey = noise_.normal();
    seen.push_back({id, z + options_.sigma_px * Vec2(ex, ey)});
  }
  return seen;
}

}  // namespace pfsim::gee
