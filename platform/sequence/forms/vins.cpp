/// Camera files of VINS-Fusion and VINS-Mono, which are those of camodocal.
#include "form.h"
#include "lens.h"

namespace pf::sequence {

namespace {

/// VINS-Mono keeps its other settings in the same file.
const std::vector<std::string> kSettings{"camera_name",
                                         "imu*",
                                         "num_of_cam",
                                         "image_topic",
                                         "image0_topic",
                                         "image1_topic",
                                         "output_path",
                                         "cam0_calib",
                                         "cam1_calib",
                                         "body_T_cam*",
                                         "estimate_*",
                                         "extrinsic*",
                                         "ex_calib_result_path",
                                         "max_*",
                                         "min_dist",
                                         "freq",
                                         "F_threshold",
                                         "show_track",
                                         "flow_back",
                                         "equalize",
                                         "multiple_thread",
                                         "keyframe_parallax",
                                         "acc_n",
                                         "acc_w",
                                         "gyr_n",
                                         "gyr_w",
                                         "g_norm",
                                         "loop_closure",
                                         "load_previous_pose_graph",
                                         "fast_relocalization",
                                         "pose_graph_save_path",
                                         "td",
                                         "save_image",
                                         "visualize_*",
                                         "image_skip",
                                         "skip_*",
                                         "support_file"};

constexpr const char* kLens = "distortion_parameters";
constexpr const char* kProjection = "projection_parameters";

bool is_vins(const Fields& fields) { return fields.has("model_type"); }

/// The numbers of a section, which must hold these and no others.
std::vector<double> read_section(const Fields& fields, const char* section, const std::vector<std::string>& names,
                                 std::vector<std::string>& notes) {
  const Fields inside = fields.below(section);
  inside.check_keys({names, {}}, notes);
  std::vector<double> values;
  for (const std::string& name : names) {
    values.push_back(inside.number(name));
  }
  return values;
}

struct Names {
  const char* model;
  std::vector<std::string> projection, distortion;
};

/// k1 to k4 of Kannala and Brandt are called k2 to k5 there, as those of the powers of theta that they belong to.
const std::vector<Names> kModels{{"PINHOLE", {"fx", "fy", "cx", "cy"}, {"k1", "k2", "p1", "p2"}},
                                 {"KANNALA_BRANDT", {"mu", "mv", "u0", "v0", "k2", "k3", "k4", "k5"}, {}},
                                 {"MEI", {"gamma1", "gamma2", "u0", "v0"}, {"k1", "k2", "p1", "p2"}}};

void read_vins(const Fields& fields, const Asked&, Calibration& calibration) {
  const std::string model = fields.text("model_type");
  const Names* names = nullptr;
  for (const Names& known : kModels) {
    names = model == known.model ? &known : names;
  }
  if (names == nullptr) {
    fields.refuse_field("model_type", "is '" + model + "'; known are PINHOLE, KANNALA_BRANDT and MEI with xi: 0");
  }
  Fields::Known known = known_fields({"model_type", "image_width", "image_height", kProjection}, kSettings);
  if (!names->distortion.empty()) {
    known.read.emplace_back(kLens);
  }
  const bool is_mei = model == "MEI";
  if (is_mei) {
    known.read.emplace_back("mirror_parameters");
  }
  fields.check_keys(known, calibration.notes);
  if (is_mei && read_section(fields, "mirror_parameters", {"xi"}, calibration.notes)[0] != 0.0) {
    fields.below("mirror_parameters")
        .refuse_field("xi", "is " + fields.below("mirror_parameters").text("xi") +
                                "; of MEI only a mirror with 0, which is a pinhole, is known. Calibrate with PINHOLE "
                                "or KANNALA_BRANDT");
  }
  pf_camera_t& camera = calibration.camera;
  camera.width = fields.integer("image_width");
  camera.height = fields.integer("image_height");
  const std::vector<double> p = read_section(fields, kProjection, names->projection, calibration.notes);
  set_pinhole({p[0], p[1], p[2], p[3]}, camera);
  const bool is_fisheye = names->distortion.empty();
  const std::vector<double> k = is_fisheye ? std::vector<double>(p.begin() + 4, p.end())
                                           : read_section(fields, kLens, names->distortion, calibration.notes);
  const char* section = is_fisheye ? kProjection : kLens;
  set_distortion(fields, "model_type", section, is_fisheye ? "equidistant" : "radtan", k, camera);
  const auto name = [&](size_t i) { return std::string(kProjection) + "." + names->projection[i]; };
  check_lens(fields, {"image_width", "image_height", name(0), name(1), name(2), name(3), section}, camera);
}

}  // namespace

const Form kVinsForm{"vins", "VINS-Fusion (model_type:)", is_vins, read_vins};

}  // namespace pf::sequence
