#include "figure1.h"

#include <algorithm>

namespace pfsim::gee {
namespace {

constexpr int kTrajectoryEvery = 10;  // frames
const char* const kEllipse = "x,y,z,true_x,true_y,true_z,xx,xy,xz,yy,yz,zz\n";

const char* name(Kind kind) {
  switch (kind) {
    case Kind::kInverseDepth:
      return "inverse_depth";
    case Kind::kPoint:
      return "point";
    case Kind::kPlanar:
      return "planar";
    case Kind::kFixed:
      return "fixed";
  }
  return "";
}

}  // namespace

Figure1::Figure1(const std::string& prefix, const World& world)
    : world_(world),
      trajectory_(prefix + "_trajectory.csv"),
      camera_(prefix + "_camera.csv"),
      points_(prefix + "_points.csv"),
      planes_(prefix + "_planes.csv") {
  trajectory_ << "frame,x,y,z,true_x,true_y,true_z\n";
  camera_ << "moment,frame," << kEllipse;
  points_ << "moment,id,kind,plane,wall," << kEllipse;
  planes_ << "moment,plane,points,corner,x,y,z\n";
}

void Figure1::write(std::ofstream& out, const Vec3& p_W, const Vec3& true_W, const Mat3& covariance_W) const {
  const Mat3& R = world_.R_room_W();
  const Vec3 p = R * p_W, t = R * true_W;
  const Mat3 P = R * covariance_W * R.transpose();
  out << p.x() << ',' << p.y() << ',' << p.z() << ',' << t.x() << ',' << t.y() << ',' << t.z();
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) out << ',' << P(i, j);
  out << '\n';
}

void Figure1::add_pose(int frame, const Slam& slam) {
  if (frame % kTrajectoryEvery != 0) return;
  const Vec3 p = world_.R_room_W() * slam.pose().tail<3>(), t = world_.R_room_W() * world_.pose(frame).tail<3>();
  trajectory_ << frame << ',' << p.x() << ',' << p.y() << ',' << p.z() << ',' << t.x() << ',' << t.y() << ',' << t.z()
              << '\n';
}

void Figure1::add_map(const char* moment, int frame, const Slam& slam) {
  camera_ << moment << ',' << frame << ',';
  write(camera_, slam.pose().tail<3>(), world_.pose(frame).tail<3>(), slam.pose_covariance().bottomRightCorner<3, 3>());
  for (const auto& [id, feature] : slam.features()) {
    const WorldPoint& point = world_.points()[static_cast<std::size_t>(id)];
    points_ << moment << ',' << id << ',' << name(feature.kind) << ',' << feature.plane << ',' << point.wall << ',';
    write(points_, slam.place(feature), point.p_W, slam.place_covariance(feature));
  }
  // Each plane as the rectangle, in its own basis, about the points that were folded into it.
  for (int k = 0; k < static_cast<int>(slam.planes().size()); ++k) {
    const Plane& plane = slam.planes()[static_cast<std::size_t>(k)];
    if (plane.points.empty()) continue;
    const Vec7 s = slam.plane(k);
    Vec2 low(1e9, 1e9), high(-1e9, -1e9);
    for (const int id : plane.points) {
      const Vec2 u = fold_point(s, slam.place(slam.features().at(id)));
      low = low.cwiseMin(u);
      high = high.cwiseMax(u);
    }
    const Vec2 corners[4] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
    for (int c = 0; c < 4; ++c) {
      const Vec3 p = world_.R_room_W() * unfold_point(s, corners[c]);
      planes_ << moment << ',' << k << ',' << plane.points.size() << ',' << c << ',' << p.x() << ',' << p.y() << ','
              << p.z() << '\n';
    }
  }
}

}  // namespace pfsim::gee
