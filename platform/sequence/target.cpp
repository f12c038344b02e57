#include "target.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "file.h"
#include "numbers.h"
#include "refuse.h"
#include "yaml_fields.h"

namespace pf::sequence {

namespace {

constexpr double kLargest = 1000.0;  ///< [m] of a target's side, point or distance; more is a mistaken unit

constexpr double kRectangleSigma = 0.0005;
constexpr double kPointSigma = 0.001;
constexpr double kFirstPositionSigma = 0.02;
constexpr double kFirstRotationSigma = 0.05;
constexpr double kFirstPoseDegrees = 3.0;

double positive(const Fields& fields, const char* key, double value, double largest) {
  if (!(value > 0.0) || value > largest) {
    char why[96];
    std::snprintf(why, sizeof(why), "is %g; more than 0 and at most %g is possible", value, largest);
    fields.refuse_field(key, why);
  }
  return value;
}

pf_target_t rectangle_of(double width, double height, double sigma) {
  pf_target_t target{};
  target.kind = PF_TARGET_RECTANGLE;
  target.width = width;
  target.height = height;
  target.sigma = sigma;
  target.first_pose.q_WC[0] = 1.0;
  return target;
}

void set_points(const Fields& fields, const char* key, pf_target_t& target) {
  const auto points = fields.rows(key, PF_TARGET_MAX_POINTS, 3);
  if (points.size() < 4) {
    fields.refuse_field(key, "has " + std::to_string(points.size()) + " points; 4 to " +
                                 std::to_string(PF_TARGET_MAX_POINTS) + " are needed");
  }
  target.count = static_cast<int32_t>(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      if (std::fabs(points[i][k]) > kLargest) {
        fields.refuse_field(key, "has a point farther than 1000 m from the origin; the unit is the metre");
      }
      target.points_W[i][k] = points[i][k];
    }
    for (size_t j = 0; j < i; ++j) {
      if (points[i] == points[j]) {
        fields.refuse_field(key, "has the same point twice");
      }
    }
  }
}

void set_quaternion(const Fields& fields, const char* key, double q_out[4]) {
  const std::vector<double> q = fields.numbers(key, 4);
  if (q.size() != 4) {
    fields.refuse_field(key, "must be four numbers: w, x, y, z");
  }
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::fabs(norm - 1.0) < 0.01)) {
    fields.refuse_field(key, "must have length 1");
  }
  for (size_t i = 0; i < 4; ++i) {
    q_out[i] = q[i] / norm;
  }
}

void set_first_pose(const Fields& fields, const char* position_key, const char* quaternion_key, pf_target_t& target) {
  const std::vector<double> position = fields.numbers(position_key, 3);
  if (position.size() != 3) {
    fields.refuse_field(position_key, "must be three numbers [m]");
  }
  set_quaternion(fields, quaternion_key, target.first_pose.q_WC);
  for (size_t i = 0; i < 3; ++i) {
    if (std::fabs(position[i]) > kLargest) {
      fields.refuse_field(position_key, "is farther than 1000 m from the origin; the unit is the metre");
    }
    target.first_pose.p_WC[i] = position[i];
  }
  const double sigma_rotation =
      positive(fields, "sigma_rotation", fields.number_or("sigma_rotation", kFirstRotationSigma), 3.15);
  const double sigma_position =
      positive(fields, "sigma_position", fields.number_or("sigma_position", kFirstPositionSigma), kLargest);
  for (size_t i = 0; i < 3; ++i) {
    target.first_pose.covariance[7 * i] = sigma_rotation * sigma_rotation;
    target.first_pose.covariance[7 * (i + 3)] = sigma_position * sigma_position;
  }
}

/// Where a rectangle is in W; nothing where the file does not say it.
void set_place(const Fields& fields, pf_target_t& target) {
  if (!fields.has("q_WT") && !fields.has("p_WT")) {
    return;
  }
  set_quaternion(fields, "q_WT", target.q_WT);
  const std::vector<double> p = fields.numbers("p_WT", 3);
  if (p.size() != 3) {
    fields.refuse_field("p_WT", "must be three numbers [m]");
  }
  for (size_t i = 0; i < 3; ++i) {
    if (std::fabs(p[i]) > kLargest) {
      fields.refuse_field("p_WT", "is farther than 1000 m from the origin; the unit is the metre");
    }
    target.p_WT[i] = p[i];
  }
}

/// SceneLib's camera axes are x left, y up, z forward; those of planefold are x right, y down, z forward. Both are right-handed
/// and differ by half a turn about z, so with q_WC for SceneLib's camera
///   R_WC = R_scenelib diag(-1, -1, 1)        as quaternions   q_WC = q_scenelib * (0, 0, 0, 1)
/// The world stays as the file has it.
void turn_scenelib_camera(double q[4]) {
  const double w = q[0];
  const double x = q[1];
  const double y = q[2];
  const double z = q[3];
  q[0] = -z;
  q[1] = y;
  q[2] = -x;
  q[3] = w;
}

pf_target_t read_fields(const Fields& fields) {
  std::vector<std::string> ignored;  // none: the forms are ours
  pf_target_t target = rectangle_of(0.0, 0.0, kPointSigma);
  if (fields.has("features")) {
    fields.check_keys(
        {{"features", "start_camera_position", "start_camera_quat_wxyz", "sigma", "sigma_position", "sigma_rotation"},
         {},
         true},
        ignored);
    target.kind = PF_TARGET_POINTS;
    set_points(fields, "features", target);
    set_first_pose(fields, "start_camera_position", "start_camera_quat_wxyz", target);
    turn_scenelib_camera(target.first_pose.q_WC);
  } else if (fields.has("points")) {
    target.kind = PF_TARGET_POINTS;
    const char* pose = fields.has("T_WC") ? "T_WC" : "first_pose";
    fields.check_keys({{"points", pose, "sigma"}, {"comment"}, true}, ignored);
    fields.below(pose).check_keys({{"position", "quaternion_wxyz", "sigma_position", "sigma_rotation"}, {}, true},
                                  ignored);
    set_points(fields, "points", target);
    set_first_pose(fields.below(pose), "position", "quaternion_wxyz", target);
  } else if (fields.has("width") || fields.has("height")) {
    fields.check_keys({{"width", "height", "sigma", "q_WT", "p_WT"}, {"comment"}, true}, ignored);
    set_place(fields, target);
    target.width = positive(fields, "width", fields.number("width"), kLargest);
    target.height = positive(fields, "height", fields.number("height"), kLargest);
    target.sigma = kRectangleSigma;
  } else {
    refuse(fields.file() +
           ": is no target; it needs width and height [m] of a dark rectangle, or points and first_pose");
  }
  target.sigma = positive(fields, "sigma", fields.number_or("sigma", target.sigma), 1.0);
  return target;
}

}  // namespace

pf_target_t parse_target(const std::string& text, const std::string& file) {
  pf_target_t target{};
  read_with_hints(Fields(text, file), [&](const Fields& fields) { target = read_fields(fields); });
  return target;
}

pf_target_t read_target(const std::string& path) {
  return parse_target(read_text(path, kMaxYamlBytes, "target"), path);
}

pf_pose_t parse_first_pose(const std::string& text, const std::string& file) {
  std::vector<double> number;
  for (size_t begin = 0, lines = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    const size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') {
      continue;
    }
    if (++lines > 1) {
      refuse(file + ": has more than one pose; the pose of the first frame is wanted, alone");
    }
    for (size_t from = first; from != std::string::npos;) {
      const size_t to = std::min(line.find_first_of(" \t\r", from), line.size());
      double value = 0.0;
      if (!parse_double(line.substr(from, to - from), value) || !std::isfinite(value)) {
        refuse(file + ": number " + std::to_string(number.size() + 1) + " of the pose is not a finite number");
      }
      number.push_back(value);
      from = line.find_first_not_of(" \t\r", to);
    }
  }
  if (number.size() != 8 && number.size() != 10) {
    refuse(file +
           ": a pose is one line: seconds x y z qx qy qz qw, and behind it sigma_position_m and sigma_rotation_deg or "
           "neither");
  }
  pf_pose_t pose{};
  constexpr double kMaxSeconds = 9e9;
  if (!(std::fabs(number[0]) < kMaxSeconds)) {
    refuse(file + ": the time of the pose is no time in seconds");
  }
  pose.t_ns = static_cast<int64_t>(std::llround(number[0] * 1e9));
  double norm = 0.0;
  for (size_t i = 4; i < 8; ++i) {
    norm += number[i] * number[i];
  }
  norm = std::sqrt(norm);
  if (!(std::fabs(norm - 1.0) < 0.01)) {
    refuse(file + ": the quaternion qx qy qz qw must have length 1");
  }
  pose.q_WC[0] = number[7] / norm;
  for (size_t i = 0; i < 3; ++i) {
    pose.q_WC[1 + i] = number[4 + i] / norm;
    pose.p_WC[i] = number[1 + i];
    if (std::fabs(pose.p_WC[i]) > 1e5) {
      refuse(file + ": the position is farther than 100 km from the origin; the unit is the metre");
    }
  }
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  const double sigma_position = number.size() == 10 ? number[8] : kFirstPositionSigma;
  const double sigma_rotation = kDegree * (number.size() == 10 ? number[9] : kFirstPoseDegrees);
  if (!(sigma_position > 0.0 && sigma_position <= kLargest)) {
    refuse(file + ": sigma_position_m must be more than 0 and at most 1000");
  }
  if (!(sigma_rotation > 0.0 && sigma_rotation <= 180.0 * kDegree)) {
    refuse(file + ": sigma_rotation_deg must be more than 0 and at most 180");
  }
  for (size_t i = 0; i < 3; ++i) {
    pose.covariance[7 * i] = sigma_rotation * sigma_rotation;
    pose.covariance[7 * (i + 3)] = sigma_position * sigma_position;
  }
  return pose;
}

pf_pose_t read_first_pose(const std::string& path) {
  return parse_first_pose(read_text(path, kMaxYamlBytes, "pose"), path);
}

pf_target_t parse_rectangle(const std::string& text) {
  const size_t cross = text.find_first_of("xX");
  double width = 0.0;
  double height = 0.0;
  if (cross == std::string::npos || !parse_double(text.substr(0, cross), width) ||
      !parse_double(text.substr(cross + 1), height) || !(width > 0.0 && width <= kLargest) ||
      !(height > 0.0 && height <= kLargest)) {
    refuse("rectangle:" + text + ": is not a size; write width and height in metres, as in rectangle:0.21x0.148");
  }
  return rectangle_of(width, height, kRectangleSigma);
}

}  // namespace pf::sequence
