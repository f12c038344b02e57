#include "vision/corners.h"

#include <cstring>

#include "vision/min_eigenvalue.h"
#include "vision/segment_test.h"

namespace pf {

bool CornerWorkspace::layout(Arena& arena, int image_width) {
  if (image_width <= 0) return false;
  width = image_width;
  for (int k = 0; k < 3; ++k) {
    score[k] = arena.take<float>(static_cast<std::size_t>(image_width) + 2);
    candidate[k] = arena.take<std::uint16_t>(static_cast<std::size_t>(image_width));
  }
  return true;
}

namespace {

/// Keeps the best `capacity` corners: a heap with the worst on top.
class BestCorners {
 public:
  BestCorners(Corner* out, int capacity) : heap_(out), capacity_(capacity) {}

  void add(const Corner& corner) {
    if (count_ < capacity_) {
      int child = count_++;
      while (child > 0 && corner.score < heap_[(child - 1) / 2].score) {
        heap_[child] = heap_[(child - 1) / 2];
        child = (child - 1) / 2;
      }
      heap_[child] = corner;
    } else if (capacity_ > 0 && corner.score > heap_[0].score) {
      sink(corner, count_);
    }
  }

  /// Best first.
  int finish() {
    for (int end = count_ - 1; end > 0; --end) {
      const Corner last = heap_[end];
      heap_[end] = heap_[0];
      sink(last, end);
    }
    return count_;
  }

 private:
  void sink(const Corner& corner, int count) {
    int parent = 0;
    for (int child = 1; child < count; child = 2 * parent + 1) {
      if (child + 1 < count && heap_[child + 1].score < heap_[child].score) ++child;
      if (corner.score <= heap_[child].score) break;
      heap_[parent] = heap_[child];
      parent = child;
    }
    heap_[parent] = corner;
  }

  Corner* heap_;
  int capacity_;
  int count_ = 0;
};

/// Greater than its later neighbours and not less than its earlier ones, so that exactly one of two equal ones is kept.
bool is_peak(const float* above, const float* here, const float* below, int i) {
  const float s = here[i];
  return s >= above[i - 1] && s >= above[i] && s >= above[i + 1] && s >= here[i - 1] && s > here[i + 1] &&
         s > below[i - 1] && s > below[i] && s > below[i + 1];
}

}  // namespace

int detect_corners(const ImageView& image, const Rect& roi, int threshold, Corner* out, int capacity,
                   const CornerWorkspace& workspace, const ImageMask* mask) {
  mask = in_use(mask);
  const Rect r = clip(roi, image, kCornerBorder);
  if (r.empty() || capacity <= 0 || r.width > workspace.width) return 0;
  const int t = threshold < 1 ? 1 : threshold > 254 ? 254 : threshold;
  BestCorners best(out, capacity);

  // Rows live in a ring of three; column i of the rectangle is entry i + 1. A row that leaves is cleared by its own list.
  int count[3] = {0, 0, 0};
  for (int k = 0; k < 3; ++k) {
    std::memset(workspace.score[k], 0, static_cast<std::size_t>(r.width + 2) * sizeof(float));
  }
  for (int y = 0; y <= r.height; ++y) {
    const int below = y % 3;
    const int here = (y + 2) % 3;
    const int above = (y + 1) % 3;
    float* score = workspace.score[below];
    std::uint16_t* list = workspace.candidate[below];
    for (int k = 0; k < count[below]; ++k) score[list[k] + 1] = 0.0f;
    count[below] = 0;
    if (y < r.height) {
      const std::uint8_t* centre = image.pixel(r.x, r.y + y);
      count[below] = segment_test_row(centre, image.stride, r.width, t, list);
      for (int k = 0; k < count[below]; ++k) {
        score[list[k] + 1] = min_eigenvalue_at(centre + list[k], image.stride);
      }
    }
    for (int k = 0; k < count[here]; ++k) {
      const int i = workspace.candidate[here][k] + 1;
      if (!is_peak(workspace.score[above], workspace.score[here], score, i)) continue;
      const Vec2 place(static_cast<Scalar>(r.x + i - 1), static_cast<Scalar>(r.y + y - 1));
      if (mask != nullptr && !mask->is_clear(place, kMaskMargin)) continue;
      best.add(Corner{static_cast<float>(r.x + i - 1), static_cast<float>(r.y + y - 1), workspace.score[here][i]});
    }
  }
  return best.finish();
}

}  // namespace pf
