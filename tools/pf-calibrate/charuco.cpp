#include "charuco.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "levels.h"
#include "markers.h"

namespace pf::calibrate {

namespace {

constexpr float kMargin = static_cast<float>(0.5 * (1.0 - kMarkerShare));  ///< between a marker and the next square

/// A picture's place of a point of the board, in squares from the board's own corner, as one marker alone has it.
class MarkerFrame {
 public:
  MarkerFrame(const Marker& marker, cv::Point square) {
    const auto x = static_cast<float>(square.x), y = static_cast<float>(square.y);
    const float low = kMargin, high = 1.0F - kMargin;
    const cv::Point2f printed[4] = {{x + low, y + low}, {x + high, y + low}, {x + high, y + high}, {x + low, y + high}};
    H_ = cv::getPerspectiveTransform(printed, marker.corners.data());
  }

  cv::Point2f at(float x, float y) const {
    const double w = H_(2, 0) * x + H_(2, 1) * y + H_(2, 2);
    return {static_cast<float>((H_(0, 0) * x + H_(0, 1) * y + H_(0, 2)) / w),
            static_cast<float>((H_(1, 0) * x + H_(1, 1) * y + H_(1, 2)) / w)};
  }

 private:
  cv::Matx33d H_;
};

/// An inner corner as the two markers see it that touch it: white squares lie diagonally across.
struct Candidate {
  int corner = 0;
  cv::Point2f at, right, down;  ///< the corner, and one square from it along the board's rows and columns [px]
  float margin_px = 0.0F;       ///< to the nearer marker's corner
};

/// Whether the quarters around a corner are dark and light as they were printed. What covers a corner is not.
bool has_quarters(const cv::Mat& grey, const Candidate& c, const cv::Point2f& at, bool dark_first) {
  double lightest_dark = 0.0, darkest_light = 255.0;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const float x = quarter % 2 == 0 ? -kMargin : kMargin, y = quarter < 2 ? -kMargin : kMargin;
    const double level = level_at(grey, at + 0.7F * x * c.right + 0.7F * y * c.down);
    const bool dark = (quarter == 0 || quarter == 3) == dark_first;
    (dark ? lightest_dark : darkest_light) = dark ? std::max(lightest_dark, level) : std::min(darkest_light, level);
  }
  return darkest_light > lightest_dark + 12.0;
}

std::vector<Candidate> find_candidates(const std::map<int, MarkerFrame>& frames, const Board& board, Sighting& found) {
  std::vector<Candidate> candidates;
  const int across = board.columns - 1;
  for (int corner = 0; corner < across * (board.rows - 1); ++corner) {
    const int x = corner % across + 1, y = corner / across + 1;  // of the squares below and to the right
    const bool rising = board.is_dark(x, y);                     // white: top right and bottom left
    const auto a = frames.find(marker_in_square(board, rising ? x : x - 1, y - 1));
    const auto b = frames.find(marker_in_square(board, rising ? x - 1 : x, y));
    if (a == frames.end() || b == frames.end()) {
      continue;
    }
    const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
    const cv::Point2f by_a = a->second.at(fx, fy), by_b = b->second.at(fx, fy);
    Candidate c;
    c.corner = corner;
    c.at = 0.5F * (by_a + by_b);
    c.right = 0.5F * (a->second.at(fx + 0.5F, fy) - a->second.at(fx - 0.5F, fy) + b->second.at(fx + 0.5F, fy) -
                      b->second.at(fx - 0.5F, fy));
    c.down = 0.5F * (a->second.at(fx, fy + 0.5F) - a->second.at(fx, fy - 0.5F) + b->second.at(fx, fy + 0.5F) -
                     b->second.at(fx, fy - 0.5F));
    const float side = static_cast<float>(std::min(cv::norm(c.right), cv::norm(c.down)));
    ++found.pairs;
    if (!(cv::norm(by_a - by_b) < 0.3 * side)) {
      continue;  // these two are no neighbours: another board, or something that looks like a marker
    }
    ++found.agreeing_pairs;
    const float out = rising ? 1.0F : -1.0F;  // towards the marker above
    c.margin_px = static_cast<float>(
        std::min(cv::norm(kMargin * (out * c.right - c.down)), cv::norm(kMargin * (c.down - out * c.right))));
    candidates.push_back(c);
  }
  return candidates;
}

/// The corners that markers give if they lie where this board has them.
std::vector<Candidate> place(const std::vector<Marker>& markers, const Board& board, Sighting& found) {
  std::map<int, MarkerFrame> frames;
  found = {};
  for (const Marker& marker : markers) {
    ++found.markers;
    found.highest_marker = std::max(found.highest_marker, marker.number);
    if (marker.number < board.markers()) {
      frames.emplace(marker.number, MarkerFrame(marker, square_of_marker(board, marker.number)));
    }
  }
  return find_candidates(frames, board, found);
}

/// A view whose corners lie on few rows or columns says little and bends the fit.
bool is_wide(const View& view, const Board& board) {
  std::set<int> columns, rows;
  for (int corner : view.numbers) {
    columns.insert(corner % (board.columns - 1));
    rows.insert(corner / (board.columns - 1));
  }
  return columns.size() >= 3 && rows.size() >= 3 && view.corners.size() >= kFewestCorners;
}

}  // namespace

bool find_charuco(const cv::Mat& grey, const Board& given, View& view, Sighting& found) {
  const std::vector<Marker> markers = find_markers(grey, given);
  Board board = given;
  std::vector<Candidate> candidates = place(markers, board, found);
  if (given.rows % 2 == 0) {  // of an odd number of rows both kinds of board are the same
    Board other = given;
    Sighting found_other;
    other.light_first = !given.light_first;
    std::vector<Candidate> others = place(markers, other, found_other);
    if (found_other.agreeing_pairs > found.agreeing_pairs) {
      board = other;
      found = found_other;
      candidates.swap(others);
    }
  }
  view.light_first = board.light_first;
  view.corners.clear();
  view.numbers.clear();
  const cv::TermCriteria until(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 60, 1e-4);
  for (const Candidate& c : candidates) {
    // The window of the refinement ends before the markers begin.
    const int half = std::clamp(static_cast<int>(0.7F * c.margin_px), 2, 12);
    const auto edge = static_cast<float>(half + 2);
    const cv::Rect2f inside(edge, edge, static_cast<float>(grey.cols) - 2.0F * edge,
                            static_cast<float>(grey.rows) - 2.0F * edge);
    if (!inside.contains(c.at)) {
      continue;
    }
    std::vector<cv::Point2f> refined = {c.at};
    cv::cornerSubPix(grey, refined, {half, half}, {-1, -1}, until);
    const bool dark_first = board.is_dark(c.corner % (board.columns - 1), c.corner / (board.columns - 1));
    if (cv::norm(refined[0] - c.at) < std::max(2.0F, 0.7F * c.margin_px) &&
        has_quarters(grey, c, refined[0], dark_first)) {
      view.corners.push_back(refined[0]);
      view.numbers.push_back(c.corner);
    }
  }
  if (!is_wide(view, board)) {
    return false;
  }
  view.blur_px = edge_spread(grey, board, view);
  return true;
}

}  // namespace pf::calibrate
