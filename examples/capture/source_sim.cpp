#include <algorithm>
#include <cmath>

#include "imu.h"
#include "source.h"

#ifdef PLANEFOLD_HAVE_SIM
#include <planefold_platform/sequence.h>
#include <planefold_platform/sim.h>
#endif

namespace pf::capture {

#ifdef PLANEFOLD_HAVE_SIM

namespace {

constexpr int32_t kBlurSamples = 4;  ///< of a camera that swings: 200 degrees a second and 6 ms are 4 px

class SimSource : public Source {
 public:
  SimSource(pf_sim_t* sim, const pf_sim_options_t& options, const std::string& scene, const std::string& notes)
      : sim_(sim, pf_sim_close), scene_(scene), seed_(options.seed) {
    pf_sim_camera(sim, &info_.camera);
    info_.count = options.frames;
    info_.rate_hz = options.rate_hz;
    info_.knows_truth = true;
    info_.warning = notes;
  }

  const SourceInfo& info() const override { return info_; }

  Read read(int64_t index, pf_image_t& image, std::string&) override {
    for (; next_ <= index; ++next_) {
      if (pf_sim_next(sim_.get(), &image, &truth_) == 0) {
        return Read::kEnd;
      }
    }
    return Read::kDone;
  }

  std::string name(int64_t) const override { return "sim:" + scene_; }

  bool truth(pf_pose_t& pose) override {
    pose = truth_;
    return true;
  }

  bool depth(std::vector<float>& z, std::vector<int32_t>& surface) const override {
    const size_t pixels = static_cast<size_t>(info_.camera.width) * static_cast<size_t>(info_.camera.height);
    z.resize(pixels);
    surface.resize(pixels);
    return pf_sim_depth(sim_.get(), &truth_, z.data(), surface.data()) == PF_OK;
  }

  bool target(pf_target_t& target) const override {
    return pf_sim_target(sim_.get(), PF_TARGET_RECTANGLE, &target) == PF_OK;
  }

  std::unique_ptr<Imu> imu(int64_t offset_ns) const override { return open_imu_sim(sim_.get(), seed_, offset_ns); }

  std::vector<std::array<double, 4>> planes() const override {
    std::vector<std::array<double, 4>> all;
    std::array<double, 4> plane{};
    while (pf_sim_surface(sim_.get(), static_cast<int32_t>(all.size()), plane.data(), &plane[3]) == PF_OK) {
      all.push_back(plane);
    }
    return all;
  }

 private:
  std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim_;
  std::string scene_;
  uint64_t seed_;
  SourceInfo info_;
  pf_pose_t truth_{};
  int64_t next_ = 0;
};

std::string known_scenes() {
  std::string list;
  for (int32_t i = 0; pf_sim_scene_name(i) != nullptr; ++i) {
    list += (i == 0 ? "" : ", ") + std::string(pf_sim_scene_name(i));
  }
  return list;
}

}  // namespace

std::unique_ptr<Source> open_sim_source(const Options& options, std::string& error) {
  const std::string scene = options.source.substr(4);
  pf_sim_options_t sim_options{};
  if (pf_sim_options_default(scene.c_str(), &sim_options) != PF_OK) {
    error = "source '" + options.source + "': no such scene; there are " + known_scenes();
    return nullptr;
  }
  sim_options.seed = options.seed;
  sim_options.rest_s = options.sim_rest_s;
  if (!options.sim_swing.empty()) {
    sim_options.swing_from_s = options.sim_swing[0];
    sim_options.swing_to_s = options.sim_swing[1];
    sim_options.swing_rad_s = options.sim_swing[2] * M_PI / 180.0;
    sim_options.blur_samples = kBlurSamples;
  }
  if (options.frames > 0 && options.loop < 0) {
    sim_options.frames = static_cast<int32_t>(std::min<int64_t>(options.skip + options.frames, 1000000));
  }
  std::string notes;
  if (!options.calibration.empty()) {
    char message[PF_SEQUENCE_MESSAGE];
    double rate_hz = 0.0;
    if (pf_read_calibration_of(options.calibration.c_str(), options.camera.c_str(), &sim_options.camera, &rate_hz,
                               message) != 0) {
      error = message;
      return nullptr;
    }
    notes = message;
    sim_options.rate_hz = rate_hz > 0.0 ? rate_hz : sim_options.rate_hz;
    sim_options.readout_s = sim_options.camera.readout_s;
  }
  pf_sim_t* sim = pf_sim_open(scene.c_str(), &sim_options);
  if (sim == nullptr) {
    error = "source '" + options.source +
            "': the scene could not be made with this camera (--calib: its readout at most a frame's time) or "
            "this memory";
    return nullptr;
  }
  return std::make_unique<SimSource>(sim, sim_options, scene, notes);
}

#else

std::unique_ptr<Source> open_sim_source(const Options& options, std::string& error) {
  error = "source '" + options.source + "': this build has no simulator";
  return nullptr;
}

#endif

}  // namespace pf::capture
