#include "paper_run.h"

#include <array>
#include <cmath>
#include <ctime>
#include <memory>

#include "../statistics.h"
#include "figure1.h"

namespace pfsim::gee {
namespace {

constexpr double kTrueShare = 0.8;  // of a true plane's points lie on one wall

/// e^T P^-1 e, negative when P is not positive.
double nees(const VecX& e, const MatX& P) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = P;
  const int n = static_cast<int>(e.size());
  return normalised_error(e.data(), rows.data(), n, n, 0);
}

/// NEES of the camera. The quaternion's covariance has rank 3, so that it is judged by the rotation that q stands for.
void judge_camera(const Slam& slam, const Vec7& truth, PaperRow* row) {
  const Vec7 v = slam.pose();
  const MatX P = slam.pose_covariance();
  Mat<6, 7> J = Mat<6, 7>::Zero();
  J.topLeftCorner<3, 4>() = 4 * increment_jacobian(v.head<4>()).transpose();
  J.bottomRightCorner<3, 3>().setIdentity();
  Vec6 e;
  e << rotation_error(v.head<4>(), truth.head<4>()), truth.tail<3>() - v.tail<3>();
  row->nees_pose = static_cast<float>(nees(e, J * P * J.transpose()));
  row->nees_position = static_cast<float>(nees(e.tail<3>(), P.bottomRightCorner<3, 3>()));
  row->camera_square = static_cast<float>(e.tail<3>().squaredNorm());
}

void judge_map(const Slam& slam, const World& world, PaperRow* row) {
  double square = 0;
  std::array<int, 4> counts{};
  for (const auto& [id, feature] : slam.features()) {
    ++counts[static_cast<std::size_t>(feature.kind)];
    if (feature.kind == Kind::kInverseDepth) continue;
    square += (slam.place(feature) - world.points()[static_cast<std::size_t>(id)].p_W).squaredNorm();
  }
  const int judged = counts[1] + counts[2] + counts[3];
  row->map_square = static_cast<float>(square / std::max(1, judged));
  row->inverse_depths = static_cast<float>(counts[0]);
  row->points = static_cast<float>(counts[1]);
  row->planar = static_cast<float>(counts[2]);
  row->fixed = static_cast<float>(counts[3]);
  row->planes = static_cast<float>(slam.planes().size());
}

/// A plane is true when most of its points lie on one wall; a second true one of the same wall is a duplicate.
void judge_planes(const Slam& slam, const World& world, PaperSummary* summary) {
  std::array<int, 4> found{};
  for (const Plane& plane : slam.planes()) {
    std::array<int, 4> on{};
    for (const int id : plane.points) {
      const int wall = world.points()[static_cast<std::size_t>(id)].wall;
      if (wall >= 0) ++on[static_cast<std::size_t>(wall)];
    }
    if (plane.points.empty()) {
      ++summary->planes_unused;
      continue;
    }
    const auto most = std::max_element(on.begin(), on.end());
    const double share = *most / static_cast<double>(plane.points.size());
    summary->wall_share_sum += share;
    if (share < kTrueShare)
      ++summary->planes_false;
    else if (found[static_cast<std::size_t>(most - on.begin())]++)
      ++summary->planes_duplicate;
    else
      ++summary->planes_true;
  }
}

}  // namespace

bool choose_case(char letter, SlamOptions* options) {
  const std::string cases = "ABCDEF";
  const std::size_t index = cases.find(letter);
  if (index == std::string::npos) return false;
  const double sigma_T[6] = {0, 0.02, 0.10, 0.02, 0.10, 0.10}, sigma_fix[6] = {0, 0, 0, 0.001, 0.01, 0.001};
  options->planes = index > 0;
  options->fixing = index > 2;
  options->discovery.sigma_T = sigma_T[index];
  options->sigma_fix = sigma_fix[index];
  return true;
}

Moments moments_of(int frames, int frames_per_loop) {
  const int last = frames - 1;
  return {std::min(last, frames_per_loop * 7 / 9), std::min(last, frames_per_loop * 101 / 100), last};
}

PaperSummary run_paper(const WorldOptions& world_options, const SlamOptions& slam_options, std::uint64_t seed,
                       const std::string& figure_prefix, PaperRow* rows) {
  World world(world_options, seed);
  std::vector<Vec3> known;
  for (int id = 0; id < World::kTarget; ++id) known.push_back(world.points()[static_cast<std::size_t>(id)].p_W);
  // The first pose is told with an error drawn from what is said about it.
  pf::sim::Random random(seed, 24);
  const auto draw = [&random](double sigma) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return Vec3(sigma * Vec3(x, y, z));
  };
  Vec7 first = world.pose(0);
  first.head<4>() = product(increment(draw(slam_options.sigma_start_turn)), Vec4(first.head<4>()));
  first.tail<3>() += draw(slam_options.sigma_start_step);

  Slam slam(slam_options, world.camera(), first, known, seed);
  const Moments moments = moments_of(world_options.frames, world_options.frames_per_loop);
  std::unique_ptr<Figure1> figure;
  if (!figure_prefix.empty()) figure = std::make_unique<Figure1>(figure_prefix, world);
  PaperSummary summary;
  const std::clock_t begin = std::clock();
  for (int f = 0; f < world_options.frames; ++f) {
    const std::vector<Measurement> seen = world.observe(f);
    if (!slam.step(f, seen)) return summary;
    PaperRow& row = rows[f];
    judge_camera(slam, world.pose(f), &row);
    judge_map(slam, world, &row);
    row.state_dim = static_cast<float>(slam.dimension());
    row.measured = static_cast<float>(seen.size());
    if (!figure) continue;
    figure->add_pose(f, slam);
    if (f == moments.before) figure->add_map("before", f, slam);
    if (f == moments.after) figure->add_map("after", f, slam);
    if (f == moments.end) figure->add_map("end", f, slam);
  }
  summary.cpu_seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  judge_planes(slam, world, &summary);
  summary.map_square = static_cast<double>(rows[world_options.frames - 1].map_square);
  summary.done = 1;
  return summary;
}

}  // namespace pfsim::gee
