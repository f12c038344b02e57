// Templates with masks: a whole search (warp, correlation at up to 9 x 9 pixels, sub-pixel alignment, judgement) beside OpenCV's
// matchTemplate, which correlates at the same 81 pixels and does none of the rest.
#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "base/arena.h"
#include "suite.h"
#include "thread_time.h"
#include "track/template_matcher.h"

namespace bench {
namespace {

constexpr int kWidth = 640, kHeight = 480, kSide = 15, kCount = 200, kReach = 4;
constexpr double kFocal = 500;
constexpr double kMoveX = 3.3, kMoveY = -1.6;  // of the image [px]
constexpr double kOffX = 0.9, kOffY = -0.7;    // of the prediction [px]
constexpr double kVariance = 2.0;              // of the prediction [px^2]: its ellipse is 4.2 px wide
constexpr double kNoise = 2;                   // [grey levels]
constexpr int kOffPlane = 6;                   // columns of a template that are not on its plane
constexpr std::uint8_t kOn = pf::kMaskMost, kOff = pf::kMaskLeast;  // in a mask
constexpr double kCell = 3.5;                                       // of the texture [px]

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One of the grey levels of a lattice, always the same for a place.
double lattice(int x, int y) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 374761393u + static_cast<std::uint32_t>(y) * 668265263u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return 80 + 90 * static_cast<double>((h ^ (h >> 16)) & 0xffff) / 65535;
}

/// Noise of a camera: the sum of four draws, of unit variance each but for the scale.
double noise_at(int x, int y, int image) {
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += (lattice(7919 * image + 4 * x + k, y + 50000 * image) - 125) / 26;
  return kNoise / 2 * sum;
}

/// Texture that does not repeat, bilinear between lattice points.
double grey_at(double x, double y) {
  const double u = x / kCell + 100, v = y / kCell + 100;
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const double fx = u - i, fy = v - j;
  return (1 - fy) * ((1 - fx) * lattice(i, j) + fx * lattice(i + 1, j)) +
         fy * ((1 - fx) * lattice(i, j + 1) + fx * lattice(i + 1, j + 1));
}

/// noise: of this image alone.
std::vector<std::uint8_t> draw(double move_x, double move_y, int noise) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(kWidth) * kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      pixels[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(std::lround(grey_at(x - move_x, y - move_y) + noise_at(x, y, noise)));
  return pixels;
}

using PeerCall = double (*)(const std::uint8_t*, int, int, const std::uint8_t*, const float*, const int*, int, int, int,
                            int*);

struct Peer {
  PeerCall call = nullptr;
  std::string name = "built without OpenCV (Debian: libopencv-video-dev)";

  Peer() {
#ifdef PF_BENCH_TEMPLATE_MODULE
    void* module = dlopen(PF_BENCH_TEMPLATE_MODULE, RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) {
      name = std::string("the module with OpenCV cannot be loaded: ") + dlerror();
      return;
    }
    call = reinterpret_cast<PeerCall>(dlsym(module, "pf_bench_match_us"));
    const auto its_name = reinterpret_cast<const char* (*)()>(dlsym(module, "pf_bench_match_name"));
    if (its_name != nullptr) name = its_name();
#endif
  }
};

struct Free {
  void operator()(void* block) const { std::free(block); }
};

struct One {
  pf::Vec2 pixel;
  pf::Appearance appearance;
  pf::PlanarTemplate shape;
  std::uint8_t mask[kSide * kSide];
};

class TemplateSuite {
 public:
  explicit TemplateSuite(const SuiteOptions& options) : options_(options), report_(options) {}

  int run() {
    report_.note("scalar", scalar_name());
    report_.note("peer", peer_.name);
    report_.note("clock", "processor time of the one thread");
    if (!prepare()) {
      std::fputs("pf-bench: no memory\n", stderr);
      return 1;
    }
    std::vector<double> own, masked, plain;
    for (int r = 0; r <= options_.repetitions; ++r) {
      const double us[] = {search_all(), match_all(true), match_all(false)};
      if (r == 0) continue;  // finds the caches cold
      own.push_back(us[0]);
      masked.push_back(us[1]);
      plain.push_back(us[2]);
    }
    char line[160];
    std::snprintf(line, sizeof line, "%d of %d within 0.3 px of the truth, with %d of %d columns off the plane", found_,
                  kCount, kOffPlane, kSide);
    report_.note("found", line);
    tell("search", median(own), masked, "matchTemplate, masked");
    tell("search, plain peer", median(own), plain, "matchTemplate, no mask");
    return report_.finish();
  }

 private:
  void tell(const std::string& name, double us, const std::vector<double>& peer, const std::string& beside) {
    const double peer_us = peer_.call != nullptr ? median(peer) : -1;
    Row row{
        "template", name, scalar_name(), kCount, kSide, us, peer_us > 0 ? beside : "", peer_us > 0 ? us / peer_us : 0};
    report_.add(row);
    if (peer_us > 0) report_.add({"template", beside, scalar_name(), kCount, kSide, peer_us, "", 0});
  }

  bool prepare() {
    constexpr std::size_t kBytes = std::size_t{8} << 20;
    block_.reset(std::aligned_alloc(pf::Arena::kAlignment, kBytes));
    if (!block_) return false;
    pf::Arena arena(block_.get(), kBytes);
    const double intrinsics[4] = {kFocal, kFocal, 0.5 * (kWidth - 1), 0.5 * (kHeight - 1)};
    const double distortion[8] = {};
    pf::make_camera(static_cast<int>(pf::CameraModel::kPinhole), kWidth, kHeight, intrinsics, distortion, &camera_);
    if (!tracker_.layout(arena, kWidth, kHeight) || !matcher_.layout(arena, kSide)) return false;
    tracker_.init(camera_);
    matcher_.init(camera_, pf::MaskMode::kPartial, 1);
    first_ = draw(0, 0, 1);
    second_ = draw(kMoveX, kMoveY, 2);
    tracker_.begin_frame({first_.data(), kWidth, kHeight, kWidth});
    matcher_.begin_frame();
    all_.resize(kCount);
    for (int k = 0; k < kCount; ++k) {
      One& one = all_[static_cast<std::size_t>(k)];
      one.pixel = pf::Vec2(static_cast<pf::Scalar>(40 + 28 * (k % 20)), static_cast<pf::Scalar>(40 + 42 * (k / 20)));
      if (!tracker_.remember(one.pixel, &one.appearance)) return false;
      matcher_.begin(tracker_.image(), one.appearance.patch, one.pixel, &one.shape, one.mask);
      for (int at = 0; at < kSide * kSide; ++at) {
        one.mask[at] = at % kSide < kSide - kOffPlane ? kOn : kOff;
        const int x = static_cast<int>(one.pixel.x()) - kSide / 2 + at % kSide;
        const int y = static_cast<int>(one.pixel.y()) - kSide / 2 + at / kSide;
        templates_.push_back(first_[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)]);
        masks_.push_back(static_cast<float>(pf::mask_probability(one.mask[at])) / 255.0f);
      }
      one.shape.area = pf::mask_area(one.mask, kSide * kSide);
      const pf::Vec2 predicted = predicted_of(one);
      centres_.push_back(static_cast<int>(std::lround(predicted.x())));
      centres_.push_back(static_cast<int>(std::lround(predicted.y())));
    }
    places_.resize(2 * kCount);
    tracker_.begin_frame({second_.data(), kWidth, kHeight, kWidth});
    return true;
  }

  static pf::Vec2 predicted_of(const One& one) {
    return one.pixel + pf::Vec2(static_cast<pf::Scalar>(kMoveX + kOffX), static_cast<pf::Scalar>(kMoveY + kOffY));
  }

  double search_all() {
    found_ = 0;
    const pf::Vec2 moved(static_cast<pf::Scalar>(kMoveX), static_cast<pf::Scalar>(kMoveY));
    double us = 0;
    for (const One& one : all_) {
      pf::SearchTask task;
      task.appearance = &one.appearance;
      task.shape = &one.shape;
      task.mask = one.mask;
      task.p_W = pf::Vec3((one.pixel.x() - camera_.cx) / camera_.fx, (one.pixel.y() - camera_.cy) / camera_.fy, 1);
      task.normal_W = pf::Vec3(0, 0, 1);
      task.c_W = pf::Vec3(-moved.x() / camera_.fx, -moved.y() / camera_.fy, 0);
      task.innovation = pf::Mat2::Identity() * static_cast<pf::Scalar>(kVariance);
      task.predicted = predicted_of(one);
      const double begin = thread_us();
      const pf::SearchOutcome outcome = matcher_.search(tracker_, task);
      us += thread_us() - begin;
      found_ += outcome.found && (outcome.pixel - one.pixel - moved).norm() < pf::Scalar(0.3);
    }
    return us;
  }

  double match_all(bool masked) {
    if (peer_.call == nullptr) return -1;
    return peer_.call(second_.data(), kWidth, kHeight, templates_.data(), masked ? masks_.data() : nullptr,
                      centres_.data(), kCount, kSide, kReach, places_.data());
  }

  SuiteOptions options_;
  Report report_;
  Peer peer_;
  std::unique_ptr<void, Free> block_;
  pf::Camera camera_;
  pf::Tracker tracker_;
  pf::TemplateMatcher matcher_;
  std::vector<std::uint8_t> first_, second_, templates_;
  std::vector<float> masks_;
  std::vector<int> centres_, places_;
  std::vector<One> all_;
  int found_ = 0;
};

int run_template(const SuiteOptions& options) { return TemplateSuite(options).run(); }

const Suite template_suite("template", "searches for templates with masks, beside OpenCV's matchTemplate",
                           run_template);

}  // namespace
}  // namespace bench
