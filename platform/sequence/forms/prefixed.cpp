#include "prefixed.h"

#include "lens.h"

namespace pf::sequence {

std::vector<std::string> coefficient_names(bool is_fisheye) {
  return is_fisheye ? std::vector<std::string>{"k1", "k2", "k3", "k4"}
                    : std::vector<std::string>{"k1", "k2", "p1", "p2", "k3"};
}

Fields::Known known_prefixed(const PrefixedNames& names, const std::vector<std::string>& coefficients,
                             const std::vector<std::string>& unused) {
  Fields::Known known = known_fields({names.width, names.height, names.rate, names.model}, unused);
  for (const char* name : {"fx", "fy", "cx", "cy"}) {
    known.read.push_back(names.prefix + name);
  }
  for (const std::string& name : coefficients) {
    known.read.push_back(names.prefix + name);
  }
  return known;
}

void read_prefixed(const Fields& fields, const PrefixedNames& names, bool is_fisheye,
                   const std::vector<std::string>& coefficients, const Asked& asked, Calibration& calibration) {
  const std::string& prefix = names.prefix;
  std::vector<double> values;
  for (const std::string& name : coefficients) {
    values.push_back(is_fisheye ? fields.number(prefix + name) : fields.number_or(prefix + name, 0.0));
  }
  calibration.rate_hz = read_rate(fields, names.rate.c_str());
  pf_camera_t& camera = calibration.camera;
  const bool has_size = fields.has(names.width) || fields.has(names.height);
  camera.width = has_size ? fields.integer(names.width) : asked.images.width;
  camera.height = has_size ? fields.integer(names.height) : asked.images.height;
  const std::string fx = prefix + "fx", fy = prefix + "fy", cx = prefix + "cx", cy = prefix + "cy", k1 = prefix + "k1";
  set_pinhole({fields.number(fx), fields.number(fy), fields.number(cx), fields.number(cy)}, camera);
  set_distortion(fields, names.model, k1, is_fisheye ? "equidistant" : "radtan", values, camera);
  if (camera.width > 0 || has_size) {
    check_lens(fields, {names.width, names.height, fx, fy, cx, cy, k1}, camera);
  }
}

}  // namespace pf::sequence
