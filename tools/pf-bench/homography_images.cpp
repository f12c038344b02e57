#include "homography_images.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include "frame_source.h"
#include "vision/plane_patch.h"

namespace bench {
namespace {

constexpr int kMinSide = 32;               // of a patch [px]
constexpr double kIdentity = 1e-6;         // by how much the first frame's homography may differ from it
constexpr double kMinDeterminant = 1e-12;  // of H with its largest entry 1

/// A rectangle X,Y,W,H, whole numbers.
bool parse_rectangle(const std::string& text, int (&numbers)[4]) {
  std::istringstream in(text);
  for (int i = 0; i < 4; ++i) {
    char comma = ',';
    if ((i > 0 && (!(in >> comma) || comma != ',')) || !(in >> numbers[i])) return false;
  }
  return in.eof() || in.peek() == std::istringstream::traits_type::eof();
}

double determinant(const Homography& H) {
  return H[0] * (H[4] * H[8] - H[5] * H[7]) - H[1] * (H[3] * H[8] - H[5] * H[6]) + H[2] * (H[3] * H[7] - H[4] * H[6]);
}

/// "" or what is wrong with a line.
std::string parse_homography(const std::string& line, Homography& H) {
  std::istringstream in(line);
  double largest = 0;
  for (double& h : H) {
    if (!(in >> h) || !std::isfinite(h)) return "is not nine numbers";
    largest = std::max(largest, std::fabs(h));
  }
  std::string rest;
  if (in >> rest) return "is not nine numbers";
  if (!(largest > 0)) return "is no homography: all numbers are 0";
  Homography scaled = H;
  for (double& h : scaled) h /= largest;
  return std::fabs(determinant(scaled)) > kMinDeterminant ? "" : "is no homography: its determinant is 0";
}

bool is_identity(const Homography& H) {
  for (int i = 0; i < 9; ++i)
    if (!(std::fabs(H[static_cast<std::size_t>(i)] / H[8] - (i % 4 == 0 ? 1 : 0)) < kIdentity)) return false;
  return true;
}

bool read_truth(const std::string& file, std::vector<Homography>& truth, std::string& message) {
  std::ifstream in(file);
  if (!in) return message = "--truth " + file + ": cannot be read", false;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    Homography H{};
    const std::string wrong = parse_homography(line, H);
    if (!wrong.empty()) return message = file + ", line " + std::to_string(number) + " " + wrong, false;
    truth.push_back(H);
  }
  if (truth.empty() || !is_identity(truth[0]))
    return message = file + ": the first homography is not the identity, from the first frame to itself", false;
  return true;
}

}  // namespace

std::unique_ptr<StoredPatchFrames> StoredPatchFrames::read(const SuiteOptions& options, std::string& message) {
  auto out = std::make_unique<StoredPatchFrames>();
  int rectangle[4];
  if (options.sources.size() != 1 || options.patch.empty() || options.truth.empty()) {
    message = "--source, --patch and --truth belong together: one sequence, its patch, its homographies";
    return nullptr;
  }
  if (!parse_rectangle(options.patch, rectangle)) {
    message = "--patch " + options.patch + ": write X,Y,W,H in pixels, as in 270,190,100,100";
    return nullptr;
  }
  if (!read_truth(options.truth, out->truth_, message)) return nullptr;
  Frames frames;
  if (!load_frames(options.sources[0], "auto", options.calibration, options.frames, frames, message)) return nullptr;
  const auto [x, y, w, h] = rectangle;
  const int width = frames.camera.width, height = frames.camera.height;
  const int side = std::min({w, h, pf::PlanePatch::kMaxSide});
  if (side < kMinSide || x < 0 || y < 0 || x > width - w || y > height - h) {
    message = "--patch " + options.patch + ": it must lie in the image of " + std::to_string(width) + " x " +
              std::to_string(height) + ", and be at least " + std::to_string(kMinSide) + " px wide and high";
    return nullptr;
  }
  if (out->truth_.size() < frames.pixels.size()) {
    message = options.truth + " has " + std::to_string(out->truth_.size()) + " homographies for " +
              std::to_string(frames.pixels.size()) + " frames";
    return nullptr;
  }
  out->left_ = x + (w - side) / 2;
  out->top_ = y + (h - side) / 2;
  out->name_ = frames.name;
  out->options_.width = width;
  out->options_.height = height;
  out->options_.focal = width;  // of no matter: a homography of pixels is one for every pinhole
  out->options_.side = side;
  out->options_.frames = static_cast<int>(frames.pixels.size());
  out->pixels_ = std::move(frames.pixels);
  return out;
}

}  // namespace bench
