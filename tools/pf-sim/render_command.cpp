// pf-sim render NAME --out DIR: a rendered sequence in the layout of recorded ones.

#include <png.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../../examples/capture/checked_options.h"
#include "commands.h"
#include "planefold_platform/sequence.h"
#include "planefold_platform/sim.h"

namespace pfsim {
namespace {

namespace fs = std::filesystem;

bool write_png(const std::string& path, const pf_image_t& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_GRAY;
  return png_image_write_to_file(&png, path.c_str(), 0, image.pixels, image.stride, nullptr) != 0;
}

void write_target(const fs::path& path, const pf_target_t& target) {
  std::ofstream out(path);
  out << "# dark rectangle on a white ground; world: its centre, x right, y down, z into the wall; m\n"
      << "width: " << target.width << "\nheight: " << target.height << "\nsigma: " << target.sigma << "\n";
}

bool choose_camera(const std::string& model, pf_camera_t& camera) {
  if (model.empty()) return true;
  if (model == "pinhole") {
    camera.model = PF_CAMERA_PINHOLE;
  } else if (model == "radtan") {
    camera.model = PF_CAMERA_RADTAN;
    const double k[5] = {-0.20, 0.04, 0.0004, -0.0003, 0};
    std::copy(k, k + 5, camera.distortion);
  } else if (model == "equidistant") {
    camera.model = PF_CAMERA_EQUIDISTANT;
    const double k[4] = {-0.01, 0.004, -0.003, 0.0006};
    std::copy(k, k + 4, camera.distortion);
  } else if (model == "division") {
    camera.model = PF_CAMERA_DIVISION;
    camera.distortion[0] = 9e-6;
  } else {
    return false;
  }
  return true;
}

struct Choices {
  std::string scene, out, camera;
  std::uint64_t seed = 1;
  int frames = 0, width = 0, blur = 0;
  double noise = -1, readout = -1, exposure_step = 0, drop = 0, repeat = 0, exposure_s = -1;
};

std::string scene_names() {
  std::string names;
  for (int i = 0; pf_sim_scene_name(i); ++i) names += std::string(i > 0 ? " " : "") + pf_sim_scene_name(i);
  return names;
}

int fail(const std::string& what) {
  std::fprintf(stderr, "pf-sim: %s\n", what.c_str());
  return 1;
}

/// Of a command line that is wrong.
int refuse(const std::string& what) {
  fail(what);
  return 2;
}

int render(const Choices& c) {
  pf_sim_options_t o;
  if (pf_sim_options_default(c.scene.c_str(), &o) != PF_OK) return refuse(no_scene(c.scene));
  o.seed = c.seed;
  if (!choose_camera(c.camera, o.camera)) return refuse("no camera model '" + c.camera + "'");
  if (c.width > 0) {
    const double scale = static_cast<double>(c.width) / o.camera.width;
    o.camera.width = c.width;
    o.camera.height = static_cast<int>(o.camera.height * scale + 0.5);
    o.camera.fx *= scale;
    o.camera.fy *= scale;
    o.camera.cx = (o.camera.cx + 0.5) * scale - 0.5;
    o.camera.cy = (o.camera.cy + 0.5) * scale - 0.5;
    o.camera.distortion[0] /= o.camera.model == PF_CAMERA_DIVISION ? scale * scale : 1.0;
  }
  if (c.frames > 0) o.frames = c.frames;
  if (c.noise >= 0) o.noise_grey = c.noise;
  if (c.readout >= 0) o.readout_s = c.readout;
  if (c.exposure_s >= 0) o.exposure_s = c.exposure_s;
  if (c.blur > 0) o.blur_samples = c.blur;
  if (c.exposure_step >= 1) o.exposure_step = c.exposure_step;
  o.drop_probability = c.drop;
  o.repeat_probability = c.repeat;

  pf_sim_t* sim = pf_sim_open(c.scene.c_str(), &o);
  if (!sim)
    return refuse(
        "the picture is too small or too large for --width, or --exposure or --readout is longer than one frame's "
        "time");
  const fs::path out(c.out);
  char message[PF_SEQUENCE_MESSAGE] = "";
  if (pf_open_output_folder(c.out.c_str(), "--out", message) != 0) return fail(message);
  for (const char* name : {"images/", "times.txt", "groundtruth.tum", "calib.yaml", "target.yaml"})
    if (pf_add_output_file(c.out.c_str(), name, message) != 0) return fail(message);
  std::error_code error;
  fs::create_directories(out / "images", error);
  if (error) return fail(c.out + ": cannot be made (" + error.message() + "); choose another --out");
  pf_camera_t camera;
  pf_sim_camera(sim, &camera);  // with the readout
  if (pf_write_calibration((out / "calib.yaml").c_str(), PF_CALIBRATION_PLAIN, &camera, o.rate_hz, message) != 0) {
    return fail(message);
  }
  pf_target_t target;
  if (pf_sim_target(sim, PF_TARGET_RECTANGLE, &target) == PF_OK) write_target(out / "target.yaml", target);

  std::ofstream times(out / "times.txt"), truth_file(out / "groundtruth.tum");
  truth_file << "# T_world_cam: timestamp tx ty tz qx qy qz qw\n";
  pf_image_t image;
  pf_pose_t truth;
  int count = 0, result = 0;
  while (result == 0 && pf_sim_next(sim, &image, &truth)) {
    char name[32], line[256];
    std::snprintf(name, sizeof name, "%06d.png", count);
    if (pf_add_output_file(c.out.c_str(), (std::string("images/") + name).c_str(), message) != 0) {
      result = fail(message);
      break;
    }
    if (!write_png((out / "images" / name).string(), image)) result = fail("cannot write images to " + c.out);
    const double t = static_cast<double>(image.t_ns) * 1e-9;
    std::snprintf(line, sizeof line, "%d %.9f %s\n", count, t, name);
    times << line;
    std::snprintf(line, sizeof line, "%.9f %.9f %.9f %.9f %.10f %.10f %.10f %.10f\n", t, truth.p_WC[0], truth.p_WC[1],
                  truth.p_WC[2], truth.q_WC[1], truth.q_WC[2], truth.q_WC[3], truth.q_WC[0]);
    truth_file << line;
    if (++count % 50 == 0) std::fprintf(stderr, "\r%d frames", count);
  }
  std::fprintf(stderr, "\r%d frames of %s in %s\n", count, c.scene.c_str(), c.out.c_str());
  pf_sim_close(sim);
  return result;
}

}  // namespace

std::string no_scene(const std::string& scene) { return "no scene '" + scene + "'; there are " + scene_names(); }

void add_render(CLI::App& app, int& result) {
  auto c = std::make_shared<Choices>();
  CLI::App* command = app.add_subcommand("render", "Render a scene: images, times, calibration, target, truth");
  command->add_option("scene", c->scene, scene_names())->required();
  command->add_option("--out", c->out, "folder to write")->required();
  command->add_option("--seed", c->seed, "of scene, path and noise");
  command->add_option("--frames", c->frames, "how many (0: the scene's own)")
      ->check(pf::capture::whole_number_in(0, 1000000));
  command->add_option("--camera", c->camera, "pinhole, radtan, equidistant or division");
  command->add_option("--width", c->width, "of the picture [px]; everything else scales with it")
      ->check(pf::capture::whole_number_in(32, 4096));
  command->add_option("--noise", c->noise, "standard deviation of a pixel [grey levels]")
      ->check(pf::capture::number_in(0.0, 50.0));
  command->add_option("--exposure", c->exposure_s, "[s]")->check(pf::capture::number_in(0.0, 1.0));
  command->add_option("--blur", c->blur, "views averaged over the exposure")
      ->check(pf::capture::whole_number_in(1, 64));
  command->add_option("--readout", c->readout, "rolling shutter, first to last row [s]")
      ->check(pf::capture::number_in(0.0, 0.2));
  command->add_option("--exposure-step", c->exposure_step, "factor by which gain jumps every two seconds")
      ->check(pf::capture::number_in(1.0, 100.0));
  command->add_option("--drop", c->drop, "probability that a frame never comes")
      ->check(pf::capture::number_in(0.0, 0.9));
  command->add_option("--repeat", c->repeat, "probability that a picture comes twice")
      ->check(pf::capture::number_in(0.0, 0.9));
  command->callback([c, &result] { result = render(*c); });
}

}  // namespace pfsim
