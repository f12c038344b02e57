// pf-bench growth: update and frame time against the number of points that are mapped on the walls of a room, as 3-D points, folded,
// fixed as considered states, and fixed with their variance as noise.
#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdio>
#include <memory>

#include "covariance/select.h"
#include "filter/filter.h"
#include "suite.h"
#include "timing.h"

namespace bench {
namespace {

using pf::Mat3;
using pf::Scalar;
using pf::Vec3;

constexpr int kSeen = 10;  // features in one update: 20 rows
constexpr int kWalls = 4;

enum class Form { kPoints, kFolded, kConsidered, kInflated };
constexpr Form kForms[] = {Form::kPoints, Form::kFolded, Form::kConsidered, Form::kInflated};
constexpr const char* kNames[] = {"unfolded", "folded", "fixed, considered", "fixed, inflated"};

const pf::BodyLayout kLayout = pf::BodyLayout::with_constant_velocity();
constexpr int kBodyRows = 12;

/// A filter in the middle of a room of 4 m with its points spread evenly over four walls.
class Room {
 public:
  Room(int points, Form form, const pf::Kernels* kernels) : points_(points) {
    const pf::FilterCapacity capacity = {kBodyRows + 3 * points + 8 * kWalls, points, 20, kWalls};
    pf::Arena counting;
    pf::Filter none;
    none.layout(counting, capacity);
    memory_.resize(counting.used() + pf::Arena::kAlignment);
    const auto at = reinterpret_cast<std::uintptr_t>(memory_.data());
    pf::Arena arena(memory_.data() + (pf::Arena::kAlignment - at % pf::Arena::kAlignment) % pf::Arena::kAlignment,
                    counting.used());
    filter_.layout(arena, capacity);
    filter_.init(kernels, kLayout, true);
    Scalar covariance[kBodyRows * kBodyRows] = {};
    for (int i = 0; i < kBodyRows; ++i) covariance[i * (kBodyRows + 1)] = Scalar(1e-4);
    filter_.set_body(pf::Body(), covariance);
    const double intrinsics[4] = {190, 190, 159.5, 119.5}, none_distorted[8] = {};
    pf::make_camera(1, 320, 240, intrinsics, none_distorted, &camera_);
    place();
    if (form != Form::kPoints) fold();
    if (form == Form::kConsidered) fix(pf::FixForm::kConsider);
    if (form == Form::kInflated) fix(pf::FixForm::kInflate);
  }

  int rows() const { return filter_.dim(); }
  int held() const { return filter_.blocks().held_dim(); }

  void update() {
    filter_.begin_update(seen_, count_);
    filter_.finish_update(seen_, count_, nullptr, nullptr);
  }

  /// Motion, the pixel of every feature of the map, the ellipses of those in view, and the update.
  void frame() {
    pf::Transition transition;
    pf::Body still = filter_.state().body;
    still.v_W.setZero();
    still.w_C.setZero();
    pf::predict_constant_velocity(still, kLayout, Scalar(1) / 30, {Scalar(1), Scalar(2)}, &transition);
    filter_.predict(transition);
    look();
    update();
  }

  /// Observations that say what is expected.
  void look() {
    count_ = 0;
    for (const int slot : slots_) {
      pf::PixelMeasurement o;
      if (!filter_.predict_pixel(camera_, slot, &o)) continue;
      if (o.predicted.x() < 8 || o.predicted.y() < 8 || o.predicted.x() > 311 || o.predicted.y() > 231) continue;
      ellipses_ += filter_.innovation(o);
      if (count_ == kSeen) continue;
      o.measured = o.predicted;
      o.set_noise(pf::Mat2::Identity() + o.second_order);
      seen_[count_++] = o;
    }
  }

 private:
  void place() {
    const int per_wall = points_ / kWalls;
    const int columns = static_cast<int>(std::ceil(std::sqrt(per_wall * 2.0)));
    for (int i = 0; i < per_wall * kWalls; ++i) {
      const int wall = i / per_wall, k = i % per_wall;
      const double along = -1.8 + 3.6 * (k % columns + 0.5) / columns;
      const double height = -0.9 + 1.8 * (k / columns + 0.5) / (per_wall / columns + 1);
      const double angle = wall * 1.5707963267948966;
      const double x = along * std::cos(angle) + 2 * std::sin(angle),
                   z = -along * std::sin(angle) + 2 * std::cos(angle);
      const Vec3 p(static_cast<Scalar>(x), static_cast<Scalar>(height), static_cast<Scalar>(z));
      slots_.push_back(filter_.add_point(p, Mat3::Identity() * Scalar(1e-4)));
    }
  }

  void fold() {
    const int per_wall = points_ / kWalls;
    for (int wall = 0; wall < kWalls; ++wall) {
      const int* first = slots_.data() + wall * per_wall;
      std::vector<Vec3> places;
      for (int k = 0; k < per_wall; ++k) places.push_back(filter_.point(first[k]));
      pf::PlaneFit fit;
      if (!pf::fit_plane(places.data(), per_wall, Vec3::Zero(), &fit)) continue;
      const int plane = filter_.add_plane(fit, first, per_wall, Scalar(0.001));
      for (int k = 0; k < per_wall; k += pf::Filter::kMaxFolded) {
        unsigned char folded[pf::Filter::kMaxFolded];
        const int count = std::min(pf::Filter::kMaxFolded, per_wall - k);
        filter_.fold(plane, first + k, count, {Scalar(0.001), Scalar(1e9), false}, folded);
      }
    }
  }

  void fix(pf::FixForm form) {
    const int per_wall = points_ / kWalls;
    for (int wall = 0; wall < kWalls; ++wall) {
      const int* first = slots_.data() + wall * per_wall;
      // A patch begins with points all over the wall.
      int group[pf::Filter::kMaxFolded];
      const int group_count = std::min(pf::Filter::kMaxFolded, per_wall);
      for (int k = 0; k < group_count; ++k) group[k] = first[k * per_wall / group_count];
      for (int k = 0; k < per_wall; k += pf::Filter::kMaxFolded)
        filter_.fix(first + k, std::min(pf::Filter::kMaxFolded, per_wall - k), form, group, group_count);
    }
  }

  int points_;
  std::vector<std::uint8_t> memory_;
  pf::Filter filter_;
  pf::Camera camera_;
  std::vector<int> slots_;
  pf::PixelMeasurement seen_[kSeen];
  int count_ = 0;
  pf::Mat2 ellipses_ = pf::Mat2::Zero();  ///< their sum, so that none is left out by the compiler
};

/// Exponent of time against points, from a straight line through the logarithms.
double exponent(const std::vector<double>& points, const std::vector<double>& us) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const double n = static_cast<double>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = std::log(points[i]), y = std::log(us[i]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

int run(const SuiteOptions& options) {
  static const char* const sets[] = {"", "reference", "portable", "avx2", "avx512", "neon"};
  const pf::Kernels* kernels = nullptr;
  for (std::uint32_t id = 0; id < 6; ++id)
    if (options.kernels == sets[id]) kernels = pf::select_kernels(id);
  if (kernels == nullptr) {
    std::fprintf(stderr, "pf-bench: no kernel set '%s' on this processor; --help names them\n",
                 options.kernels.c_str());
    return 2;
  }
  Report report(options);
  report.note("kernels", pf::kernels_id(kernels) < 6 ? sets[pf::kernels_id(kernels)] : "");
  const int counts[] = {50, 100, 200, 400, 700, 1000};
  std::vector<double> points, update[4], frame[4];
  for (const int count : counts) {
    std::vector<std::unique_ptr<Room>> rooms;
    std::vector<Contender> contenders;
    for (const Form form : kForms) {
      rooms.push_back(std::make_unique<Room>(count / kWalls * kWalls, form, kernels));
      rooms.back()->look();
    }
    const auto nothing = [] {};
    for (auto& room : rooms) contenders.push_back({"", nothing, nothing, [&room] { room->update(); }});
    for (auto& room : rooms) contenders.push_back({"", nothing, nothing, [&room] { room->frame(); }});
    const std::vector<double> us = medians(contenders, std::max(3, options.repetitions / 3));
    points.push_back(count);
    for (std::size_t f = 0; f < 4; ++f) {
      update[f].push_back(us[f]);
      frame[f].push_back(us[4 + f]);
      Row row;
      row.suite = "growth";
      row.scalar = scalar_name();
      row.n = rooms[f]->rows();
      row.m = 2 * kSeen;
      const std::string name = std::to_string(count) + " points " + kNames[f];
      row.name = "update, " + name;
      row.us = us[f];
      row.peer = "unfolded";
      row.ratio = us[f] / us[0];
      report.add(row);
      row.name = "frame, " + name;
      row.us = us[4 + f];
      row.ratio = us[4 + f] / us[4];
      report.add(row);
    }
  }
  for (std::size_t f = 0; f < 4; ++f) {
    char text[80];
    std::snprintf(text, sizeof text, "update %.2f, frame %.2f", exponent(points, update[f]),
                  exponent(points, frame[f]));
    report.note(std::string("exponent, ") + kNames[f], text);
  }
  return report.finish();
}

const Suite suite("growth", "update and frame time against the number of points on walls, unfolded, folded and fixed",
                  run);

}  // namespace
}  // namespace bench
