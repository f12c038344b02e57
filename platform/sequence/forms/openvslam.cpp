/// Configurations of OpenVSLAM (Camera.model: ..) and stella_vslam (Camera: with fields of its own).
#include "form.h"
#include "prefixed.h"

namespace pf::sequence {

namespace {

const std::vector<std::string> kCamera{"name",           "setup", "color_order", "focal_x_baseline", "depth_threshold",
                                       "depthmap_factor"};
const std::vector<std::string> kSections{
    "Preprocessing", "Feature",        "Mapping",         "Tracking",          "LoopDetector",    "LoopBundleAdjuster",
    "System",        "Initializer",    "PangolinViewer",  "IridescenceViewer", "SocketPublisher", "MapPublisher",
    "Relocalizer",   "GraphOptimizer", "GlobalOptimizer", "KeyframeInserter",  "Initial",         "MarkerModel",
    "BowDatabase",   "MarkerDetector", "depthmap_factor"};

bool is_openvslam(const Fields& fields) {
  return fields.has_any({"Camera.model", "Camera.setup", "Camera.cols", "Camera.rows"}) || fields.is_map("Camera");
}

void refuse_rectifier(const Fields& fields) {
  for (const char* key : {"StereoRectifier", "StereoRectifier.model", "StereoRectifier.K_left"}) {
    if (fields.has(key)) {
      fields.refuse_field(key,
                          "says that the numbers of Camera are those of rectified images; remove it where the images "
                          "are rectified, or else write a calibration of the left camera alone");
    }
  }
}

void read_openvslam(const Fields& top, const Asked& asked, Calibration& calibration) {
  const bool nested = top.is_map("Camera");
  refuse_rectifier(top);
  const Fields fields = nested ? top.below("Camera") : top;
  const std::string prefix = nested ? "" : "Camera.";
  const PrefixedNames names{prefix, prefix + "cols", prefix + "rows", prefix + "fps", prefix + "model"};
  const std::string model = fields.text(names.model);
  if (model != "perspective" && model != "fisheye") {
    fields.refuse_field(names.model, "is '" + model + "'; known are perspective and fisheye");
  }
  const bool is_fisheye = model == "fisheye";
  const std::vector<std::string> coefficients = coefficient_names(is_fisheye);
  std::vector<std::string> unused;
  for (const std::string& name : kCamera) {
    unused.push_back(prefix + name);
  }
  for (const std::string& section : kSections) {
    for (const char* end : {"", ".*"}) {
      unused.push_back(section + end);
    }
  }
  fields.check_keys(known_prefixed(names, coefficients, unused), calibration.notes);
  if (nested) {
    calibration.section = "Camera";
    unused.emplace_back("Camera");
    top.check_keys(known_fields({"Camera"}, unused), calibration.notes);
  }
  calibration.size_hint = nested ? "add cols and rows to Camera" : "add Camera.cols and Camera.rows";
  read_prefixed(fields, names, is_fisheye, coefficients, asked, calibration);
}

}  // namespace

const Form kOpenvslamForm{"openvslam", "OpenVSLAM and stella_vslam (Camera.model:)", is_openvslam, read_openvslam};

}  // namespace pf::sequence
