#include "outputs.h"

#include <planefold_platform/sequence.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "markers.h"

namespace pf::calibrate {

namespace {

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.10g", value);
  return text;
}

std::string yaml(const Fit& fit) {
  const pf_camera_t& c = fit.camera;
  std::string coefficients;
  for (int i = 0; i < (c.model == PF_CAMERA_PINHOLE ? 0 : 4); ++i) {
    coefficients += (i > 0 ? ", " : "") + number(c.distortion[i]);
  }
  return "cam0:\n  camera_model: pinhole\n  intrinsics: [" + number(c.fx) + ", " + number(c.fy) + ", " + number(c.cx) +
         ", " + number(c.cy) + "]\n  distortion_model: " + model_name(c.model) + "\n  distortion_coeffs: [" +
         coefficients + "]\n  resolution: [" + std::to_string(c.width) + ", " + std::to_string(c.height) +
         "]\n  # root mean square distance between measured and projected corners, over " +
         std::to_string(fit.views.size()) + " views [px]\n  reprojection_error: " + number(fit.rms_px) + "\n";
}

nlohmann::json json(const Board& board, const Search& search, const Fit& fit) {
  const pf_camera_t& c = fit.camera;
  nlohmann::json views = nlohmann::json::array();
  std::vector<View> used;
  for (const FittedView& view : fit.views) {
    views.push_back({{"frame", view.view.frame},
                     {"corners", view.view.corners.size()},
                     {"rms_px", view.rms_px},
                     {"blur_px", view.view.blur_px}});
    used.push_back(view.view);
  }
  nlohmann::json target = {{"columns", board.columns}, {"rows", board.rows}, {"square_m", board.square_m}};
  if (board.target == Target::kCharuco) {
    target["dictionary"] = dictionary_name(board);
    target["marker_m"] = kMarkerShare * board.square_m;
  }
  return {{"target", target_name(board.target)},
          {"board", target},
          {"frames", search.frames},
          {"looked_at", search.looked_at},
          {"found", search.found.size()},
          {"views", views},
          {"rejected_frames", fit.rejected},
          {"model", model_name(c.model)},
          {"resolution", {c.width, c.height}},
          {"fx", c.fx},
          {"fy", c.fy},
          {"cx", c.cx},
          {"cy", c.cy},
          {"sigma_fx_fy_cx_cy_px", fit.sigma_px},
          {"distortion", {c.distortion[0], c.distortion[1], c.distortion[2], c.distortion[3]}},
          {"reprojection_error_px", fit.rms_px},
          {"sigma_corner_px", fit.sigma_corner_px},
          {"covered_share", covered_share(used, {c.width, c.height})}};
}

std::string csv(const Fit& fit) {
  std::string text = "frame,corner,x_px,y_px,residual_x_px,residual_y_px\n";
  for (const FittedView& fitted : fit.views) {
    for (size_t i = 0; i < fitted.residuals.size(); ++i) {
      char line[160];
      std::snprintf(line, sizeof(line), "%lld,%d,%.5f,%.5f,%.5f,%.5f\n", static_cast<long long>(fitted.view.frame),
                    fitted.view.numbers[i], fitted.view.corners[i].x, fitted.view.corners[i].y, fitted.residuals[i].x,
                    fitted.residuals[i].y);
      text += line;
    }
  }
  return text;
}

bool write_file(const std::string& path, const std::string& text, std::string& error) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) {
    error = path + ": cannot be written; check the folder and the space on its disk";
    return false;
  }
  return true;
}

}  // namespace

const char* model_name(int32_t model) {
  return model == PF_CAMERA_PINHOLE ? "none" : model == PF_CAMERA_RADTAN ? "radtan" : "equidistant";
}

bool check_outputs(const std::string& folder, const std::string& source, std::string& error) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  const std::string images = source.substr(source.find(':') + 1);
  const bool usable = pf_check_output_folder(folder.c_str(), "--out", message) == 0 &&
                      pf_check_output_input(folder.c_str(), "--out", images.c_str(), message) == 0;
  error = message;
  return usable;
}

bool write_outputs(const std::string& folder, const Board& board, const Search& search, const Fit& fit,
                   std::string& error) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  bool mine = pf_open_output_folder(folder.c_str(), "--out", message) == 0;
  for (const char* name : {"calib.yaml", "calibration.json", "corners.csv", "coverage.png"}) {
    mine = mine && pf_add_output_file(folder.c_str(), name, message) == 0;
  }
  if (!mine) {
    error = message;
    return false;
  }
  return write_file(folder + "/calib.yaml", yaml(fit), error) &&
         write_file(folder + "/calibration.json", json(board, search, fit).dump(2) + "\n", error) &&
         write_file(folder + "/corners.csv", csv(fit), error) && draw_coverage(folder + "/coverage.png", fit, error);
}

}  // namespace pf::calibrate
