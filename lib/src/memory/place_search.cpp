#include "memory/place_search.h"

#include <algorithm>

#include "memory/tuning.h"

namespace pf {

using namespace tuning::place_search;

namespace {

constexpr int kColumns = 8, kRows = 6;  ///< parts of the image, each of which gives some corners
constexpr int kMaxCorners = kColumns * kRows * kCellCorners;

}  // namespace

bool PlaceSearch::layout(Arena& arena, bool is_asked_for) {
  capacity_ = is_asked_for ? kMaxCorners : 0;
  corner_ = arena.take<DescribedCorner>(static_cast<std::size_t>(capacity_));
  return arena.ok();
}

void PlaceSearch::init() {
  count_ = 0;
  random_ = kSeed;
}

void PlaceSearch::describe_image(const Tracker& tracker) {
  count_ = 0;
  if (capacity_ == 0) return;
  const Pyramid& pyramid = tracker.pyramid();
  const int width = pyramid.level[0].width, height = pyramid.level[0].height;
  for (int part = 0; part < kColumns * kRows; ++part) {
    const int column = part % kColumns, row = part / kColumns;
    const int x0 = column * width / kColumns, y0 = row * height / kRows;
    Corner corner[kCellCorners];
    const int found = tracker.corners({x0, y0, (column + 1) * width / kColumns - x0, (row + 1) * height / kRows - y0},
                                      kThreshold, corner, kCellCorners);
    for (int c = 0; c < found; ++c) {
      DescribedCorner& described = corner_[count_];
      described.pixel = Vec2(static_cast<Scalar>(corner[c].x), static_cast<Scalar>(corner[c].y));
      bool any = false;
      for (int l = 0; l < kLevels; ++l) {
        described.has_level[l] =
            l < pyramid.levels && describe(pyramid.level[l], to_level(described.pixel, l), &described.descriptor[l]);
        any = any || described.has_level[l];
      }
      if (any) ++count_;
    }
  }
}

int PlaceSearch::corner_of(const Descriptor& point) const {
  constexpr int kAll = 64 * Descriptor::kWords;
  std::int16_t bits[kMaxCorners];
  int best = -1;
  for (int c = 0; c < count_; ++c) {
    int least = kAll;
    for (int l = 0; l < kLevels; ++l)
      if (corner_[c].has_level[l]) least = std::min(least, distance(point, corner_[c].descriptor[l]));
    bits[c] = static_cast<std::int16_t>(least);
    if (best < 0 || least < bits[best]) best = c;
  }
  if (best < 0 || bits[best] > kMaxBits) return -1;
  int second = kAll;
  for (int c = 0; c < count_; ++c)
    if ((corner_[c].pixel - corner_[best].pixel).squaredNorm() > kSameCorner * kSameCorner)
      second = std::min<int>(second, bits[c]);
  return static_cast<Scalar>(bits[best]) < kMaxRatio * static_cast<Scalar>(second) ? best : -1;
}

int PlaceSearch::find_pose_of(const Camera& camera, const PlaceMatches& matches, PoseEstimate* pose, bool* is_inlier) {
  const Scalar width = static_cast<Scalar>(camera.width);
  const PnpSearch search = {kBoundWidth * width, kTrials, kMinMatches, {kSigmaWidth * width, kHuber, kRounds}};
  unsigned char inlier[PlaceMatches::kMax];
  const int inliers = find_pose(camera, matches.point, matches.count, search, &random_, pose, inlier);
  if (inliers > 0) pose->covariance *= kInflation;
  for (int i = 0; i < matches.count; ++i) is_inlier[i] = inliers > 0 && inlier[i] != 0;
  return inliers;
}

}  // namespace pf
