// Alignment of a patch on a plane: the library's own aligner beside OpenCV's, on rendered frames with exact homographies. What is lost in a
// frame counts 10 px, and goes on from where it was last.
#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/arena.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/small_cholesky.h"
#include "homography_frames.h"
#include "homography_images.h"
#include "suite.h"
#include "thread_time.h"
#include "track/align_plane.h"

namespace bench {
namespace {

constexpr double kLostPx = 10;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What a tracker gave in one frame.
struct Tracked {
  bool found = false;
  double us = 0;
  double nees = -1;  ///< of the eight numbers, 8 expected; negative: it states no covariance
};

/// Follows one patch through one sequence.
class PatchTracker {
 public:
  virtual ~PatchTracker() = default;
  virtual std::string name() const = 0;
  /// The patch in its first frame, whose pixels stay valid.
  virtual void begin(const HomographyOptions& options, const PatchFrames& frames, const std::uint8_t* first) = 0;
  /// H: from where it was last to where it is. truth: of the corners, for the NEES.
  virtual Tracked follow(const std::uint8_t* image, const Homography& truth, Homography& H) = 0;
};

pf::Camera camera_of(const HomographyOptions& o) {
  const double intrinsics[4] = {o.focal, o.focal, 0.5 * (o.width - 1), 0.5 * (o.height - 1)};
  const double distortion[8] = {};
  pf::Camera camera;
  pf::make_camera(static_cast<int>(pf::CameraModel::kPinhole), o.width, o.height, intrinsics, distortion, &camera);
  return camera;
}

class OwnTracker : public PatchTracker {
 public:
  std::string name() const override { return "planefold"; }

  void begin(const HomographyOptions& options, const PatchFrames& frames, const std::uint8_t* first) override {
    camera_ = camera_of(options);
    if (!block_) {
      constexpr std::size_t kBytes = std::size_t{1} << 20;
      block_.reset(std::aligned_alloc(pf::Arena::kAlignment, kBytes));
      pf::Arena arena(block_.get(), kBytes);
      ready_ = aligner_.layout(arena) && pyramid_.layout(arena, options.width, options.height, pf::PlanePatch::kLevels);
    }
    const pf::ImageView image{first, options.width, options.height, options.width};
    ready_ = ready_ && pf::extract_plane_patch(image, frames.left(), frames.top(), options.side, &patch_);
    start_ = pf::PlaneStart();
    start_.slack_px = pf::tuning::patch_keeper::kWarpSlack;
    unfinished_ = false;
    K_ = pf::Mat3::Identity();
    K_(0, 0) = camera_.fx, K_(1, 1) = camera_.fy, K_(0, 2) = camera_.cx, K_(1, 2) = camera_.cy;
  }

  Tracked follow(const std::uint8_t* image, const Homography& truth, Homography& H) override {
    Tracked out;
    if (!ready_) return out;
    pf::Mat3 H_px;
    for (int i = 0; i < 9; ++i) H_px(i / 3, i % 3) = static_cast<pf::Scalar>(H[static_cast<std::size_t>(i)]);
    if (!unfinished_) start_.H_CK = K_.inverse() * H_px * K_;
    // Every frame has a pyramid already, for the points.
    pyramid_.build({image, camera_.width, camera_.height, camera_.width});
    const double begin = thread_us();
    const pf::PlaneAlignment found = aligner_.align(pyramid_, camera_, patch_, start_, pf::HomographyWarp());
    out.us = thread_us() - begin;
    out.found = found.is_aligned();
    unfinished_ = found.iterations == pf::PlaneAligner::kMaxIterations && !out.found;
    if (unfinished_) start_.H_CK = found.H_CK;
    if (!out.found) return out;
    start_.gain = found.gain;
    start_.offset = found.offset;
    const pf::Mat3 now = K_ * found.H_CK * K_.inverse();
    for (int i = 0; i < 9; ++i) H[static_cast<std::size_t>(i)] = static_cast<double>(now(i / 3, i % 3));
    Eigen::Matrix<double, 8, 1> e;
    for (int k = 0; k < 4; ++k) {
      const auto p =
          map_pixel(truth, static_cast<double>(patch_.corner(k).x()), static_cast<double>(patch_.corner(k).y()));
      e(2 * k) = static_cast<double>(found.corner[k].x()) - p[0];
      e(2 * k + 1) = static_cast<double>(found.corner[k].y()) - p[1];
    }
    pf::SmallCholesky<8> cholesky;
    const pf::PlaneAlignment::Mat8 P = found.covariance + found.reference_covariance;
    if (cholesky.factor(P))
      out.nees = static_cast<double>(e.cast<pf::Scalar>().dot(cholesky.solve<1>(e.cast<pf::Scalar>())));
    return out;
  }

 private:
  struct Free {
    void operator()(void* block) const { std::free(block); }
  };
  std::unique_ptr<void, Free> block_;
  bool ready_ = true, unfinished_ = false;
  pf::Camera camera_;
  pf::Mat3 K_;
  pf::PlaneAligner aligner_;
  pf::Pyramid pyramid_;
  pf::PlanePatch patch_;
  pf::PlaneStart start_;
};

using PeerCall = double (*)(int, const std::uint8_t*, int, int, int, const std::uint8_t*, int, int, int, double*);

class OpenCvTracker : public PatchTracker {
 public:
  OpenCvTracker(PeerCall call, int method) : call_(call), method_(method) {}
  std::string name() const override { return method_ == 0 ? "ECC" : "KLT"; }
  void begin(const HomographyOptions& options, const PatchFrames& frames, const std::uint8_t* first) override {
    options_ = options;
    left_ = frames.left();
    top_ = frames.top();
    reference_ = first;
    is_first_ = 1;
  }
  Tracked follow(const std::uint8_t* image, const Homography&, Homography& H) override {
    const double us = call_(method_, reference_, left_, top_, options_.side, image, options_.width, options_.height,
                            is_first_, H.data());
    is_first_ = 0;
    return {us >= 0, std::fabs(us), -1};
  }

 private:
  PeerCall call_;
  int method_;
  HomographyOptions options_;
  int left_ = 0, top_ = 0, is_first_ = 1;
  const std::uint8_t* reference_ = nullptr;
};

/// Root mean square of the corners' errors [px^2 summed over x and y], and the largest.
double corner_error2(const HomographyOptions& o, const PatchFrames& f, const Homography& a, const Homography& b) {
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const double x = f.left() + (k == 1 || k == 2 ? o.side - 1 : 0), y = f.top() + (k >= 2 ? o.side - 1 : 0);
    const auto p = map_pixel(a, x, y), q = map_pixel(b, x, y);
    sum += 0.25 * ((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]));
  }
  return sum;
}

/// One tracker with one trouble, over all seeds.
struct Outcome {
  std::vector<double> rmse, us, nees;
  double square_sum = 0;  ///< over the frames of this seed [px^2]
  int lost = 0;
};

class HomographySuite {
 public:
  explicit HomographySuite(const SuiteOptions& options) : options_(options), report_(options) {
    trackers_.push_back(std::make_unique<OwnTracker>());
    std::string peer = "built without OpenCV (Debian: libopencv-calib3d-dev)";
#ifdef PF_BENCH_HOMOGRAPHY_MODULE
    void* module = dlopen(PF_BENCH_HOMOGRAPHY_MODULE, RTLD_NOW | RTLD_LOCAL);
    if (module != nullptr) {
      const auto call = reinterpret_cast<PeerCall>(dlsym(module, "pf_bench_homography"));
      const auto name = reinterpret_cast<const char* (*)()>(dlsym(module, "pf_bench_homography_name"));
      for (int method = 0; method < 2; ++method) trackers_.push_back(std::make_unique<OpenCvTracker>(call, method));
      peer = name();
    } else {
      peer = std::string("the module with OpenCV cannot be loaded: ") + dlerror();
    }
#endif
    report_.note("scalar", scalar_name());
    report_.note("peers", peer);
    report_.note("clock",
                 "processor time of the one thread; the pyramid, which a frame has for its points, is not in it");
  }

  int run() {
    return options_.sources.empty() && options_.patch.empty() && options_.truth.empty() ? run_drawn() : run_stored();
  }

 private:
  int run_drawn() {
    const std::pair<const char*, PatchTrouble> kinds[] = {
        {"plain", PatchTrouble::kNone}, {"occlusion", PatchTrouble::kOcclusion}, {"light", PatchTrouble::kLight}};
    std::vector<std::string> last;
    HomographyOptions what;
    what.frames = std::min(what.frames, options_.frames);
    what.hidden = options_.hidden;
    for (const auto& [name, trouble] : kinds) {
      std::vector<Outcome> outcomes(trackers_.size());
      for (int seed = 1; seed <= options_.seeds; ++seed) {
        HomographyFrames frames(what, trouble, static_cast<std::uint64_t>(seed));
        run_frames(what, frames, outcomes);
      }
      last.push_back(add_rows(name, what, outcomes, options_.seeds));
    }
    for (std::size_t i = 0; i < last.size(); ++i) report_.note(kinds[i].first, last[i]);
    return report_.finish();
  }

  int run_stored() {
    std::string message;
    const std::unique_ptr<StoredPatchFrames> frames = StoredPatchFrames::read(options_, message);
    if (!frames) {
      std::fprintf(stderr, "pf-bench homography: %s\n", message.c_str());
      return 2;
    }
    std::vector<Outcome> outcomes(trackers_.size());
    run_frames(frames->options(), *frames, outcomes);
    report_.note(frames->name(), add_rows(frames->name(), frames->options(), outcomes, 1));
    return report_.finish();
  }

  std::string add_rows(const std::string& name, const HomographyOptions& what, const std::vector<Outcome>& outcomes,
                       int runs) {
    double fastest = 0;  // of the peers that keep the patch
    std::string peer;
    for (std::size_t t = 1; t < trackers_.size(); ++t) {
      const double us = median(outcomes[t].us);
      if (outcomes[t].lost == 0 && (peer.empty() || us < fastest)) {
        fastest = us;
        peer = trackers_[t]->name();
      }
    }
    for (std::size_t t = 0; t < trackers_.size(); ++t) {
      const Outcome& o = outcomes[t];
      const double us = median(o.us);
      Row row{"homography", name + " " + trackers_[t]->name(), scalar_name(), what.side, 0, us,
              peer,         fastest > 0 ? us / fastest : 0};
      row.figures = {{"rmse_px", median(o.rmse)},
                     {"rmse_worst_px", *std::max_element(o.rmse.begin(), o.rmse.end())},
                     {"lost", static_cast<double>(o.lost)}};
      if (!o.nees.empty()) {
        double sum = 0;
        for (const double v : o.nees) sum += v;
        row.figures.emplace_back("nees", sum / static_cast<double>(o.nees.size()));
      }
      report_.add(row);
    }
    const Outcome& own = outcomes[0];
    char line[160];
    std::snprintf(line, sizeof line, "%.4f px RMSE of four corners (worst seed %.4f), %d of %d frames lost, %.2f ms",
                  median(own.rmse), *std::max_element(own.rmse.begin(), own.rmse.end()), own.lost,
                  runs * (what.frames - 1), 1e-3 * median(own.us));
    return line;
  }

  void run_frames(const HomographyOptions& what, PatchFrames& frames, std::vector<Outcome>& outcomes) {
    const std::vector<std::uint8_t> first = frames.draw(0);
    std::vector<Homography> H(trackers_.size(), frames.truth(0));
    for (Outcome& outcome : outcomes) outcome.square_sum = 0;
    for (const auto& tracker : trackers_) tracker->begin(what, frames, first.data());
    for (int frame = 1; frame < what.frames; ++frame) {
      const std::vector<std::uint8_t>& image = frames.draw(frame);
      for (std::size_t t = 0; t < trackers_.size(); ++t) {
        const Tracked found = trackers_[t]->follow(image.data(), frames.truth(frame), H[t]);
        double error2 = corner_error2(what, frames, H[t], frames.truth(frame));
        if (!found.found || !(error2 < kLostPx * kLostPx)) {
          error2 = kLostPx * kLostPx;
          ++outcomes[t].lost;
        }
        outcomes[t].square_sum += error2;
        outcomes[t].us.push_back(found.us);
        if (found.nees >= 0) outcomes[t].nees.push_back(found.nees);
      }
    }
    for (Outcome& outcome : outcomes) outcome.rmse.push_back(std::sqrt(outcome.square_sum / (what.frames - 1)));
  }

  SuiteOptions options_;
  Report report_;
  std::vector<std::unique_ptr<PatchTracker>> trackers_;
};

int run_homography(const SuiteOptions& options) { return HomographySuite(options).run(); }

const Suite homography_suite("homography",
                             "a patch on a plane in rendered frames, beside OpenCV's ECC and Lucas-Kanade",
                             run_homography, Suite::kPatch);

}  // namespace
}  // namespace bench
