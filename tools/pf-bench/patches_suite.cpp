// Homographies of patches on walls as measurements of the filter: the box of Servant 2008 with a wrong plan, circled once, every patch's
// corners drawn with the noise that the filter is told. No images, no points.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "covariance/select.h"
#include "filter/filter.h"
#include "geometry/plane.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "sim/trajectory.h"
#include "suite.h"

namespace bench {
namespace {

using SimMat3 = pf::sim::Mat3;
using SimVec3 = pf::sim::Vec3;
using pf::sim::Pose;
using pf::sim::Random;

constexpr double kPi = 3.14159265358979323846, kDegree = kPi / 180;
constexpr int kSides = 4, kFrames = 930;
constexpr double kRate = 30, kRadius = 2, kLoopSeconds = 30, kHalf = 0.5;
constexpr double kMaxAngleDeg = 6, kSigmaOffset = 0.002, kExact = 1e-6;
constexpr double kSigmaStart = 0.002, kSigmaStartDeg = 0.1, kSigmaSpeed = 0.1;
constexpr double kShakeM = 0.01, kShakeRad = 0.01;
constexpr double kCornerPx = 0.1;                        // noise of a corner, in the reference and in each frame
constexpr double kNoNoise = 1e-4;                        // [px]
constexpr double kPatchHalf = 0.15, kPatchReach = 0.25;  // of a patch, and where its middle may be [m]
constexpr double kBirthSlant = 52, kMaxSlant = 66;       // [deg]
constexpr int kPatchesOnWall = 3, kBirthFrames = 30;     // a wall's next one begins so long after its last
constexpr double kGate8 = 26.12;                         // chi-square with 8 degrees of freedom, 99.9 %
constexpr double kBorder = 8;                            // [px]
constexpr pf::MotionNoise kMotion{1.5, 1.5};

enum Stream : std::uint64_t { kPlanStream = 81, kPathStream, kStartStream, kPatchStream, kNoiseStream };

pf::Vec3 vec(const SimVec3& v) {
  return pf::Vec3(static_cast<pf::Scalar>(v.x), static_cast<pf::Scalar>(v.y), static_cast<pf::Scalar>(v.z));
}
pf::Mat3 mat(const SimMat3& m) {
  pf::Mat3 out;
  for (int i = 0; i < 9; ++i) out(i / 3, i % 3) = static_cast<pf::Scalar>(m.m[static_cast<std::size_t>(i)]);
  return out;
}
SimVec3 normal(int side) { return {std::sin(0.5 * kPi * side), 0, std::cos(0.5 * kPi * side)}; }
SimMat3 side_frame(int side) {
  const SimVec3 up{0, -1, 0};
  return SimMat3::columns(up.cross(normal(side)), up, normal(side));
}

struct Patch {
  int slot, side, born;
  pf::Vec3 corner_W[4];
  pf::Vec2 reference_px[4];
};

enum class Told {
  kAsDrawn,        ///< walls and noise as they are drawn
  kWallsExact,     ///< walls as if they were exact
  kReferenceExact  ///< the reference's own noise as if there were none
};

struct Result {
  double rmse_m = 0, worst_m = 0, nees = 0, wall_deg = 0, plan_deg = 0;
  int rejected = 0, measured = 0;
};

class BoxRun {
 public:
  BoxRun(std::uint64_t seed, Told told)
      : own_px_(told == Told::kReferenceExact ? kNoNoise : kCornerPx),
        patch_random_(seed, kPatchStream),
        noise_(seed, kNoiseStream),
        block_(std::aligned_alloc(64, kBytes), std::free) {
    const double f = 320 / std::tan(28 * kDegree), intrinsics[4] = {f, f, 319.5, 239.5}, distortion[8] = {};
    pf::make_camera(static_cast<int>(pf::CameraModel::kPinhole), 640, 480, intrinsics, distortion, &camera_);
    Random way(seed, kPathStream);
    path_ = shaken(
        [](double t) {
          const double since = std::max(0.0, t - 1), run = since < 2 ? since * since / 4 : since - 1;
          const double a = 2 * kPi * run / kLoopSeconds;  // it begins before a side
          const SimVec3 radial{std::sin(a), 0, std::cos(a)};
          return Pose{pf::sim::look_along(-radial, {0, 1, 0}), radial * kRadius};
        },
        way, kShakeM, kShakeRad);
    pf::Arena arena(block_.get(), kBytes);
    filter_.layout(arena, {300, 16, 64, kSides});
    filter_.init(pf::select_kernels(0), pf::BodyLayout::with_constant_velocity(), true);
    filter_.set_lens(camera_, pf::LensPrior());
    begin(seed);
    add_walls(seed, told == Told::kWallsExact);
  }

  Result run() {
    for (int frame = 0; frame < kFrames; ++frame) {
      truth_ = path_(frame / kRate);
      if (frame > 0) {
        pf::Transition transition;
        predict_constant_velocity(filter_.state().body, filter_.state().layout, pf::Scalar(1 / kRate), kMotion,
                                  &transition);
        filter_.predict(transition);
      }
      drop_unseen();
      measure();
      begin_patches(frame);
      judge();
    }
    result_.rmse_m = std::sqrt(result_.rmse_m / kFrames);
    result_.nees /= kFrames;
    for (int side = 0; side < kSides; ++side) {
      pf::Vec3 n;
      pf::Scalar d;
      const pf::Block& wall = filter_.state().block[wall_[side]];
      plane_normal(filter_.state().frame_of(wall), wall.xyz(), &n, &d);
      const double cosine = static_cast<double>(n.dot(vec(normal(side))));
      result_.wall_deg += std::acos(std::min(1.0, cosine)) / kDegree / kSides;
    }
    return result_;
  }

 private:
  static constexpr std::size_t kBytes = std::size_t{8} << 20;

  void begin(std::uint64_t seed) {
    Random draw(seed, kStartStream);
    truth_ = path_(0);
    SimVec3 v, w;
    velocities(path_, 0, v, w);
    pf::Body body;
    body.q_WC = pf::Quat(mat(rotation_exp(draw.normal3() * (kSigmaStartDeg * kDegree)) * truth_.R_WC));
    body.p_W = vec(truth_.p_WC + draw.normal3() * kSigmaStart);
    body.v_W = vec(v + draw.normal3() * kSigmaSpeed);
    body.w_C = vec(w + draw.normal3() * kSigmaSpeed);
    pf::Scalar P[144] = {};
    for (int i = 0; i < 12; ++i) {
      const double sigma = i < 3 ? kSigmaStartDeg * kDegree : i < 6 ? kSigmaStart : kSigmaSpeed;
      P[13 * i] = static_cast<pf::Scalar>(sigma * sigma);
    }
    filter_.set_body(body, P);
  }

  void add_walls(std::uint64_t seed, bool exact) {
    Random plan(seed, kPlanStream);
    for (int side = 0; side < kSides; ++side) {
      const double angle = kMaxAngleDeg * kDegree * std::sqrt(plan.uniform()), direction = plan.uniform(0, 2 * kPi);
      const SimMat3 R =
          side_frame(side) * pf::sim::rotation_exp(SimVec3{std::cos(direction), std::sin(direction), 0} * angle);
      const SimVec3 n{R(0, 2), R(1, 2), R(2, 2)};
      pf::PlaneFrame frame;
      frame.R_WP = mat(R);
      frame.o_W = vec(normal(side) * kHalf + n * (kSigmaOffset * plan.normal()));
      const double sigma = exact ? kExact : 0.5 * kMaxAngleDeg * kDegree, offset = exact ? kExact : kSigmaOffset;
      pf::Mat3 C = pf::Mat3::Zero();
      C(0, 0) = C(1, 1) = static_cast<pf::Scalar>(sigma * sigma);
      C(2, 2) = static_cast<pf::Scalar>(offset * offset);
      wall_[side] = filter_.add_known_plane(frame, C, pf::Scalar(0));
      result_.plan_deg += angle / kDegree / kSides;
    }
  }

  /// Of a corner as the camera truly sees it. False outside of the image.
  bool see(const pf::Vec3& p_W, pf::Vec2* pixel) const {
    const pf::Vec3 p = mat(truth_.R_WC).transpose() * (p_W - vec(truth_.p_WC));
    const pf::Scalar low = static_cast<pf::Scalar>(kBorder);
    return project(camera_, p, pixel) && pixel->x() > low && pixel->y() > low && pixel->x() < 640 - low &&
           pixel->y() < 480 - low;
  }
  double slant_deg(int side, const pf::Vec3& middle_W) const {
    const pf::Vec3 ray = vec(truth_.p_WC) - middle_W;
    return std::acos(static_cast<double>(ray.normalized().dot(vec(normal(side))))) / kDegree;
  }
  bool see_patch(const Patch& patch, double max_slant, pf::Vec2* pixel) const {
    if (!(slant_deg(patch.side, (patch.corner_W[0] + patch.corner_W[2]) / 2) < max_slant)) return false;
    bool all = true;
    for (int k = 0; k < 4; ++k) all = all && see(patch.corner_W[k], &pixel[k]);
    return all;
  }
  pf::Vec2 noise() {
    return pf::Vec2(static_cast<pf::Scalar>(kCornerPx * noise_.normal()),
                    static_cast<pf::Scalar>(kCornerPx * noise_.normal()));
  }

  void drop_unseen() {
    pf::Vec2 pixel[4];
    for (std::size_t i = patches_.size(); i-- > 0;)
      if (!see_patch(patches_[i], kMaxSlant, pixel)) {
        filter_.remove(&patches_[i].slot, 1);
        patches_.erase(patches_.begin() + static_cast<std::ptrdiff_t>(i));
      }
  }

  void measure() {
    std::vector<pf::PatchMeasurement> z;
    for (const Patch& patch : patches_) {
      pf::Vec2 pixel[4];
      pf::PatchMeasurement o;
      if (!see_patch(patch, kMaxSlant, pixel) ||
          !filter_.predict_patch(camera_, patch.slot, wall_[patch.side], patch.reference_px, &o))
        continue;
      for (int k = 0; k < 4; ++k) o.measured.segment<2>(2 * k) = pixel[k] + noise();
      o.set_noise(pf::PatchMeasurement::Matrix::Identity() * static_cast<pf::Scalar>(kCornerPx * kCornerPx));
      const pf::PatchMeasurement::Matrix S = filter_.blocks().covariance_of<8>(o.H) + o.R_gate;
      const pf::PatchMeasurement::Vector r = o.measured - o.predicted;
      pf::SmallCholesky<8> cholesky;
      ++result_.measured;
      if (cholesky.factor(S) && r.dot(cholesky.solve<1>(r)) < static_cast<pf::Scalar>(kGate8))
        z.push_back(o);
      else
        ++result_.rejected;
    }
    if (z.empty()) return;
    std::vector<pf::Measurement> views;
    for (const pf::PatchMeasurement& o : z) views.push_back(o.view());
    const int count = static_cast<int>(views.size());
    pf::Scalar nis;
    filter_.begin_update(views.data(), count);
    filter_.finish_update(views.data(), count, nullptr, &nis);
  }

  void begin_patches(int frame) {
    int camera = -1;
    for (int side = 0; side < kSides; ++side) {
      int on_wall = 0, last = -kBirthFrames;
      for (const Patch& p : patches_)
        if (p.side == side) {
          ++on_wall;
          last = std::max(last, p.born);
        }
      if (on_wall >= kPatchesOnWall || frame - last < kBirthFrames) continue;
      Patch patch{-1, side, frame, {}, {}};
      const SimVec3 middle{patch_random_.uniform(-kPatchReach, kPatchReach),
                           patch_random_.uniform(-kPatchReach, kPatchReach), 0};
      for (int k = 0; k < 4; ++k) {
        const SimVec3 at{middle.x + (k == 1 || k == 2 ? kPatchHalf : -kPatchHalf),
                         middle.y + (k >= 2 ? kPatchHalf : -kPatchHalf), kHalf};
        patch.corner_W[k] = vec(side_frame(side) * at);
      }
      pf::Vec2 pixel[4];
      if (!see_patch(patch, kBirthSlant, pixel)) continue;
      if (camera < 0) camera = filter_.add_reference_camera();
      if (camera < 0) return;
      for (int k = 0; k < 4; ++k) patch.reference_px[k] = pixel[k] + noise();
      patch.slot = filter_.add_patch(
          camera, pf::PatchMeasurement::Matrix::Identity() * static_cast<pf::Scalar>(own_px_ * own_px_));
      if (patch.slot >= 0) patches_.push_back(patch);
    }
  }

  void judge() {
    const pf::Body& body = filter_.state().body;
    const pf::Vec3 e_p = vec(truth_.p_WC) - body.p_W;
    const pf::Quat turn = pf::Quat(mat(truth_.R_WC)) * body.q_WC.conjugate();
    pf::Vec6 e;
    e.head<3>() = pf::log_so3(turn);
    e.tail<3>() = e_p;
    pf::Mat6 P;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) P(i, j) = filter_.covariance()(std::max(i, j), std::min(i, j));
    pf::SmallCholesky<6> cholesky;
    if (cholesky.factor(P)) result_.nees += static_cast<double>(e.dot(cholesky.solve<1>(e)));
    const double error = static_cast<double>(e_p.norm());
    result_.rmse_m += error * error;
    result_.worst_m = std::max(result_.worst_m, error);
  }

  double own_px_;  ///< sigma of the reference's corners, as the filter is told
  Random patch_random_, noise_;
  std::unique_ptr<void, void (*)(void*)> block_;
  pf::Camera camera_;
  pf::Filter filter_;
  pf::sim::Trajectory path_;
  Pose truth_;
  std::vector<Patch> patches_;
  int wall_[kSides] = {};
  Result result_;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

int run_patches(const SuiteOptions& options) {
  Report report(options);
  report.note("scalar", scalar_name());
  for (const auto& [name, told] : {std::pair{"refined", Told::kAsDrawn},
                                   {"exact", Told::kWallsExact},
                                   {"reference as exact", Told::kReferenceExact}}) {
    std::vector<double> rmse, worst, nees, wall, plan;
    int rejected = 0, measured = 0;
    for (int seed = 1; seed <= options.seeds; ++seed) {
      const Result r = std::make_unique<BoxRun>(static_cast<std::uint64_t>(seed), told)->run();
      rmse.push_back(100 * r.rmse_m);
      worst.push_back(100 * r.worst_m);
      nees.push_back(r.nees);
      wall.push_back(r.wall_deg);
      plan.push_back(r.plan_deg);
      rejected += r.rejected;
      measured += r.measured;
    }
    Row row{"patches", name, scalar_name(), 0, 8, 0, "", 0};
    row.figures = {
        {"rmse_cm", median(rmse)},     {"rmse_worst_cm", *std::max_element(rmse.begin(), rmse.end())},
        {"largest_cm", median(worst)}, {"largest_worst_cm", *std::max_element(worst.begin(), worst.end())},
        {"nees_pose", median(nees)},   {"wall_deg", median(wall)},
        {"plan_deg", median(plan)},    {"rejected_share", measured > 0 ? static_cast<double>(rejected) / measured : 0}};
    report.add(row);
  }
  return report.finish();
}

const Suite patches_suite(
    "patches", "homographies of patches on walls in the filter: a box with a wrong plan, corners with drawn noise",
    run_patches, Suite::kSeeds);

}  // namespace
}  // namespace bench
