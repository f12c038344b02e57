// The bundle adjuster beside Ceres on the same random windows: three free keyframes and older ones that stay fixed, points hosted where
// they were first seen. Same parameters, same loss, same stop; building the problem is not timed.
#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "adjust_peer.h"
#include "bundle/bundle_adjuster.h"
#include "geometry/so3.h"
#include "sim/random.h"
#include "suite.h"

namespace bench {
namespace {

using pf::Scalar;
using pf::sim::Random;

constexpr int kFree = 3;
constexpr double kFocal = 525, kWidth = 640, kHeight = 480;
constexpr double kStep = 0.12, kShake = 0.02, kTurn = 0.03;        // from keyframe to keyframe [m, m, rad]
constexpr double kNear = 1.5, kFar = 6;                            // of points [m]
constexpr double kNoisePx = 0.5, kOutliers = 0.03, kWrongPx = 10;  // one match in thirty is wrong
constexpr double kMissed = 0.15;                                   // share of sights that have no match
constexpr double kPoseError = 0.01, kDepthError = 0.2;  // of what the adjustment begins with [m and rad, relative]
constexpr double kHuber = 2, kRhoMean = 0.4, kRhoSigma = 2, kNoPixel = 100;
constexpr int kRounds = 50;
constexpr double kSmallGain = 1e-7, kTinyGain = 1e-13;
constexpr std::uint64_t kStream = 91;

/// A window in plain numbers, as it begins.
struct Window {
  std::vector<double> pose, ray, rho, pixel;
  std::vector<int> free, host, seen;
  int pixels = 0;  ///< that are measured

  Window(std::uint64_t seed, int fixed, int points) {
    Random random(seed, kStream);
    const int poses = fixed + kFree;
    std::vector<pf::Quat> q(static_cast<std::size_t>(poses));
    std::vector<pf::Vec3> p(q.size());
    const auto scalar = [](double v) { return static_cast<Scalar>(v); };
    const auto normals = [&](double sigma) {
      const pf::sim::Vec3 v = random.normal3() * sigma;
      return pf::Vec3(scalar(v.x), scalar(v.y), scalar(v.z));
    };
    for (std::size_t c = 0; c < q.size(); ++c) {
      q[c] = pf::exp_so3(normals(kTurn));
      p[c] = pf::Vec3(scalar(kStep * static_cast<double>(c)), 0, 0) + normals(kShake);
    }
    pixel.assign(q.size() * static_cast<std::size_t>(points) * 2, 0);
    seen.assign(q.size() * static_cast<std::size_t>(points), 0);
    for (int i = 0; i < points; ++i) {
      // Seen first in one of the keyframes, and from then on while it is in view.
      const auto first =
          static_cast<std::size_t>(std::min(poses - 2, static_cast<int>(random.uniform() * (poses - 1))));
      const double depth = random.uniform(kNear, kFar), x = random.uniform(-0.45, 0.45),
                   y = random.uniform(-0.35, 0.35);
      const pf::Vec3 in_host(scalar(x * depth), scalar(y * depth), scalar(depth));
      const pf::Vec3 p_W = p[first] + q[first] * in_host;
      host.push_back(static_cast<int>(first));
      for (int k = 0; k < 3; ++k) ray.push_back(static_cast<double>(in_host[k] / in_host.norm()));
      rho.push_back((1 + kDepthError * random.uniform(-1, 1)) / static_cast<double>(in_host.norm()));
      for (std::size_t c = first + 1; c < q.size(); ++c) {
        const pf::Vec3 d = q[c].conjugate() * (p_W - p[c]);
        const double u = kFocal * static_cast<double>(d.x() / d.z()), v = kFocal * static_cast<double>(d.y() / d.z());
        const bool wrong = random.uniform() < kOutliers, missed = random.uniform() < kMissed;
        const pf::sim::Vec3 noise = random.normal3() * (wrong ? kWrongPx : kNoisePx);
        if (missed || d.z() < 0.1f || std::abs(u) > kWidth / 2 || std::abs(v) > kHeight / 2) continue;
        const std::size_t at = c * static_cast<std::size_t>(points) + static_cast<std::size_t>(i);
        pixel[2 * at] = static_cast<float>(u + kWidth / 2 + noise.x);
        pixel[2 * at + 1] = static_cast<float>(v + kHeight / 2 + noise.y);
        seen[at] = 1;
        ++pixels;
      }
    }
    for (std::size_t c = 0; c < q.size(); ++c) {
      free.push_back(static_cast<int>(c) >= fixed ? 1 : 0);
      if (free[c] != 0) {
        q[c] = (pf::exp_so3(normals(kPoseError)) * q[c]).normalized();
        p[c] += normals(kPoseError);
      }
      for (const Scalar v : {q[c].w(), q[c].x(), q[c].y(), q[c].z(), p[c].x(), p[c].y(), p[c].z()})
        pose.push_back(static_cast<double>(v));
    }
  }

  pf_bench_bundle view() {
    return {kFocal,
            kFocal,
            kWidth / 2,
            kHeight / 2,
            static_cast<int>(free.size()),
            static_cast<int>(rho.size()),
            pose.data(),
            free.data(),
            ray.data(),
            host.data(),
            rho.data(),
            pixel.data(),
            seen.data(),
            kNoisePx,
            kHuber,
            kRhoMean,
            kRhoSigma,
            kNoPixel,
            kRounds,
            kSmallGain};
  }
};

/// The library's adjuster on a window; what it adjusts is its own copy.
class OwnAdjuster {
 public:
  explicit OwnAdjuster(const Window& window) : block_(std::aligned_alloc(pf::Arena::kAlignment, kBytes), std::free) {
    const double intrinsics[4] = {kFocal, kFocal, kWidth / 2, kHeight / 2}, distortion[8] = {};
    pf::make_camera(static_cast<int>(pf::CameraModel::kPinhole), 640, 480, intrinsics, distortion, &camera_);
    const std::size_t poses = window.free.size(), points = window.rho.size();
    pixel_.resize(poses * points);
    for (std::size_t at = 0; at < pixel_.size(); ++at)
      pixel_[at] = {static_cast<float>(window.pixel[2 * at]), static_cast<float>(window.pixel[2 * at + 1]),
                    window.seen[at] != 0};
    const auto scalar = [](double v) { return static_cast<Scalar>(v); };
    for (std::size_t c = 0; c < poses; ++c) {
      const double* x = window.pose.data() + 7 * c;
      first_.push_back({pf::Quat(scalar(x[0]), scalar(x[1]), scalar(x[2]), scalar(x[3])),
                        pf::Vec3(scalar(x[4]), scalar(x[5]), scalar(x[6])), window.free[c] != 0,
                        pixel_.data() + c * points});
    }
    for (std::size_t i = 0; i < points; ++i) {
      ray_.emplace_back(scalar(window.ray[3 * i]), scalar(window.ray[3 * i + 1]), scalar(window.ray[3 * i + 2]));
      first_rho_.push_back(scalar(window.rho[i]));
    }
    host_ = window.host;
    pf::Arena arena(block_.get(), kBytes);
    ready_ = adjuster_.layout(arena, static_cast<int>(poses), kFree, static_cast<int>(points));
    used_ = static_cast<double>(arena.used());
  }

  pf_bench_adjusted run() {
    pose_ = first_;
    rho_ = first_rho_;
    if (!ready_) return {};
    pf::AdjustOptions options = {};
    options.sigma_px = Scalar(kNoisePx);
    options.huber = Scalar(kHuber);
    options.rho_mean = Scalar(kRhoMean);
    options.rho_sigma = Scalar(kRhoSigma);
    options.no_pixel_penalty = Scalar(kNoPixel);
    options.max_rounds = kRounds;
    options.small_gain = Scalar(kSmallGain);
    const pf::Bundle bundle = {pose_.data(), static_cast<int>(pose_.size()), ray_.data(), host_.data(),
                               rho_.data(),  static_cast<int>(rho_.size())};
    const auto begin = std::chrono::steady_clock::now();
    const Scalar cost = adjuster_.adjust(camera_, options, bundle);
    const std::chrono::duration<double, std::micro> us = std::chrono::steady_clock::now() - begin;
    return {static_cast<double>(cost), us.count(), 0, adjuster_.rounds()};
  }

  double bytes() const { return used_; }

 private:
  static constexpr std::size_t kBytes = std::size_t{1} << 20;

  std::unique_ptr<void, void (*)(void*)> block_;
  bool ready_ = false;
  double used_ = 0;
  pf::Camera camera_;
  pf::BundleAdjuster adjuster_;
  std::vector<pf::BundlePixel> pixel_;
  std::vector<pf::BundlePose> first_, pose_;
  std::vector<pf::Vec3> ray_;
  std::vector<Scalar> first_rho_, rho_;
  std::vector<int> host_;
};

/// Ceres, where the module is there.
class Peer {
 public:
  Peer() {
#ifdef PF_BENCH_ADJUST_MODULE
    void* module = dlopen(PF_BENCH_ADJUST_MODULE, RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) {
      name_ = std::string("the module with Ceres cannot be loaded: ") + dlerror();
      return;
    }
    run_ = reinterpret_cast<Run>(dlsym(module, "pf_bench_adjust"));
    const auto name = reinterpret_cast<const char* (*)()>(dlsym(module, "pf_bench_adjust_name"));
    name_ = name != nullptr ? name() : "Ceres";
#else
    name_ = "built without Ceres (Debian: libceres-dev)";
#endif
  }

  bool is_there() const { return run_ != nullptr; }
  const std::string& name() const { return name_; }

  pf_bench_adjusted run(Window window, double small_gain) const {
    pf_bench_bundle bundle = window.view();
    bundle.small_gain = small_gain;
    pf_bench_adjusted out = {};
    if (!run_(&bundle, &out)) out.cost = -1;
    return out;
  }

 private:
  using Run = bool (*)(const pf_bench_bundle*, pf_bench_adjusted*);
  Run run_ = nullptr;
  std::string name_;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

int run_adjust(const SuiteOptions& options) {
  Report report(options);
  const Peer peer;
  report.note("scalar", scalar_name());
  report.note("peer", peer.name());
  for (const auto& [fixed, points] : {std::pair{8, 200}, {8, 300}, {16, 200}, {16, 300}}) {
    std::vector<double> us, peer_us, minimiser_us, rounds, peer_rounds, pixels;
    double worst = 0, peer_worst = 0, bytes = 0;
    for (int seed = 1; seed <= options.seeds; ++seed) {
      const Window window(static_cast<std::uint64_t>(seed), fixed, points);
      OwnAdjuster own(window);
      bytes = own.bytes();
      pixels.push_back(window.pixels);
      std::vector<double> own_times, peer_times, minimiser_times;
      pf_bench_adjusted found = {}, of_peer = {};
      constexpr int kRepetitions = 5;
      own.run();  // warm
      for (int repetition = 0; repetition < kRepetitions; ++repetition) {
        found = own.run();
        own_times.push_back(found.us);
        if (!peer.is_there()) continue;
        of_peer = peer.run(window, kSmallGain);
        peer_times.push_back(of_peer.us + of_peer.prepare_us);
        minimiser_times.push_back(of_peer.us);
      }
      us.push_back(median(own_times));
      rounds.push_back(found.rounds);
      if (!peer.is_there()) continue;
      peer_us.push_back(median(peer_times));
      minimiser_us.push_back(median(minimiser_times));
      peer_rounds.push_back(of_peer.rounds);
      const double minimum = peer.run(window, kTinyGain).cost;
      worst = std::max(worst, found.cost / minimum - 1);
      peer_worst = std::max(peer_worst, of_peer.cost / minimum - 1);
    }
    Row row{"adjust",
            std::to_string(kFree) + " free, " + std::to_string(fixed) + " fixed, " + std::to_string(points) + " points",
            scalar_name(),
            fixed + kFree,
            points,
            median(us),
            peer.is_there() ? peer.name() : "",
            peer.is_there() ? median(us) / median(peer_us) : 0};
    row.figures = {{"pixels", median(pixels)}, {"rounds", median(rounds)}, {"bytes", bytes}};
    if (peer.is_there())
      row.figures.insert(row.figures.end(), {{"peer_us", median(peer_us)},
                                             {"peer_minimiser_us", median(minimiser_us)},
                                             {"peer_rounds", median(peer_rounds)},
                                             {"worst_above_minimum_ppm", 1e6 * worst},
                                             {"peer_worst_above_minimum_ppm", 1e6 * peer_worst}});
    report.add(row);
  }
  return report.finish();
}

const Suite adjust_suite("adjust", "the bundle adjuster on random windows, beside Ceres", run_adjust, Suite::kSeeds);

}  // namespace
}  // namespace bench
