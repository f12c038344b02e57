#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/linear.h"
#include "sim/random.h"
#include "sim/texture.h"

namespace pf::sim {

enum class Shape { kRectangle, kPerson };

/// A flat textured rectangle, seen from the side that u x v points away from (u right, v down, u x v into the wall).
struct Quad {
  Vec3 corner_W;                 // where u = v = 0 [m]
  Vec3 u_W, v_W;                 // unit and orthogonal
  double width = 0, height = 0;  // along u and v [m]
  std::shared_ptr<const Texture> texture;
  Shape shape = Shape::kRectangle;

  Vec3 normal_W() const { return u_W.cross(v_W); }
  Vec3 at(double u, double v) const { return corner_W + u_W * u + v_W * v; }
};

/// What there is to see. With a target, W is its centre: x right, y down, z into the wall.
struct Scene {
  std::vector<Quad> quads;
  double target_width = 0, target_height = 0;  // [m], 0: no target
  int person = -1;                             // which quad walks, -1: none
  Vec3 person_start_W, person_velocity_W;      // where its corner is at time 0, and how it moves [m/s]
};

struct SceneOptions {
  bool target = true;
  bool repeated_texture = false;
  bool person = false;
};

/// A table with a box that carries the target, books, a monitor and papers; a wall behind, one beside, the floor.
Scene make_desk(Random& random, const SceneOptions& options);
/// A corridor of 2 m x 17 m with posters and doors; the target on one of its long walls.
Scene make_corridor(Random& random, const SceneOptions& options);
/// A closed room of 4 m x 4 m x 2.6 m with pictures, cupboards and boxes; the target on one wall.
Scene make_room(Random& random, const SceneOptions& options);
/// One large wall with the target on it.
Scene make_wall(Random& random, const SceneOptions& options);
/// Two planes that face the camera, in a checkerboard: squares before a wall, both with the same kind of texture. The target hangs in the
/// plane of the squares. After Masoud 2015, Figure 2
Scene make_two_depths(Random& random, const SceneOptions& options);
/// Boards and posts at many depths before a wall: most of what has texture is near the rim of something. The target hangs in the middle.
Scene make_clutter(Random& random, const SceneOptions& options);
/// Leaves anywhere in a volume, at all slants, before nothing: no plane holds more than a few points. The target hangs in the middle.
Scene make_bushes(Random& random, const SceneOptions& options);
/// A room of 4 m x 4 m x 2.6 m whose four walls look the same; no target.
Scene make_equal_room(Random& random, const SceneOptions& options);
/// A corridor of 2 m x 18 m whose walls repeat every 2 m; no target.
Scene make_equal_doors(Random& random, const SceneOptions& options);
/// A checker board of `square` metres in the plane z = 0, its corner of squares at the origin.
Scene make_checker(double square, int squares);

}  // namespace pf::sim
