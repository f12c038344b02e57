#include "track/quad_refine.h"

#include <cmath>

#include "track/tuning.h"

namespace pf {
namespace {

using namespace tuning::quad_refine;

constexpr int kMaxPlaces = 40;
constexpr int kPasses = 2;
constexpr Scalar kMinDeterminant = Scalar(1e-7);  ///< of the 2x2 normal equations, by their first entry squared
constexpr int kProfile = static_cast<int>(2 * kReach / kStep) + 1;  ///< samples across

/// Grey level between pixels. False near the border.
bool sample(const ImageView& image, const Vec2& p, Scalar* value) {
  if (!(p.x() >= 0 && p.y() >= 0)) return false;
  if (!(p.x() < static_cast<Scalar>(image.width - 1) && p.y() < static_cast<Scalar>(image.height - 1))) return false;
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const Scalar u = p.x() - static_cast<Scalar>(x), v = p.y() - static_cast<Scalar>(y);
  const std::uint8_t* a = image.pixel(x, y);
  const std::uint8_t* b = a + image.stride;
  const Scalar top = static_cast<Scalar>(a[0]) * (1 - u) + static_cast<Scalar>(a[1]) * u;
  const Scalar bottom = static_cast<Scalar>(b[0]) * (1 - u) + static_cast<Scalar>(b[1]) * u;
  *value = top * (1 - v) + bottom * v;
  return true;
}

/// Middle of the rise along the outward direction: centroid of the slopes around the steepest one, as far as the grey
/// level keeps rising. False where it rises by less than min_rise.
bool find_rise(const ImageView& image, const Vec2& p, const Vec2& outwards, Scalar min_rise, Scalar* offset) {
  Scalar grey[kProfile];
  for (int i = 0; i < kProfile; ++i) {
    if (!sample(image, p + (static_cast<Scalar>(i) * kStep - kReach) * outwards, &grey[i])) return false;
  }
  // Slopes over two steps are less noisy than over one.
  int steepest = 1;
  for (int i = 2; i < kProfile - 1; ++i) {
    if (grey[i + 1] - grey[i - 1] > grey[steepest + 1] - grey[steepest - 1]) steepest = i;
  }
  const Scalar most = grey[steepest + 1] - grey[steepest - 1];
  Scalar rise = 0, moment = 0;
  const auto add = [&](int i) {
    const Scalar slope = grey[i + 1] - grey[i - 1];
    if (!(slope > kMinSlope * most)) return false;
    rise += slope;
    moment += slope * (static_cast<Scalar>(i) * kStep - kReach);
    return true;
  };
  for (int i = steepest; i >= 1 && add(i); --i) {
  }
  for (int i = steepest + 1; i < kProfile - 1 && add(i); ++i) {
  }
  if (!(rise / 2 > min_rise)) return false;
  *offset = moment / rise;
  return true;
}

struct Side {
  Vec3 rays[kMaxPlaces];
  int count;
};

/// Rays of the rises along the side between two corner rays.
bool collect(const ImageView& image, const Camera& camera, const Vec3& a, const Vec3& b, Scalar min_rise, Side* side) {
  Vec2 pa, pb;
  if (!project(camera, a, &pa) || !project(camera, b, &pb)) return false;
  const Scalar length = (pb - pa).norm();
  const int places = length > 2 * kMaxPlaces ? kMaxPlaces : static_cast<int>(length / 2);
  // Near a corner the other side is in the way.
  const Scalar margin = kCornerMargin / length > kMinMargin ? kCornerMargin / length : kMinMargin;
  if (places < 4 || margin > kMaxMargin) return false;
  side->count = 0;
  for (int i = 0; i < places; ++i) {
    const Scalar t = margin + (1 - 2 * margin) * static_cast<Scalar>(i) / static_cast<Scalar>(places - 1);
    Vec2 p, ahead;
    if (!project(camera, Vec3((1 - t) * a + t * b), &p)) continue;
    if (!project(camera, Vec3((1 - t - kAhead) * a + (t + kAhead) * b), &ahead)) continue;
    const Vec2 along = (ahead - p).normalized();
    const Vec2 outwards(along.y(), -along.x());
    Scalar offset;
    if (!find_rise(image, p, outwards, min_rise, &offset)) continue;
    if (unproject(camera, p + offset * outwards, &side->rays[side->count])) ++side->count;
  }
  return side->count >= 4 && kMinRises * side->count >= places;
}

/// Plane through the optical centre, n · ray = 0: small rotations of the first n about the two directions in it. rms in radians.
bool fit_plane(const Side& side, const Vec3& a, const Vec3& b, Scalar robust, Vec3* normal, Scalar* rms) {
  Vec3 n = a.cross(b).normalized();
  const Vec3 across = (a + b).normalized();
  for (int pass = 0; pass < 5; ++pass) {
    const Vec3 middle = (across - n * n.dot(across)).normalized(), along = n.cross(middle);
    Scalar A00 = 0, A01 = 0, A11 = 0, b0 = 0, b1 = 0;
    for (int i = 0; i < side.count; ++i) {
      const Vec3& ray = side.rays[i];
      const Scalar r = n.dot(ray), u = middle.dot(ray), v = along.dot(ray);
      const Scalar w = 1 / (1 + (r / robust) * (r / robust));
      A00 += w * u * u;
      A01 += w * u * v;
      A11 += w * v * v;
      b0 -= w * u * r;
      b1 -= w * v * r;
    }
    const Scalar det = A00 * A11 - A01 * A01;
    if (!(det > kMinDeterminant * A00 * A00)) return false;
    const Scalar x = (A11 * b0 - A01 * b1) / det, y = (A00 * b1 - A01 * b0) / det;
    n = (n + x * middle + y * along).normalized();
  }
  Scalar sum = 0, weights = 0;
  for (int i = 0; i < side.count; ++i) {
    const Scalar r = n.dot(side.rays[i]), w = 1 / (1 + (r / robust) * (r / robust));
    sum += w * r * r;
    weights += w;
  }
  *normal = n;
  *rms = std::sqrt(sum / weights);
  return weights > static_cast<Scalar>(side.count) / 2;
}

/// Diagonal of what is seen, for comparing residuals with the size [px].
Scalar diagonal(const Quad& quad) {
  return std::fmax((quad.corners[2] - quad.corners[0]).norm(), (quad.corners[3] - quad.corners[1]).norm());
}

}  // namespace

bool refine_quad(const ImageView& image, const Camera& camera, Quad* quad) {
  const Scalar focal = (camera.fx + camera.fy) / 2;
  Vec3 rays[4], normals[4];
  Scalar worst = 0;
  for (int i = 0; i < 4; ++i) {
    if (!unproject(camera, quad->corners[i], &rays[i])) return false;
  }
  for (int pass = 0; pass < kPasses; ++pass) {
    worst = 0;
    for (int i = 0; i < 4; ++i) {
      const Vec3 &a = rays[i], &b = rays[(i + 1) & 3];
      Side side;
      Scalar rms;
      if (!collect(image, camera, a, b, quad->contrast / 2, &side)) return false;
      if (!fit_plane(side, a, b, kRobust / focal, &normals[i], &rms)) return false;
      if (rms * focal > worst) worst = rms * focal;
    }
    for (int i = 0; i < 4; ++i) {
      const Vec3 meet = normals[(i + 3) & 3].cross(normals[i]);
      const Scalar size = meet.norm();
      if (!(size > kMinMeeting)) return false;
      rays[i] = meet.dot(rays[i]) > 0 ? Vec3(meet / size) : Vec3(meet / -size);
    }
  }
  if (!(worst < kMaxRms)) return false;
  Vec2 corners[4];
  for (int i = 0; i < 4; ++i) {
    if (!project(camera, rays[i], &corners[i])) return false;
    if (!((corners[i] - quad->corners[i]).norm() < kMaxMove)) return false;
  }
  for (int i = 0; i < 4; ++i) quad->corners[i] = corners[i];
  quad->rms_px = worst;
  return true;
}

bool is_in_scene(const Quad& quad, const ImageMask* mask) {
  mask = in_use(mask);
  if (mask == nullptr) return true;
  constexpr int kPlaces = 20, kAround = 2;  // of a side; [px]
  for (int i = 0; i < 4; ++i) {
    const Vec2 &from = quad.corners[i], &to = quad.corners[(i + 1) % 4];
    if (!mask->is_clear(from, kAround)) return false;
    int clear = 0;
    for (int k = 0; k < kPlaces; ++k)
      clear += mask->is_clear(Vec2(from + (to - from) * (static_cast<Scalar>(k) / kPlaces)), kAround);
    if (kMinClear * clear < kPlaces) return false;
  }
  return true;
}

bool find_dark_rectangle(const ImageView& image, const Camera& camera, Scalar width, Scalar height, Scalar sigma_px,
                         const QuadWorkspace& workspace, RectangleSighting* out, const ImageMask* mask) {
  constexpr int kCandidates = 16;
  Quad quads[kCandidates];
  const int count = find_dark_quads(image, workspace, quads, kCandidates);
  Scalar best = 0;
  for (int i = 0; i < count; ++i) {
    RectangleSighting found;
    found.quad = quads[i];
    if (!is_in_scene(found.quad, mask) || !refine_quad(image, camera, &found.quad)) continue;
    if (!rectangle_pose(camera, width, height, found.quad.corners, sigma_px, &found.pose, &found.second_rms_px))
      continue;
    const Scalar misfit = found.pose.rms_px / (kMisfitSigmas * sigma_px + kMisfitShare * diagonal(found.quad));
    const Scalar frontal = -found.pose.p_WC.z() / found.pose.p_WC.norm();  // cosine of the slant
    if (!(misfit < 1) || !(frontal > kMinFrontal)) continue;
    const Scalar score = quads[i].contrast * quads[i].area * frontal * frontal * (1 - misfit * misfit / 2);
    if (!(score > best)) continue;
    best = score;
    *out = found;
  }
  return best > 0;
}

}  // namespace pf
