#include "vision/search.h"

#include <cmath>

#include "vision/search_kernels.h"
#include "vision/simd.h"

namespace pf {

namespace {

constexpr int kSide = 2 * kSearchReach + 1;
constexpr int kRow = (kSide + 3) / 4 * 4;  // rows of scores are worked on in fours
constexpr float kScoreUnit = 32000.0f;
constexpr float kNone = -2.0f;

/// Columns begin .. end - 1 of one row of the ellipse. Empty: both zero.
struct Span {
  int begin;
  int end;
};

/// Scores of all positions, in 1 / kScoreUnit; the row's first is at its span's begin.
struct ScoreMap {
  int top = 0;
  int rows = 0;
  Span span[kSide];
  float highest[kSide];
  std::int16_t score[kSide * kRow];

  int at(int x, int y) const {
    const int j = y - top;
    if (j < 0 || j >= rows || x < span[j].begin || x >= span[j].end) return -32768;
    return score[j * kRow + x - span[j].begin];
  }
};

float score_of(std::uint32_t sum, std::uint32_t square, std::uint32_t dot, const SearchTemplate& pattern) {
  const int over = static_cast<int>(64u * dot) - static_cast<int>(sum) * pattern.sum;
  const int under = static_cast<int>(64u * square - sum * sum);
  // Without contrast both are zero; 1 keeps the quotient finite.
  const float scale = static_cast<float>(under > 1 ? under : 1) * static_cast<float>(pattern.energy);
  return static_cast<float>(over) / std::sqrt(scale);
}

/// The twin of score_of for a row, and the row's highest. The arrays have room up to the next multiple of four, where
/// anything may stand.
float score_row(const std::uint16_t* sum, const std::uint32_t* square, const std::uint32_t* dot, int count,
                const SearchTemplate& pattern, float* score, std::int16_t* quantised) {
  const U32x4 pattern_sum = U32x4{} + static_cast<std::uint32_t>(pattern.sum);
  const float energy = static_cast<float>(pattern.energy);
  F32x4 highest = F32x4{} + kNone;
  for (int k = 0; k < count; k += 4) {
    const U32x4 s = __builtin_convertvector(load<U16x4>(sum + k), U32x4);
    const I32x4 over = (I32x4)((load<U32x4>(dot + k) << 6) - multiply_small(s, pattern_sum));
    const I32x4 under = (I32x4)((load<U32x4>(square + k) << 6) - multiply_small(s, s));
    const F32x4 scale = larger(__builtin_convertvector(under, F32x4), F32x4{} + 1.0f) * energy;
    const F32x4 value = __builtin_convertvector(over, F32x4) / square_root(scale);
    store(score + k, value);
    store(quantised + k, __builtin_convertvector(__builtin_convertvector(value * kScoreUnit, I32x4), I16x4));
    if (k + 4 <= count) {
      highest = larger(highest, value);
    } else {
      for (int i = 0; i < count - k; ++i) highest[i] = highest[i] > value[i] ? highest[i] : value[i];
    }
  }
  const float a = highest[0] > highest[1] ? highest[0] : highest[1];
  const float b = highest[2] > highest[3] ? highest[2] : highest[3];
  return a > b ? a : b;
}

/// Largest whole number not above, for numbers that fit an int.
int floor_int(Scalar value) {
  const int whole = static_cast<int>(value);
  return whole - (static_cast<Scalar>(whole) > value ? 1 : 0);
}

/// The ellipse as rows are cut from it: at dy from its centre it is slope dy ± √(room - shrink dy²) wide.
struct Cutter {
  explicit Cutter(const SearchEllipse& ellipse) : centre_x(ellipse.centre.x()), centre_y(ellipse.centre.y()) {
    const Mat2& M = ellipse.inverse_covariance;
    const Scalar m01 = (M(0, 1) + M(1, 0)) / 2;
    const Scalar det = M(0, 0) * M(1, 1) - m01 * m01;
    slope = -m01 / M(0, 0);
    room = ellipse.gate / M(0, 0);
    shrink = det / (M(0, 0) * M(0, 0));
    height = std::sqrt(ellipse.gate * M(0, 0) / det);
  }

  /// Columns of row y, cut to low .. high. False when there is none.
  bool cut(int y, int low, int high, Span* span) const {
    const Scalar dy = static_cast<Scalar>(y) - centre_y;
    const Scalar inside = room - shrink * dy * dy;
    if (!(inside >= 0)) return false;
    const Scalar half = std::sqrt(inside);
    const Scalar begin = centre_x + slope * dy - half;
    const Scalar end = centre_x + slope * dy + half;
    if (!(begin <= static_cast<Scalar>(high) && end >= static_cast<Scalar>(low))) return false;
    span->begin = begin > static_cast<Scalar>(low) ? -floor_int(-begin) : low;
    span->end = (end < static_cast<Scalar>(high) ? floor_int(end) : high) + 1;
    return span->begin < span->end;
  }

  Scalar centre_x, centre_y, slope, room, shrink, height;
};

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
    if (map.highest[j] * kScoreUnit <= static_cast<float>(second)) continue;
    const int y = map.top + j;
    const std::int16_t* score = map.score + j * kRow;
    for (int x = span.begin; x < span.end; ++x) {
      const int s = score[x - span.begin];
      if (s <= second) continue;
      const int distance2 = (x - best_x) * (x - best_x) + (y - best_y) * (y - best_y);
      if (static_cast<float>(distance2) <= kSearchApart * kSearchApart) continue;
      const bool is_peak = map.at(x - 1, y) <= s && map.at(x + 1, y) <= s && map.at(x, y - 1) <= s &&
                           map.at(x, y + 1) <= s && map.at(x - 1, y - 1) <= s && map.at(x + 1, y - 1) <= s &&
                           map.at(x - 1, y + 1) <= s && map.at(x + 1, y + 1) <= s;
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

float correlation_reference(const ImageView& image, const SearchTemplate& pattern, int x, int y) {
  std::uint32_t sum = 0;
  std::uint32_t square = 0;
  std::uint32_t dot = 0;
  for (int j = 0; j < SearchTemplate::kSize; ++j) {
    for (int i = 0; i < SearchTemplate::kSize; ++i) {
      const int grey = image.at(x - SearchTemplate::kBefore + i, y - SearchTemplate::kBefore + j);
      sum += static_cast<std::uint32_t>(grey);
      square += static_cast<std::uint32_t>(grey * grey);
      dot += static_cast<std::uint32_t>(grey * pattern.pixels[j * SearchTemplate::kSize + i]);
    }
  }
  return score_of(sum, square, dot, pattern);
}

namespace {

/// The rows of the ellipse, cut to the image and to kSearchReach. Returns the number of positions.
int cut_ellipse(const ImageView& image, const SearchEllipse& ellipse, ScoreMap* map) {
  const int cx = static_cast<int>(std::floor(ellipse.centre.x() + Scalar(0.5)));
  const int cy = static_cast<int>(std::floor(ellipse.centre.y() + Scalar(0.5)));
  const auto larger = [](int a, int b) { return a > b ? a : b; };
  const auto smaller = [](int a, int b) { return a < b ? a : b; };
  const int left = larger(cx - kSearchReach, SearchTemplate::kBefore);
  const int right = smaller(cx + kSearchReach, image.width - 1 - SearchTemplate::kAfter);
  const int top = larger(cy - kSearchReach, SearchTemplate::kBefore);
  const int bottom = smaller(cy + kSearchReach, image.height - 1 - SearchTemplate::kAfter);
  if (left > right || top > bottom) return 0;
  const Cutter cutter(ellipse);
  // One row more on each side, for rounding; NaN and what is too large fail the comparison.
  const int reach = cutter.height < kSearchReach ? static_cast<int>(cutter.height) + 2 : kSearchReach;
  const int last = smaller(bottom, cy + reach);
  int visited = 0;
  for (int y = larger(top, cy - reach); y <= last; ++y) {
    Span span;
    const bool found = cutter.cut(y, left, right, &span);
    if (!found && map->rows == 0) continue;
    if (map->rows == 0) map->top = y;
    // Where the ellipse is a sliver, a row between others may hold no whole pixel.
    map->span[map->rows++] = found ? span : Span{0, 0};
    visited += found ? span.end - span.begin : 0;
  }
  while (map->rows > 0 && map->span[map->rows - 1].end == 0) --map->rows;
  if (visited == 0 && cx >= left && cx <= right && cy >= top && cy <= bottom) {
    map->top = cy;
    map->rows = 1;
    map->span[0] = Span{cx, cx + 1};
    visited = 1;
  }
  return visited;
}

}  // namespace

SearchResult search(const ImageView& image, const SearchTemplate& pattern, const SearchEllipse& ellipse) {
  SearchResult result;
  if (!is_usable(ellipse) || pattern.energy <= 0) return result;
  ScoreMap map;
  result.visited = cut_ellipse(image, ellipse, &map);
  if (result.visited == 0) return result;

  constexpr int kBefore = SearchTemplate::kBefore;
  int left = image.width;
  int right = 0;
  for (int j = 0; j < map.rows; ++j) {
    const Span& span = map.span[j];
    if (span.begin == span.end) continue;
    if (span.begin < left) left = span.begin;
    if (span.end > right) right = span.end;
  }
  // Whole vectors where the image's row goes on for as long.
  const int columns = right - left + SearchTemplate::kSize - 1;
  const int whole = (columns + 7) / 8 * 8;
  const bool fits = left - kBefore + whole <= image.width;
  ColumnSums moments;
  moments.begin(image.pixel(left - kBefore, map.top - kBefore), image.stride, fits ? whole : columns);

  result.score = kNone;
  int best_x = 0;
  int best_y = 0;
  for (int j = 0; j < map.rows; ++j) {
    if (j > 0) moments.move_down();
    const Span& span = map.span[j];
    const int count = span.end - span.begin;
    map.highest[j] = kNone;
    if (count == 0) continue;
    const int y = map.top + j;
    const int fours = (count + 3) & ~3;
    const bool row_fits = span.begin - kBefore + fours + SearchTemplate::kSize - 1 <= image.width;
    std::uint16_t sum[kRow + 8];
    std::uint32_t square[kRow + 8];
    std::uint32_t dot[kRow];
    float score[kRow];
    window_dots(image.pixel(span.begin - kBefore, y - kBefore), image.stride, row_fits ? fours : count, pattern, dot);
    for (int k = row_fits ? fours : count; k < fours; ++k) dot[k] = 0;
    moments.windows(span.begin - left, count, sum, square);
    map.highest[j] = score_row(sum, square, dot, count, pattern, score, map.score + j * kRow);
    if (map.highest[j] <= result.score) continue;
    result.score = map.highest[j];
    int k = 0;
    while (score[k] != result.score) ++k;
    best_x = span.begin + k;
    best_y = y;
  }
  result.position = Vec2(static_cast<Scalar>(best_x), static_cast<Scalar>(best_y));
  result.second = second_peak(map, best_x, best_y);
  return result;
}

}  // namespace pf
