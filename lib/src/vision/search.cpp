#include "vision/search.h"

#include <cmath>

namespace pf {

namespace {

constexpr int kSide = 2 * kSearchReach + 1;
constexpr float kScoreUnit = 32000.0f;

/// One row of the ellipse: columns begin .. end - 1, whose scores are kept from `at` on.
struct Span {
  int begin;
  int end;
  int at;
};

/// Scores of all positions, in reading order, in 1 / kScoreUnit.
struct ScoreMap {
  int top = 0;
  int rows = 0;
  Span span[kSide];
  std::int16_t score[kSide * kSide];

  int at(int x, int y) const {
    const int j = y - top;
    if (j < 0 || j >= rows || x < span[j].begin || x >= span[j].end) return -32768;
    return score[span[j].at + x - span[j].begin];
  }
};

/// The 63 columns at most of one row.
void score_row(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
               float* score) {
  int sum[kSide];
  int square[kSide];
  int dot[kSide];
  window_sums(first, stride, count, pattern, WindowSums{sum, square, dot});
  const float energy = static_cast<float>(pattern.energy);
  for (int k = 0; k < count; ++k) {
    const int over = 64 * dot[k] - sum[k] * pattern.sum;
    const int under = 64 * square[k] - sum[k] * sum[k];
    // Without contrast both are zero; 1 keeps the quotient finite.
    score[k] = static_cast<float>(over) / std::sqrt(static_cast<float>(under > 1 ? under : 1) * energy);
  }
}

/// Columns of row y inside of the ellipse, cut to low .. high. False when there is none.
bool cut_row(const SearchEllipse& ellipse, int y, int low, int high, Span* span) {
  const Mat2& M = ellipse.inverse_covariance;
  const Scalar m01 = (M(0, 1) + M(1, 0)) / 2;
  const Scalar dy = static_cast<Scalar>(y) - ellipse.centre.y();
  const Scalar middle = -m01 * dy / M(0, 0);
  const Scalar inside = middle * middle - (M(1, 1) * dy * dy - ellipse.gate) / M(0, 0);
  if (!(inside >= 0)) return false;
  const Scalar half = std::sqrt(inside);
  const Scalar begin = std::ceil(ellipse.centre.x() + middle - half);
  const Scalar end = std::floor(ellipse.centre.x() + middle + half);
  if (!(begin <= static_cast<Scalar>(high) && end >= static_cast<Scalar>(low))) return false;
  span->begin = begin > static_cast<Scalar>(low) ? static_cast<int>(begin) : low;
  span->end = (end < static_cast<Scalar>(high) ? static_cast<int>(end) : high) + 1;
  return span->begin < span->end;
}

bool is_usable(const SearchEllipse& ellipse) {
  const Mat2& M = ellipse.inverse_covariance;
  const Scalar m01 = (M(0, 1) + M(1, 0)) / 2;
  const Scalar limit = Scalar(1e6);
  return M(0, 0) > 0 && M(1, 1) > 0 && M(0, 0) * M(1, 1) > m01 * m01 && M(0, 0) < Scalar(1e30) &&
         M(1, 1) < Scalar(1e30) && ellipse.gate >= 0 && ellipse.gate < Scalar(1e30) &&
         std::fabs(ellipse.centre.x()) < limit && std::fabs(ellipse.centre.y()) < limit;
}

/// Highest local maximum further than kSearchApart from the best.
float second_peak(const ScoreMap& map, int best_x, int best_y) {
  int second = -32768;
  for (int j = 0; j < map.rows; ++j) {
    const Span& span = map.span[j];
    const int y = map.top + j;
    for (int x = span.begin; x < span.end; ++x) {
      const int s = map.score[span.at + x - span.begin];
      if (s <= second) continue;
      const float distance2 = static_cast<float>((x - best_x) * (x - best_x) + (y - best_y) * (y - best_y));
      if (distance2 <= kSearchApart * kSearchApart) continue;
      const bool is_peak = map.at(x - 1, y - 1) <= s && map.at(x, y - 1) <= s && map.at(x + 1, y - 1) <= s &&
                           map.at(x - 1, y) <= s && map.at(x + 1, y) <= s && map.at(x - 1, y + 1) <= s &&
                           map.at(x, y + 1) <= s && map.at(x + 1, y + 1) <= s;
      if (is_peak) second = s;
    }
  }
  return second == -32768 ? -1.0f : static_cast<float>(second) / kScoreUnit;
}

}  // namespace

void make_search_template(const float* warped, int size, SearchTemplate* out) {
  PF_ASSERT(size >= 9 && size % 2 == 1);
  const int first = size / 2 - SearchTemplate::kBefore;
  int sum = 0;
  int square = 0;
  for (int j = 0; j < SearchTemplate::kSize; ++j) {
    for (int i = 0; i < SearchTemplate::kSize; ++i) {
      const float grey = warped[(first + j) * size + first + i];
      const int value = grey > 0.0f ? (grey < 255.0f ? static_cast<int>(grey + 0.5f) : 255) : 0;
      out->pixels[j * SearchTemplate::kSize + i] = static_cast<std::uint8_t>(value);
      sum += value;
      square += value * value;
    }
  }
  out->sum = sum;
  out->energy = 64 * square - sum * sum;
}

SearchResult search(const ImageView& image, const SearchTemplate& pattern, const SearchEllipse& ellipse) {
  SearchResult result;
  if (!is_usable(ellipse) || pattern.energy <= 0) return result;
  const int cx = static_cast<int>(std::floor(ellipse.centre.x() + Scalar(0.5)));
  const int cy = static_cast<int>(std::floor(ellipse.centre.y() + Scalar(0.5)));
  const auto larger = [](int a, int b) { return a > b ? a : b; };
  const auto smaller = [](int a, int b) { return a < b ? a : b; };
  const int left = larger(cx - kSearchReach, SearchTemplate::kBefore);
  const int right = smaller(cx + kSearchReach, image.width - 1 - SearchTemplate::kAfter);
  const int top = larger(cy - kSearchReach, SearchTemplate::kBefore);
  const int bottom = smaller(cy + kSearchReach, image.height - 1 - SearchTemplate::kAfter);
  if (left > right || top > bottom) return result;

  ScoreMap map;
  int best_x = 0;
  int best_y = 0;
  float best = -2.0f;
  const auto visit_row = [&](int y, const Span& span) {
    float score[kSide];
    const int count = span.end - span.begin;
    score_row(image.pixel(span.begin - SearchTemplate::kBefore, y - SearchTemplate::kBefore), image.stride, count,
              pattern, score);
    for (int k = 0; k < count; ++k) {
      map.score[result.visited + k] = static_cast<std::int16_t>(score[k] * kScoreUnit);
    }
    for (int k = 0; k < count; ++k) {
      if (score[k] > best) {
        best = score[k];
        best_x = span.begin + k;
        best_y = y;
      }
    }
    map.span[map.rows++] = Span{span.begin, span.end, result.visited};
    result.visited += count;
  };
  for (int y = top; y <= bottom; ++y) {
    Span span;
    if (cut_row(ellipse, y, left, right, &span)) {
      if (map.rows == 0) map.top = y;
      visit_row(y, span);
    } else if (map.rows > 0) {
      // A row between two that are cut may hold no whole pixel where the ellipse is a sliver.
      map.span[map.rows++] = Span{0, 0, result.visited};
    }
  }
  if (result.visited == 0) {
    if (cx < left || cx > right || cy < top || cy > bottom) return result;
    map.rows = 0;
    map.top = cy;
    visit_row(cy, Span{cx, cx + 1, 0});
  }
  result.position = Vec2(static_cast<Scalar>(best_x), static_cast<Scalar>(best_y));
  result.score = best;
  result.second = second_peak(map, best_x, best_y);
  return result;
}

}  // namespace pf
