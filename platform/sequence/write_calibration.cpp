#include <planefold_platform/sequence.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace {

void write(std::FILE* file, uint32_t form, const pf_camera_t& camera, double rate_hz) {
  const bool euroc = form == PF_CALIBRATION_EUROC;
  const char* const names[] = {"none", "none", euroc ? "radial-tangential" : "radtan", "equidistant",
                               "harris_division"};
  constexpr int kCounts[] = {0, 0, 5, 4, 1};
  const int model = camera.model >= 1 && camera.model <= 4 ? camera.model : 0;
  if (euroc) {
    std::fprintf(file, "sensor_type: camera\nresolution: [%d, %d]\ncamera_model: pinhole\n", camera.width,
                 camera.height);
    std::fprintf(file, "intrinsics: [%.17g, %.17g, %.17g, %.17g]\n", camera.fx, camera.fy, camera.cx, camera.cy);
  } else {
    std::fprintf(file, "camera_model: pinhole\nwidth: %d\nheight: %d\n", camera.width, camera.height);
    std::fprintf(file, "fx: %.17g\nfy: %.17g\ncx: %.17g\ncy: %.17g\n", camera.fx, camera.fy, camera.cx, camera.cy);
  }
  std::fprintf(file, "distortion_model: %s\ndistortion%s: [", names[model], euroc ? "_coefficients" : "");
  for (int i = 0; i < kCounts[model]; ++i) {
    std::fprintf(file, "%s%.17g", i == 0 ? "" : ", ", camera.distortion[i]);
  }
  std::fprintf(file, "]\n");
  if (camera.readout_s > 0.0) {
    std::fprintf(file, "readout_s: %.17g\n", camera.readout_s);
  }
  if (camera.sigma_focal > 0.0) {
    std::fprintf(file, "sigma_focal: %.17g\nsigma_aspect: %.17g\nsigma_centre_px: %.17g\nsigma_distortion: [",
                 camera.sigma_focal, camera.sigma_aspect, camera.sigma_centre_px);
    const int sigmas = model == PF_CAMERA_PINHOLE ? 1 : kCounts[model];
    for (int i = 0; i < sigmas; ++i) {
      std::fprintf(file, "%s%.17g", i == 0 ? "" : ", ", camera.sigma_distortion[i]);
    }
    std::fprintf(file, "]\n");
  }
  if (camera.timestamps == PF_TIMESTAMPS_NOMINAL) {
    std::fprintf(file, "timestamps: nominal\n");
  }
  if (rate_hz > 0.0) {
    std::fprintf(file, "rate_hz: %.17g\n", rate_hz);
  }
}

void refuse(char message[PF_SEQUENCE_MESSAGE], const char* path, const char* why) {
  if (message != nullptr) {
    std::snprintf(message, PF_SEQUENCE_MESSAGE, "%s: cannot be written (%s)", path, why);
  }
}

}  // namespace

int pf_write_calibration(const char* path, uint32_t form, const pf_camera_t* camera, double rate_hz,
                         char message[PF_SEQUENCE_MESSAGE]) {
  if (path == nullptr || camera == nullptr) {
    refuse(message, "calibration", "path or camera is null");
    return -1;
  }
  std::FILE* file = std::fopen(path, "w");
  if (file != nullptr) {
    write(file, form, *camera, rate_hz);
    const bool wrong = std::ferror(file) != 0;
    if (std::fclose(file) == 0 && !wrong) {
      return 0;
    }
  }
  refuse(message, path, std::strerror(errno));
  return -1;
}
