#include <planefold_platform/walls.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "fields.h"

/// The walls file: upright walls on a line of the plan, and faces by their corners.

namespace pf::walls {

namespace {

using Vec3 = std::array<double, 3>;

constexpr size_t kMaxBytes = 4u << 20;
constexpr double kLargestSize = 1e4;    ///< [m] of a wall; more is a mistaken unit
constexpr double kSmallestSize = 1e-3;  ///< [m]
constexpr double kLargestAngle = 45.0;  ///< [deg] sigma
constexpr double kLargestOffset = 100;  ///< [m] sigma
constexpr double kDegree = 3.14159265358979323846 / 180.0;

Vec3 operator-(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3 scaled(const Vec3& a, double s) { return {s * a[0], s * a[1], s * a[2]}; }
Vec3 unit(const Vec3& a) { return scaled(a, 1.0 / std::sqrt(dot(a, a))); }

/// Sets the frame: z the normal, x horizontal, y up where that means anything.
void set_frame(const Vec3& normal, const Vec3& up, const Vec3& centre, pf_wall_prior_t& prior) {
  Vec3 x = cross(up, normal);
  if (dot(x, x) < 1e-6) x = cross(std::fabs(normal[0]) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, normal);
  x = unit(x);
  const Vec3 y = cross(normal, x);
  for (size_t i = 0; i < 3; ++i) {
    prior.R_WP[3 * i] = x[i];
    prior.R_WP[3 * i + 1] = y[i];
    prior.R_WP[3 * i + 2] = normal[i];
    prior.p_WP[i] = centre[i];
  }
}

/// alpha tilts the normal along x, which is a rotation about up; beta out of the vertical.
void set_sigmas(const Fields& fields, pf_wall_prior_t& prior) {
  const double rotation = kDegree * fields.positive("sigma_rotation_deg", kLargestAngle);
  const double vertical = kDegree * fields.positive("sigma_vertical_deg", kLargestAngle);
  const double offset = fields.positive("sigma_offset_m", kLargestOffset);
  prior.covariance[0] = rotation * rotation;
  prior.covariance[4] = vertical * vertical;
  prior.covariance[8] = offset * offset;
  if (!fields.has("roughness_m")) return;
  prior.roughness = fields.positive("roughness_m", 1.0);
  if (prior.roughness < 1e-6) fields.refuse("roughness_m", "is less than a thousandth of a millimetre");
}

pf_wall_prior_t wall_of(const Fields& fields, const Vec3& up) {
  fields.check_keys({"name", "from", "to", "base", "height", "seen_from", "sigma_rotation_deg", "sigma_vertical_deg",
                     "sigma_offset_m"},
                    {"roughness_m"});
  if (up[2] < 1.0 - 1e-9) fields.refuse("from", "needs up to be [0, 0, 1]; give the wall as a face with its corners");
  const std::vector<double> from = fields.numbers("from", 2), to = fields.numbers("to", 2);
  const double base = fields.number("base"), height = fields.positive("height", kLargestSize);
  const std::string side = fields.word("seen_from", {"left", "right", "both"});
  const Vec3 along = {to[0] - from[0], to[1] - from[1], 0.0};
  const double length = std::sqrt(dot(along, along));
  if (!(length >= kSmallestSize)) fields.refuse("to", "is where 'from' is; the wall has no length");
  if (length > kLargestSize) fields.refuse("to", "makes the wall longer than 10 km; the unit is the metre");
  if (height < kSmallestSize) fields.refuse("height", "is less than a millimetre");
  pf_wall_prior_t prior{};
  const Vec3 left = unit(cross(up, along));
  const Vec3 centre = {0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]), base + 0.5 * height};
  set_frame(side == "right" ? scaled(left, -1.0) : left, up, centre, prior);
  prior.two_sided = side == "both" ? 1u : 0u;
  prior.outline_count = 4;
  const double corners[4][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  for (size_t i = 0; i < 4; ++i) {
    prior.outline_P[i][0] = length * corners[i][0];
    prior.outline_P[i][1] = height * corners[i][1];
  }
  set_sigmas(fields, prior);
  return prior;
}

/// Each corner to the left of every edge, and the angles at the corners once around.
bool is_convex(const double (*uv)[2], size_t count) {
  double around = 0.0;
  for (size_t i = 0; i < count; ++i) {
    const double *a = uv[i], *b = uv[(i + 1) % count], *c = uv[(i + 2) % count];
    const double e[2] = {b[0] - a[0], b[1] - a[1]}, f[2] = {c[0] - b[0], c[1] - b[1]};
    const double turn = std::atan2(e[0] * f[1] - e[1] * f[0], e[0] * f[0] + e[1] * f[1]);
    if (!(turn > 1e-6)) return false;
    around += turn;
  }
  return around < 1.5 * 360.0 * kDegree;
}

pf_wall_prior_t face_of(const Fields& fields, const Vec3& up) {
  fields.check_keys({"name", "corners", "sigma_rotation_deg", "sigma_vertical_deg", "sigma_offset_m"},
                    {"seen_from", "roughness_m"});
  const Json& list = fields.at("corners");
  if (!list.is_array() || list.size() < 3 || list.size() > PF_OUTLINE_MAX)
    fields.refuse("corners", "must be 3 to " + std::to_string(PF_OUTLINE_MAX) + " points [x, y, z]");
  std::vector<Vec3> corner;
  for (const Json& point : list) {
    const std::vector<double> p = fields.numbers_of(point, "corners", 3);
    corner.push_back({p[0], p[1], p[2]});
  }
  pf_wall_prior_t prior{};
  prior.two_sided = fields.has("seen_from") && fields.word("seen_from", {"front", "both"}) == "both" ? 1u : 0u;
  set_sigmas(fields, prior);
  // Twice the area along the normal, and the centre of the area, by triangles about the first corner.
  Vec3 area = {0, 0, 0};
  for (size_t i = 2; i < corner.size(); ++i) {
    const Vec3 part = cross(corner[i - 1] - corner[0], corner[i] - corner[0]);
    for (size_t k = 0; k < 3; ++k) area[k] += part[k];
  }
  const double twice = std::sqrt(dot(area, area));
  if (!(twice >= kSmallestSize * kSmallestSize)) fields.refuse("corners", "span no area");
  const Vec3 normal = unit(area);
  Vec3 centre = {0, 0, 0};
  for (size_t i = 2; i < corner.size(); ++i) {
    const Vec3 part = cross(corner[i - 1] - corner[0], corner[i] - corner[0]);
    const double weight = dot(part, normal) / (3.0 * twice);
    for (size_t k = 0; k < 3; ++k) centre[k] += weight * (corner[0][k] + corner[i - 1][k] + corner[i][k]);
  }
  set_frame(normal, up, centre, prior);
  prior.outline_count = static_cast<int32_t>(corner.size());
  for (size_t i = 0; i < corner.size(); ++i) {
    const Vec3 d = corner[i] - centre;
    for (size_t k = 0; k < 2; ++k)
      prior.outline_P[i][k] = prior.R_WP[k] * d[0] + prior.R_WP[3 + k] * d[1] + prior.R_WP[6 + k] * d[2];
    if (std::fabs(dot(d, normal)) > std::max(1e-3, std::sqrt(prior.covariance[8])))
      fields.refuse("corners",
                    "are not in one plane: corner " + std::to_string(i + 1) + " is off it by more than sigma_offset_m");
    if (dot(d, d) > kLargestSize * kLargestSize)
      fields.refuse("corners", "are more than 10 km apart; the unit is the metre");
  }
  if (!is_convex(prior.outline_P, corner.size()))
    fields.refuse("corners", "do not go around a convex polygon; cut it into convex parts");
  return prior;
}

/// "wall 'north'", for messages; the number of one without a name.
std::string name_in_messages(const char* kind, const Json& json, size_t index) {
  const bool named = json.is_object() && json.contains("name") && json["name"].is_string();
  return std::string(kind) + (named ? " '" + json["name"].get<std::string>().substr(0, PF_WALLS_NAME) + "'"
                                    : " " + std::to_string(index + 1));
}

void set_name(const Fields& fields, pf_walls_t& walls) {
  if (!fields.has("name")) fields.refuse("name", "is missing");
  const Json& json = fields.at("name");
  const std::string name = json.is_string() ? json.get<std::string>() : "";
  if (name.empty() || name.size() >= PF_WALLS_NAME)
    fields.refuse("name", "must be 1 to " + std::to_string(PF_WALLS_NAME - 1) + " bytes of text");
  for (const char c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) fields.refuse("name", "has a control character");
  for (int32_t i = 0; i < walls.count; ++i)
    if (name == walls.wall[i].name) fields.refuse("name", "is that of another wall");
  std::memcpy(walls.wall[walls.count].name, name.c_str(), name.size() + 1);
}

void parse(const std::string& text, const std::string& file, pf_walls_t& walls) {
  const Json json = parse_json(text, file);
  const Fields top(json, file, "");
  if (!top.has("planefold_walls") || top.at("planefold_walls") != 1)
    top.refuse("planefold_walls", "must be 1: that is the version of this form");
  top.check_keys({"planefold_walls"}, {"up", "walls", "faces", "comment"});
  Vec3 up = {0, 0, 1};
  if (top.has("up")) {
    const std::vector<double> given = top.numbers("up", 3);
    up = {given[0], given[1], given[2]};
    if (!(dot(up, up) > 1e-12)) top.refuse("up", "must be a direction, not zeros");
    up = unit(up);
    walls.has_up = 1;
  }
  for (size_t k = 0; k < 3; ++k) walls.up_W[k] = up[k];
  for (const char* key : {"walls", "faces"}) {
    if (!top.has(key)) continue;
    const Json& list = top.at(key);
    const bool faces = std::strcmp(key, "faces") == 0;
    if (!list.is_array()) top.refuse(key, "must be a list");
    if (list.size() + static_cast<size_t>(walls.count) > PF_WALLS_MAX)
      top.refuse(key, "has " + std::to_string(list.size()) + " entries; walls and faces together may be " +
                          std::to_string(PF_WALLS_MAX));
    for (size_t i = 0; i < list.size(); ++i) {
      const Fields fields(list[i], file, name_in_messages(faces ? "face" : "wall", list[i], i));
      set_name(fields, walls);
      walls.wall[walls.count].prior = faces ? face_of(fields, up) : wall_of(fields, up);
      ++walls.count;
    }
  }
  if (walls.count == 0) top.refuse("walls", "is empty, and so is 'faces'");
}

/// One line, whatever the file calls its walls.
int say(const std::string& what, char message[PF_WALLS_MESSAGE]) {
  size_t n = 0;
  for (const char c : what)
    if (n + 1 < PF_WALLS_MESSAGE) message[n++] = static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  message[n] = '\0';
  return -1;
}

std::string read_text(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (file == nullptr) throw ReadError(path + ": cannot be opened: " + std::strerror(errno));
  std::string text(kMaxBytes + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  if (std::ferror(file.get()) != 0) throw ReadError(path + ": cannot be read: " + std::strerror(errno));
  if (text.size() > kMaxBytes) throw ReadError(path + ": is larger than 4 MiB; a file of walls is not");
  return text;
}

}  // namespace

}  // namespace pf::walls

int pf_parse_walls(const char* text, size_t size, const char* name, pf_walls_t* walls, char message[PF_WALLS_MESSAGE]) {
  *walls = pf_walls_t{};
  message[0] = '\0';
  try {
    const auto read = std::make_unique<pf_walls_t>();
    pf::walls::parse(std::string(text, size), name, *read);
    *walls = *read;
    return 0;
  } catch (const std::exception& error) {
    return pf::walls::say(error.what(), message);
  }
}

int pf_read_walls(const char* path, pf_walls_t* walls, char message[PF_WALLS_MESSAGE]) {
  std::string text;
  try {
    text = pf::walls::read_text(path);
  } catch (const std::exception& error) {
    return pf::walls::say(error.what(), message);
  }
  return pf_parse_walls(text.data(), text.size(), path, walls, message);
}
