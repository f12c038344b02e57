#pragma once

// Views of a printed board through a known camera: 10 x 7 squares of 25 mm on white paper, a chessboard or any picture.

#include <planefold/planefold.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "seeded_random.h"
#include "unity.h"

namespace pf::test {

constexpr int kBoardColumns = 10, kBoardRows = 7;
constexpr double kBoardSquare = 0.025;

/// p_C = R p_board + t; the board's origin is its first inner corner, as pf-calibrate has it.
struct BoardPose {
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
};

/// What is printed on the board's squares, in place of a chessboard: grey levels, the board's corner first.
struct BoardPicture {
  double pixels_per_square = 0;
  int width = 0;
  std::vector<uint8_t> pixels;
};

class BoardCamera {
 public:
  explicit BoardCamera(const pf_camera_t& camera) : camera_(camera) {
    const double intrinsics[4] = {camera.fx, camera.fy, camera.cx, camera.cy};
    TEST_ASSERT_NULL(make_camera(camera.model, camera.width, camera.height, intrinsics, camera.distortion, &model_));
    for (int y = 0; y < camera.height * kSub; ++y) {
      for (int x = 0; x < camera.width * kSub; ++x) {
        Vec3 ray;
        if (!unproject(model_, Vec2((x + 0.5) / kSub - 0.5, (y + 0.5) / kSub - 0.5), &ray)) TEST_FAIL();
        rays_.push_back({static_cast<float>(ray(0) / ray(2)), static_cast<float>(ray(1) / ray(2))});
      }
    }
  }

  /// All of the board in the picture, with its white margin; anywhere, slanted by up to 50 degrees.
  BoardPose random_pose(SeededRandom& random) const {
    for (;;) {
      const BoardPose pose = slanted_pose(random, random.uniform(0.9, 2.6));
      if (shows_all(pose)) return pose;
    }
  }

  /// Near enough for part of the board to be out of the picture, where enough of it is left; slanted as above.
  BoardPose random_partial_pose(SeededRandom& random) const {
    for (;;) {
      BoardPose pose = slanted_pose(random, random.uniform(0.6, 1.5));
      if (!shows_all(pose) && corners_inside(pose) >= 20) return pose;
    }
  }

  /// The target in place of a chessboard; null: none.
  void print(const BoardPicture* picture) { picture_ = picture; }
  /// Something dark lies over the four corners of every picture, so far across and down [px].
  void cover_corners(int across, int down) { covered_ = {across, down}; }

  /// box  side of the window that blurs [px]; 1 leaves the pixel's own area
  std::vector<uint8_t> render(const BoardPose& pose, int box, double noise_grey, SeededRandom& random) const {
    // Ray to board: p = H⁻¹ (x, y, 1), H = [r1 r2 t].
    Eigen::Matrix3d H;
    H << pose.R.col(0), pose.R.col(1), pose.t;
    const Eigen::Matrix3d G = H.inverse();
    const int width = camera_.width, height = camera_.height;
    std::vector<float> grey(static_cast<size_t>(width) * height, 0.0F);
    for (int y = 0; y < height * kSub; ++y) {
      for (int x = 0; x < width * kSub; ++x) {
        const auto& ray = rays_[static_cast<size_t>(y) * width * kSub + x];
        const double w = G(2, 0) * ray[0] + G(2, 1) * ray[1] + G(2, 2);
        const double u = (G(0, 0) * ray[0] + G(0, 1) * ray[1] + G(0, 2)) / w / kBoardSquare + 1;
        const double v = (G(1, 0) * ray[0] + G(1, 1) * ray[1] + G(1, 2)) / w / kBoardSquare + 1;
        grey[static_cast<size_t>(y / kSub) * width + x / kSub] += static_cast<float>(w > 0 ? paper(u, v) : 90);
      }
    }
    for (int pass = 0; pass < 2; ++pass) grey = blurred(grey, std::max(box, 2));  // a lens that is not perfect
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool aside = x < covered_[0] || x >= width - covered_[0];
        if (aside && (y < covered_[1] || y >= height - covered_[1])) grey[at(x, y)] = 40.0F * kSub * kSub;
      }
    }
    std::vector<uint8_t> pixels(grey.size());
    for (size_t i = 0; i < grey.size(); ++i) {
      const double level = grey[i] / (kSub * kSub) + noise_grey * random.normal();
      pixels[i] = static_cast<uint8_t>(std::clamp(level + 0.5, 0.0, 255.0));
    }
    return pixels;
  }

  /// To where the corner truly is, where every corner is known by name.
  double squared_distance_to_named_corner(const BoardPose& pose, int corner, double x, double y) const {
    return squared_distance(pose, corner, x, y);
  }

  /// To where the corner truly is. A board that is turned by half looks the same: the nearer of its two names counts.
  double squared_distance_to_corner(const BoardPose& pose, int corner, double x, double y) const {
    const int count = (kBoardColumns - 1) * (kBoardRows - 1);
    return std::min(squared_distance(pose, corner, x, y), squared_distance(pose, count - 1 - corner, x, y));
  }

 private:
  static constexpr int kSub = 4;  ///< rays per pixel and direction

  /// With its middle somewhere in the picture; times: of a distance at which it fills about a quarter of it.
  BoardPose slanted_pose(SeededRandom& random, double times) const {
    for (;;) {
      const double slant = random.uniform(0.1, 0.87), towards = random.uniform(0, 6.283), spin = 0.3 * random.normal();
      const Eigen::Vector3d axis(std::cos(towards), std::sin(towards), 0);
      BoardPose pose;
      pose.R = (Eigen::AngleAxisd(slant, axis) * Eigen::AngleAxisd(spin, Eigen::Vector3d::UnitZ())).matrix();
      const double depth = 0.25 * camera_.fx / camera_.width * times;
      Vec3 ray;
      if (!unproject(model_, Vec2(random.uniform(0, camera_.width), random.uniform(0, camera_.height)), &ray)) continue;
      const Eigen::Vector3d middle((kBoardColumns - 2) * kBoardSquare / 2, (kBoardRows - 2) * kBoardSquare / 2, 0);
      pose.t = ray.cast<double>() * (depth / static_cast<double>(ray.z())) - pose.R * middle;
      return pose;
    }
  }

  int corners_inside(const BoardPose& pose) const {
    int count = 0;
    for (int column = 0; column < kBoardColumns - 1; ++column) {
      for (int row = 0; row < kBoardRows - 1; ++row) {
        bool inside;
        project(pose, column, row, &inside);
        count += inside ? 1 : 0;
      }
    }
    return count;
  }

  double paper(double u, double v) const {
    if (u < -1 || v < -1 || u > kBoardColumns + 1 || v > kBoardRows + 1) return 90;
    const bool board = u >= 0 && v >= 0 && u < kBoardColumns && v < kBoardRows;
    if (board && picture_ != nullptr) {
      const auto x = static_cast<size_t>(u * picture_->pixels_per_square);
      const auto y = static_cast<size_t>(v * picture_->pixels_per_square);
      return 25 + 190.0 / 255 * picture_->pixels[y * static_cast<size_t>(picture_->width) + x];
    }
    return board && (static_cast<int>(u) + static_cast<int>(v)) % 2 == 0 ? 25 : 215;
  }

  Eigen::Vector2d project(const BoardPose& pose, double column, double row, bool* inside) const {
    const Eigen::Vector3d p = pose.R * Eigen::Vector3d(column * kBoardSquare, row * kBoardSquare, 0) + pose.t;
    Vec2 pixel(-1, -1);
    *inside = p.z() > 0.005 && pf::project(model_, p.cast<Scalar>(), &pixel) && pixel[0] > 3 && pixel[1] > 3 &&
              pixel[0] < camera_.width - 4 && pixel[1] < camera_.height - 4;
    return pixel.cast<double>();
  }

  bool shows_all(const BoardPose& pose) const {
    bool all = true;
    for (double column : {-1.5, kBoardColumns / 2 - 1.0, kBoardColumns - 0.5}) {
      for (double row : {-1.5, kBoardRows / 2 - 1.0, kBoardRows - 0.5}) {
        bool inside;
        project(pose, column, row, &inside);
        all = all && inside;
      }
    }
    return all;
  }

  double squared_distance(const BoardPose& pose, int corner, double x, double y) const {
    bool inside;
    const int across = kBoardColumns - 1;
    return (project(pose, corner % across, corner / across, &inside) - Eigen::Vector2d(x, y)).squaredNorm();
  }

  /// Mean over a window of 2 k + 1 pixels, or for 2 the kernel 1 2 1, in both directions.
  std::vector<float> blurred(const std::vector<float>& in, int box) const {
    const int half = box / 2;
    const auto weight = [&](int k) {
      return box == 2 ? (k == 0 ? 0.5F : 0.25F) : 1.0F / static_cast<float>(2 * half + 1);
    };
    std::vector<float> across(in.size()), both(in.size());
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        float sum = 0;
        for (int k = -half; k <= half; ++k) sum += weight(k) * in[at(x + k, y)];
        across[at(x, y)] = sum;
      }
    }
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        float sum = 0;
        for (int k = -half; k <= half; ++k) sum += weight(k) * across[at(x, y + k)];
        both[at(x, y)] = sum;
      }
    }
    return both;
  }

  size_t at(int x, int y) const {
    return static_cast<size_t>(std::clamp(y, 0, camera_.height - 1)) * camera_.width +
           static_cast<size_t>(std::clamp(x, 0, camera_.width - 1));
  }

  pf_camera_t camera_;
  Camera model_;
  const BoardPicture* picture_ = nullptr;
  std::array<int, 2> covered_{};
  std::vector<std::array<float, 2>> rays_;  ///< x/z, y/z of every part of every pixel
};

}  // namespace pf::test
