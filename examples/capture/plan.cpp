#include "plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "rows.h"

namespace pf::capture {

namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979323846;

double rounded(double value) { return std::round(1e6 * value) / 1e6; }

/// Angle between the normals of the plan and of the map [deg].
double rotation_deg(const pf_wall_prior_t& prior, const pf_plane_t& plane) {
  const Vec3 a = {prior.R_WP[2], prior.R_WP[5], prior.R_WP[8]};
  const Vec3 b = {plane.normal_W[0], plane.normal_W[1], plane.normal_W[2]};
  const Vec3 c = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  return kDegrees * std::atan2(std::sqrt(dot(c, c)), dot(a, b));
}

/// How far the plane now is from the wall's own centre in the plan, along its normal [m].
double offset_m(const pf_wall_prior_t& prior, const pf_plane_t& plane) {
  double at = -plane.distance;
  for (size_t i = 0; i < 3; ++i) at += plane.normal_W[i] * prior.p_WP[i];
  return -at;
}

Vec3 column(const pf_wall_prior_t& wall, size_t axis) {
  return {wall.R_WP[axis], wall.R_WP[3 + axis], wall.R_WP[6 + axis]};
}

Vec3 difference(const double a[3], const double b[3]) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// Whether the wall stands between two points, whichever of its sides is towards the first: one whose corners go the wrong way round must
/// not show all that stands behind it.
bool hides(const pf_wall_prior_t& wall, const double from_W[3], const double to_W[3]) {
  const Vec3 n = column(wall, 2);
  const double a = dot(n, difference(from_W, wall.p_WP)), b = dot(n, difference(to_W, wall.p_WP));
  if (a * b >= 0.0) return false;
  double hit_W[3];
  for (size_t i = 0; i < 3; ++i) hit_W[i] = from_W[i] + (to_W[i] - from_W[i]) * a / (a - b);
  const Vec3 at = difference(hit_W, wall.p_WP);
  const double u = dot(column(wall, 0), at), v = dot(column(wall, 1), at);
  for (int32_t k = 0; k < wall.outline_count; ++k) {
    const double *p = wall.outline_P[k], *q = wall.outline_P[(k + 1) % wall.outline_count];
    if ((q[0] - p[0]) * (v - p[1]) < (q[1] - p[1]) * (u - p[0])) return false;  // counter-clockwise
  }
  return true;
}

/// Whether the middle of the wall is in the image, seen from behind.
bool shows_its_back(const pf_wall_prior_t& wall, const pf_pose_t& pose, const pf_camera_t& camera) {
  constexpr double kSigmas = 3.0;
  const double ahead = dot(column(wall, 2), difference(pose.p_WC, wall.p_WP));
  if (wall.two_sided != 0 || ahead > -kSigmas * std::sqrt(wall.covariance[8])) return false;
  const Vec3 p_C = to_camera(pose, {wall.p_WP[0], wall.p_WP[1], wall.p_WP[2]});
  double pixel[2];
  return pf_camera_project(&camera, p_C.data(), pixel) == PF_OK && pixel[0] >= 0.0 && pixel[1] >= 0.0 &&
         pixel[0] < camera.width && pixel[1] < camera.height;
}

/// Whether a ray of the image, of a grid of them, meets the wall on a side that can be seen.
bool is_in_view(const pf_wall_prior_t& wall, const pf_pose_t& pose, const pf_camera_t& camera) {
  constexpr int kSide = 16;
  constexpr double kFar = 1e4;  // [m]
  if (wall.two_sided == 0 && dot(column(wall, 2), difference(pose.p_WC, wall.p_WP)) <= 0.0) return false;
  for (int cell = 0; cell < kSide * kSide; ++cell) {
    const double pixel[2] = {(cell % kSide + 0.5) * camera.width / kSide, (cell / kSide + 0.5) * camera.height / kSide};
    double ray_C[3];
    if (pf_camera_unproject(&camera, pixel, ray_C) != PF_OK) continue;
    Vec3 far_W = {pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]};
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 column_W = rotation_column(pose.q_WC, axis);
      for (size_t i = 0; i < 3; ++i) far_W[i] += kFar * ray_C[axis] * column_W[i];
    }
    if (hides(wall, pose.p_WC, far_W.data())) return true;
  }
  return false;
}

/// A wall that is longer or higher than any: its lengths are hardly metres.
std::string doubt_of_size(const pf_walls_t& walls) {
  constexpr double kLongest = 300.0;  // [m]
  for (int32_t i = 0; i < walls.count; ++i) {
    const pf_wall_prior_t& wall = walls.wall[i].prior;
    double size = 0.0;
    for (int32_t k = 0; k < wall.outline_count; ++k) {
      for (int32_t j = 0; j < k; ++j) {
        size = std::max(
            size, std::hypot(wall.outline_P[k][0] - wall.outline_P[j][0], wall.outline_P[k][1] - wall.outline_P[j][1]));
      }
    }
    if (size > kLongest) {
      char text[160];
      std::snprintf(text, sizeof(text),
                    "' measures %.5g m across; lengths are metres: were they millimetres, write them times 0.001",
                    size);
      return std::string("--walls: wall '") + walls.wall[i].name + text;
    }
  }
  return "";
}

}  // namespace

bool Plan::open(const std::string& path, bool tell_depths, std::string& error) {
  if (path.empty()) return true;
  must_see_wall_ = tell_depths;
  char message[PF_WALLS_MESSAGE] = "";
  const auto read = std::make_unique<pf_walls_t>();
  if (pf_read_walls(path.c_str(), read.get(), message) != 0) {
    error = std::string("--walls ") + message;
    return false;
  }
  walls_ = *read;
  return true;
}

bool Plan::add_to(pf_slam_t* slam, std::string& error) {
  id_.assign(static_cast<size_t>(walls_.count), 0);
  for (int32_t i = 0; i < walls_.count; ++i) {
    const pf_status_t status = pf_add_wall(slam, &walls_.wall[i].prior, &id_[static_cast<size_t>(i)]);
    if (status >= PF_OK) continue;
    error = std::string("--walls: wall '") + walls_.wall[i].name + "' is rejected: " + pf_status_text(status);
    if (status == PF_ERROR_STATE)
      error =
          "--walls needs planes, and a start in the plan's frame: --start pose:FILE, or target:FILE with points or "
          "with q_WT and p_WT";
    if (status == PF_ERROR_FULL) error += "; raise --max-planes or --max-state-dim";
    return false;
  }
  if (walls_.has_up == 0) return true;
  const double gravity_W[3] = {-walls_.up_W[0], -walls_.up_W[1], -walls_.up_W[2]};
  return pf_set_gravity(slam, gravity_W) >= PF_OK;
}

bool Plan::take_notice(const FrameView& view, const pf_camera_t& camera, std::string& line) {
  if (!told_size_) {
    told_size_ = true;
    line = doubt_of_size(walls_);
    if (!line.empty()) return true;
  }
  told_.resize(static_cast<size_t>(walls_.count));
  for (int32_t i = 0; i < walls_.count && view.has_pose; ++i) {
    const pf_wall_prior_t& wall = walls_.wall[i].prior;
    if (told_[static_cast<size_t>(i)] || !shows_its_back(wall, view.pose, camera)) continue;
    const bool hidden = std::any_of(walls_.wall, walls_.wall + walls_.count,
                                    [&](const pf_wall_t& w) { return hides(w.prior, view.pose.p_WC, wall.p_WP); });
    if (hidden) continue;
    told_[static_cast<size_t>(i)] = true;
    must_see_wall_ = false;  // this line says why
    line = std::string("--walls: the camera sees wall '") + walls_.wall[i].name +
           "' from its back side, where it does not count; turn its corners (or seen_from) round if it looks this way";
    return true;
  }
  if (!must_see_wall_ || !view.has_pose) return false;
  must_see_wall_ = false;
  if (std::any_of(walls_.wall, walls_.wall + walls_.count,
                  [&](const pf_wall_t& w) { return is_in_view(w.prior, view.pose, camera); }))
    return false;
  line =
      "--walls: the camera sees no wall at the first pose, so that nothing tells how large the map is until one comes "
      "into view";
  return true;
}

nlohmann::ordered_json Plan::to_json(const pf_slam_t* slam) const {
  auto json = nlohmann::ordered_json::array();
  std::vector<pf_plane_t> planes(64);
  size_t count = 0;
  if (pf_get_planes(slam, planes.data(), planes.size(), &count) < PF_OK) count = 0;
  planes.resize(std::min(count, planes.size()));
  for (size_t i = 0; i < id_.size(); ++i) {
    const pf_wall_t& wall = walls_.wall[i];
    const auto is_it = [&](const pf_plane_t& plane) { return plane.id == id_[i]; };
    const auto plane = std::find_if(planes.begin(), planes.end(), is_it);
    nlohmann::ordered_json row = {{"name", wall.name}, {"id", id_[i]}};
    if (plane == planes.end()) {  // the estimate was given up, and the plan's frame with it
      row["gone"] = true;
      json.push_back(row);
      continue;
    }
    row["rejected"] = plane->rejected != 0;
    row["doubted"] = row["rejected"];  // the name until 0.2
    row["points"] = plane->points;
    row["rotation_deg"] = rounded(rotation_deg(wall.prior, *plane));
    row["offset_m"] = rounded(offset_m(wall.prior, *plane));
    row["sigma_deg"] = rounded(kDegrees * std::sqrt(std::max(plane->covariance[0], plane->covariance[4])));
    row["sigma_m"] = rounded(std::sqrt(plane->covariance[8]));
    json.push_back(row);
  }
  return json;
}

/// Walls that are doubted, and those that went with an estimate that was given up.
void Plan::add_rejections(const pf_slam_t* slam, std::vector<Rejection>& rejections) const {
  for (const nlohmann::ordered_json& row : to_json(slam)) {
    const std::string what = "wall '" + row["name"].get<std::string>() + "'";
    if (row.contains("gone")) {
      rejections.push_back({what, "--walls: " + what +
                                      " is not in the map any more: the estimate was given up, and the plan's frame "
                                      "with it; check the first pose and the plan"});
    } else if (row["doubted"].get<bool>()) {
      rejections.push_back({what, "--walls: the pictures contradict " + what +
                                      ", which takes no points any more; check its corners, and the first pose"});
    }
  }
}

std::vector<std::vector<Vec3>> Plan::outlines() const {
  std::vector<std::vector<Vec3>> outlines;
  for (int32_t i = 0; i < walls_.count; ++i) {
    const pf_wall_prior_t& prior = walls_.wall[i].prior;
    std::vector<Vec3>& outline = outlines.emplace_back();
    for (int32_t k = 0; k < prior.outline_count; ++k) {
      Vec3& p = outline.emplace_back();
      for (size_t j = 0; j < 3; ++j)
        p[j] =
            prior.p_WP[j] + prior.R_WP[3 * j] * prior.outline_P[k][0] + prior.R_WP[3 * j + 1] * prior.outline_P[k][1];
    }
  }
  return outlines;
}

}  // namespace pf::capture
