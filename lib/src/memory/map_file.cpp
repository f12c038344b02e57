#include "memory/map_file.h"

#include <algorithm>
#include <cmath>

#include "geometry/small_cholesky.h"

namespace pf {
namespace {

constexpr std::uint32_t kLensTag = section_tag("LENS"), kWorldTag = section_tag("WRLD"),
                        kPlanesTag = section_tag("PLAN"), kPlacesTag = section_tag("PLAC"),
                        kAnchorsTag = section_tag("ANCH");
constexpr std::uint32_t kTags[] = {kLensTag, kWorldTag, kPlanesTag, kPlacesTag, kAnchorsTag};
constexpr int kNumTags = 5, kMinTags = 4;  // a map without anchors has no section for them

constexpr double kMaxLength = 1e6;        // [m]
constexpr double kMaxVariance = 1e12;     // as of numbers that the caller passes in
constexpr double kMaxAcceleration = 1e3;  // [m/s^2]
constexpr double kUnitTolerance = 1e-3;   // of a squared length
constexpr double kRounding = 1e-6;        // of correlations that were computed in float
constexpr int kMaxCount = 1000000;        // of observations and points

template <typename Matrix>
void write_lower(const Matrix& P, int n, MapWriter* out) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) out->real(static_cast<double>(P(i, j)));
}

/// The lower triangle of a covariance. False: it is none.
bool read_lower(MapReader* in, int n, double* lower) {
  constexpr int kMax = 6;
  double C[kMax * kMax] = {};
  if (!in->reals(lower, n * (n + 1) / 2, kMaxVariance)) return false;
  const auto at = [&](int i, int j) { return lower[i * (i + 1) / 2 + j]; };
  for (int i = 0; i < n; ++i) {
    if (!(at(i, i) >= 0)) return false;
    for (int j = 0; j < i; ++j) {
      const double scale = std::sqrt(at(i, i)) * std::sqrt(at(j, j));
      if (!(std::fabs(at(i, j)) <= scale * (1 + kRounding))) return false;
      C[i * n + j] = scale > 0 ? at(i, j) / scale : 0.0;
    }
    C[i * n + i] = 1 + kRounding;
  }
  return factor_cholesky(C, n, n);
}

template <typename Matrix>
bool read_covariance(MapReader* in, Matrix* P) {
  constexpr int n = Matrix::RowsAtCompileTime;
  double lower[n * (n + 1) / 2];
  if (!read_lower(in, n, lower)) return false;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j)
      (*P)(i, j) = (*P)(j, i) = static_cast<typename Matrix::Scalar>(lower[i * (i + 1) / 2 + j]);
  return true;
}

template <typename T>
bool is_unit(const T* v, int n) {
  double norm2 = 0;
  for (int i = 0; i < n; ++i) norm2 += static_cast<double>(v[i]) * static_cast<double>(v[i]);
  return std::fabs(norm2 - 1) < kUnitTolerance;
}

void write_quaternion(const Quat& q, MapWriter* out) {
  out->real(static_cast<double>(q.w()));
  out->real(static_cast<double>(q.x()));
  out->real(static_cast<double>(q.y()));
  out->real(static_cast<double>(q.z()));
}

/// Whether no vertex lies to the right of an edge by more than rounding.
bool is_convex(const PlaneOutline& outline) {
  constexpr Scalar kTolerance = Scalar(1e-5);  // of the squared extent
  Scalar extent2 = 0;
  for (int i = 0; i < outline.count; ++i) extent2 = std::max(extent2, (outline.uv[i] - outline.uv[0]).squaredNorm());
  for (int i = 0; i < outline.count; ++i)
    for (int k = 0; k < outline.count; ++k)
      if (twice_area(outline.uv[i], outline.uv[(i + 1) % outline.count], outline.uv[k]) < -kTolerance * extent2)
        return false;
  return true;
}

bool is_id(std::uint32_t id) { return id > 0 && id <= kMaxSavedId; }

void write_point(const PlacePoint& p, MapWriter* out) {
  out->u32(p.id);
  out->u32(p.plane);
  out->u32(static_cast<std::uint32_t>(p.observations));
  const std::uint8_t bounds[4] = {p.patch.begin[0], p.patch.begin[1], p.patch.end[0], p.patch.end[1]};
  out->bytes(bounds, sizeof bounds);
  out->reals(p.ray_K, 3);
  out->real(static_cast<double>(p.rho));
  out->reals(p.covariance, 6);
  out->reals(p.q_KV, 4);
  out->reals(p.c_K, 3);
  out->reals(p.patch.centre, 2);
  for (const std::uint64_t word : p.descriptor.word) out->u64(word);
  out->bytes(p.patch.pixels, sizeof p.patch.pixels);
}

void write_relative(const RelativePlace& T, MapWriter* out) {
  write_quaternion(T.q, out);
  out->reals(T.p.data(), 3);
}

/// False: a number is out of its domain.
bool read_relative(MapReader* in, RelativePlace* T) {
  double q[4] = {1, 0, 0, 0};
  const bool turned = in->reals(q, 4, 1 + kUnitTolerance), placed = in->reals(T->p.data(), 3, kMaxLength);
  T->q =
      Quat(static_cast<Scalar>(q[0]), static_cast<Scalar>(q[1]), static_cast<Scalar>(q[2]), static_cast<Scalar>(q[3]));
  return turned && placed && is_unit(q, 4);
}

}  // namespace

void write_lens(const Camera& camera, MapWriter* out) {
  out->begin_section(kLensTag);
  out->u32(static_cast<std::uint32_t>(camera.model));
  out->u32(static_cast<std::uint32_t>(camera.width));
  out->u32(static_cast<std::uint32_t>(camera.height));
  out->u32(0);
  const Scalar intrinsics[4] = {camera.fx, camera.fy, camera.cx, camera.cy};
  out->reals(intrinsics, 4);
  out->reals(camera.distortion, 8);
  out->end_section();
}

void write_world(const Vec3& gravity_W, MapWriter* out) {
  out->begin_section(kWorldTag);
  out->reals(gravity_W.data(), 3);
  out->end_section();
}

void begin_planes(int count, MapWriter* out) {
  out->begin_section(kPlanesTag);
  out->u32(static_cast<std::uint32_t>(count));
}

void write_plane(const SavedPlane& plane, MapWriter* out) {
  out->u32(plane.id);
  out->u32(plane.max_points);
  out->u32(static_cast<std::uint32_t>(plane.outline.count));
  out->u32(0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out->real(static_cast<double>(plane.frame.R_WP(i, j)));
  out->reals(plane.frame.o_W.data(), 3);
  write_lower(plane.covariance, 3, out);
  for (int i = 0; i < plane.outline.count; ++i) out->reals(plane.outline.uv[i].data(), 2);
}

void begin_places(int count, MapWriter* out) {
  out->begin_section(kPlacesTag);
  out->u32(static_cast<std::uint32_t>(count));
}

void write_place(const KeptPlace& place, MapWriter* out) {
  out->u32(place.id);
  out->u32(static_cast<std::uint32_t>(place.count));
  out->real(static_cast<double>(place.depth));
  write_quaternion(place.q_WK, out);
  out->reals(place.p_WK.data(), 3);
  write_lower(place.covariance, 6, out);
  for (int i = 0; i < place.count; ++i) write_point(place.point[i], out);
}

void begin_anchors(int count, MapWriter* out) {
  out->begin_section(kAnchorsTag);
  out->u32(static_cast<std::uint32_t>(count));
}

void write_anchor(const Anchor& anchor, MapWriter* out) {
  out->u32(anchor.id);
  out->u32(anchor.place);
  out->u32(anchor.plane);
  out->u32(0);
  write_relative(anchor.T_KV, out);
  write_lower(anchor.between, 6, out);
  write_relative(anchor.T_VA, out);
  write_lower(anchor.plane == 0 ? anchor.beside : Mat6(Mat6::Zero()), 6,
              out);  // on a plane it follows from V and the plane
}

const char* SavedMap::open(const std::uint8_t* buffer, std::size_t bytes, KeptPlace* scratch) {
  MapSection section[kMaxSections];
  int sections = 0;
  const char* wrong = open_map(buffer, bytes, kPortableMap, section, &sections);
  if (wrong != nullptr) return wrong;
  if (sections < kMinTags || sections > kNumTags) return "it has not the sections of a portable map";
  for (int s = 0; s < sections; ++s)
    if (section[s].tag != kTags[s]) return "its sections are not in order";
  wrong = read_lens(section[0]);
  if (wrong == nullptr) wrong = read_world(section[1]);
  if (wrong == nullptr) wrong = check_planes(section[2]);
  if (wrong == nullptr) wrong = check_places(section[3], scratch);
  if (wrong == nullptr && sections == kNumTags) wrong = check_anchors(section[4]);
  return wrong;
}

const char* SavedMap::read_lens(const MapSection& section) {
  MapReader in(section.bytes, section.count);
  const std::uint32_t model = in.u32(), width = in.u32(), height = in.u32(), reserved = in.u32();
  double intrinsics[4], distortion[8];
  constexpr double kMost = 1e6;
  const bool finite = in.reals(intrinsics, 4, kMost) && in.reals(distortion, 8, kMost);
  if (in.failed() || in.left() != 0) return "LENS has another length";
  constexpr std::uint32_t kMostPixels = 1u << 16;
  if (!finite || reserved != 0 || model > kMostPixels || width > kMostPixels || height > kMostPixels ||
      make_camera(static_cast<std::int32_t>(model), static_cast<std::int32_t>(width), static_cast<std::int32_t>(height),
                  intrinsics, distortion, &lens_) != nullptr)
    return "LENS is no calibration";
  return nullptr;
}

const char* SavedMap::read_world(const MapSection& section) {
  MapReader in(section.bytes, section.count);
  const bool good = in.reals(gravity_W_.data(), 3, kMaxAcceleration);
  if (in.failed() || in.left() != 0) return "WRLD has another length";
  return good ? nullptr : "WRLD: gravity is no acceleration";
}

const char* SavedMap::read_plane(MapReader* in, SavedPlane* plane) {
  plane->id = in->u32();
  plane->max_points = in->u32();
  const std::uint32_t vertices = in->u32(), reserved = in->u32();
  double R[9];
  bool good = in->reals(R, 9, 1 + kUnitTolerance) && in->reals(plane->frame.o_W.data(), 3, kMaxLength);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) plane->frame.R_WP(i, j) = static_cast<Scalar>(R[3 * i + j]);
  const Mat3 RtR = plane->frame.R_WP.transpose().lazyProduct(plane->frame.R_WP);
  good = good && (RtR - Mat3::Identity()).cwiseAbs().maxCoeff() < static_cast<Scalar>(kUnitTolerance) &&
         plane->frame.R_WP.col(0).cross(plane->frame.R_WP.col(1)).dot(plane->frame.R_WP.col(2)) > Scalar(0);
  if (!read_covariance(in, &plane->covariance)) return "PLAN: a covariance is none";
  if (!is_id(plane->id) || plane->max_points > kMaxCount || vertices > kMaxOutline || reserved != 0 || !good)
    return "PLAN: a number is out of its domain";
  plane->outline.count = static_cast<int>(vertices);
  for (int i = 0; i < plane->outline.count; ++i)
    if (!in->reals(plane->outline.uv[i].data(), 2, kMaxLength)) return "PLAN: an outline is none";
  return is_convex(plane->outline) ? (in->failed() ? "PLAN is too short" : nullptr) : "PLAN: an outline is none";
}

const char* SavedMap::check_planes(const MapSection& section) {
  planes_ = section;
  MapReader in(section.bytes, section.count);
  const std::uint32_t count = in.u32();
  if (count > kMaxPlanes) return "PLAN: more planes than any config holds";
  std::uint32_t last = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    SavedPlane plane;
    const char* wrong = read_plane(&in, &plane);
    if (wrong != nullptr) return wrong;
    if (plane.id <= last) return "PLAN: ids are not in order";
    last = plane_id_[k] = plane.id;
  }
  if (in.failed() || in.left() != 0) return "PLAN has another length";
  num_planes_ = static_cast<int>(count);
  return nullptr;
}

bool SavedMap::has_plane(std::uint32_t id) const {
  return std::find(plane_id_, plane_id_ + num_planes_, id) != plane_id_ + num_planes_;
}

const char* SavedMap::read_point(MapReader* in, PlacePoint* p) {
  *p = PlacePoint();
  p->id = in->u32();
  p->plane = in->u32();
  const std::uint32_t observations = in->u32();
  std::uint8_t bounds[4];
  in->bytes(bounds, sizeof bounds);
  double lower[6] = {}, rho = 0;
  constexpr double kMinRho = 1e-6, kMaxRho = 1e6;
  const bool good = in->reals(p->ray_K, 3, 1 + kUnitTolerance) && in->reals(&rho, 1, kMaxRho);
  if (!read_lower(in, 3, lower)) return "PLAC: a covariance is none";
  for (int k = 0; k < 6; ++k) p->covariance[k] = static_cast<float>(lower[k]);
  const bool seen = in->reals(p->q_KV, 4, 1 + kUnitTolerance) && in->reals(p->c_K, 3, kMaxLength) &&
                    in->reals(p->patch.centre, 2, PlacePatch::kSize);
  for (std::uint64_t& word : p->descriptor.word) word = in->u64();
  in->bytes(p->patch.pixels, sizeof p->patch.pixels);
  if (in->failed()) return "PLAC is too short";
  p->rho = static_cast<float>(rho);
  p->observations = static_cast<std::int32_t>(std::min<std::uint32_t>(observations, kMaxCount));
  for (int axis = 0; axis < 2; ++axis) {
    p->patch.begin[axis] = bounds[axis];
    p->patch.end[axis] = bounds[2 + axis];
    if (bounds[axis] > bounds[2 + axis] || bounds[2 + axis] > PlacePatch::kSize)
      return "PLAC: a patch has no such part";
  }
  const bool in_domain = good && seen && is_id(p->id) && p->plane <= kMaxSavedId && observations <= kMaxCount &&
                         rho >= kMinRho && is_unit(p->ray_K, 3) && is_unit(p->q_KV, 4);
  return in_domain ? nullptr : "PLAC: a number of a point is out of its domain";
}

const char* SavedMap::read_place(MapReader* in, KeptPlace* place) {
  *place = KeptPlace();
  place->id = in->u32();
  const std::uint32_t points = in->u32();
  double q[4] = {1, 0, 0, 0};
  constexpr double kMinDepth = 1e-6;
  const bool good = in->reals(&place->depth, 1, kMaxLength) && in->reals(q, 4, 1 + kUnitTolerance) &&
                    in->reals(place->p_WK.data(), 3, kMaxLength);
  if (!read_covariance(in, &place->covariance)) return "PLAC: a covariance is none";
  if (!good || !is_id(place->id) || !is_unit(q, 4) || !(static_cast<double>(place->depth) >= kMinDepth) ||
      points > KeptPlace::kMaxPoints)
    return "PLAC: a number of a place is out of its domain";
  place->q_WK =
      Quat(static_cast<Scalar>(q[0]), static_cast<Scalar>(q[1]), static_cast<Scalar>(q[2]), static_cast<Scalar>(q[3]));
  place->count = static_cast<int>(points);
  for (int i = 0; i < place->count; ++i) {
    const char* wrong = read_point(in, &place->point[i]);
    if (wrong != nullptr) return wrong;
    for (int j = 0; j < i; ++j)
      if (place->point[j].id == place->point[i].id) return "PLAC: a point is twice in a place";
  }
  return nullptr;
}

const char* SavedMap::check_places(const MapSection& section, KeptPlace* scratch) {
  places_ = section;
  MapReader in(section.bytes, section.count);
  const std::uint32_t count = in.u32();
  if (count > kMaxPlaces) return "PLAC: more places than any config holds";
  std::uint32_t last = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const char* wrong = read_place(&in, scratch);
    if (wrong != nullptr) return wrong;
    if (scratch->id <= last) return "PLAC: ids are not in order";
    last = last_place_ = place_id_[k] = scratch->id;
    for (int i = 0; i < scratch->count; ++i) {
      const PlacePoint& point = scratch->point[i];
      if (point.plane != 0 && !has_plane(point.plane)) return "PLAC: a point lies on a plane that there is not";
      last_feature_ = std::max(last_feature_, point.id);
    }
  }
  if (in.failed() || in.left() != 0) return "PLAC has another length";
  num_places_ = static_cast<int>(count);
  return count > 0 ? nullptr : "it holds no place";
}

bool SavedMap::has_place(std::uint32_t id) const {
  return std::find(place_id_, place_id_ + num_places_, id) != place_id_ + num_places_;
}

const char* SavedMap::read_anchor(MapReader* in, Anchor* anchor) {
  *anchor = Anchor();
  anchor->id = in->u32();
  anchor->place = in->u32();
  anchor->plane = in->u32();
  const std::uint32_t reserved = in->u32();
  bool good = read_relative(in, &anchor->T_KV);
  if (!read_covariance(in, &anchor->between)) return "ANCH: a covariance is none";
  good = read_relative(in, &anchor->T_VA) && good;
  if (!read_covariance(in, &anchor->beside)) return "ANCH: a covariance is none";
  if (in->failed()) return "ANCH is too short";
  return good && is_id(anchor->id) && reserved == 0 ? nullptr : "ANCH: a number is out of its domain";
}

const char* SavedMap::check_anchors(const MapSection& section) {
  anchors_ = section;
  MapReader in(section.bytes, section.count);
  const std::uint32_t count = in.u32();
  if (count == 0 || count > kMaxAnchors) return "ANCH: no anchors, or more than any config holds";
  std::uint32_t last = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    Anchor anchor;
    const char* wrong = read_anchor(&in, &anchor);
    if (wrong != nullptr) return wrong;
    if (anchor.id <= last) return "ANCH: ids are not in order";
    last = anchor.id;
    if (anchor.plane != 0 && !has_plane(anchor.plane)) return "ANCH: an anchor lies on a plane that there is not";
    if (anchor.place != 0 && !has_place(anchor.place)) return "ANCH: an anchor is held by a place that there is not";
  }
  if (in.failed() || in.left() != 0) return "ANCH has another length";
  num_anchors_ = static_cast<int>(count);
  return nullptr;
}

}  // namespace pf
