#include "kidnap_run.h"

#include <algorithm>
#include <cmath>

#include "pose_difference.h"
#include "sim/random.h"
#include "statistics.h"

namespace pfsim {
namespace {

using pf::sim::Vec3;

constexpr double kWrongDeg = 5, kWrongDepths = 0.1;
constexpr double kFiveSigma = 5.733e-7;  // probability that a normal variable lies beyond five standard deviations
constexpr double kDegrees = 57.29577951308232;  // in a radian
constexpr double kTruthShare =
    0.2;  // of these bounds, that the reference's own sigmas may reach where it serves as truth
constexpr std::uint64_t kOrderStream = 31;

Vec3 vector_of(const double p[3]) { return {p[0], p[1], p[2]}; }

std::vector<pf_feature_t> map_of(const Context& context) {
  std::size_t count = 0;
  pf_get_features(context.slam, nullptr, 0, &count);
  std::vector<pf_feature_t> map(count);
  if (count > 0) pf_get_features(context.slam, map.data(), map.size(), &count);
  return map;
}

/// Ids of the features that were inliers in the last frame.
std::vector<std::uint32_t> measured_in(const Context& context) {
  std::size_t count = 0;
  pf_get_matches(context.slam, nullptr, 0, &count);
  std::vector<pf_match_t> tracks(count);
  if (count > 0) pf_get_matches(context.slam, tracks.data(), tracks.size(), &count);
  std::vector<std::uint32_t> ids;
  for (const pf_match_t& track : tracks)
    if (track.status == PF_MATCH_INLIER) ids.push_back(track.id);
  return ids;
}

int count_measured(const std::vector<pf_feature_t>& map, const std::vector<std::uint32_t>& measured) {
  return static_cast<int>(std::count_if(map.begin(), map.end(), [&](const pf_feature_t& f) {
    return std::find(measured.begin(), measured.end(), f.id) != measured.end();
  }));
}

/// Median depth of what was measured in the last frame; 0 where nothing was.
double median_depth(const Context& context, const Reference::Frame& frame) {
  const std::vector<pf_feature_t> map = map_of(context);
  const pf::sim::Mat3 R_CW = pf::sim::rotation_of(frame.pose.q_WC).transposed();
  std::vector<double> depths;
  for (const std::uint32_t id : frame.measured)
    for (const pf_feature_t& f : map)
      if (f.id == id) depths.push_back((R_CW * (vector_of(f.p_W) - vector_of(frame.pose.p_WC))).z);
  return depths.empty() ? 0 : median(depths);
}

/// Whether the reference knows this pose well enough to call another one wrong.
bool is_truth(const Reference::Frame& frame) {
  double rotation = 0, position = 0;
  for (int i = 0; i < 3; ++i) {
    rotation += frame.pose.covariance[7 * i];
    position += frame.pose.covariance[7 * (3 + i)];
  }
  return std::sqrt(rotation) * kDegrees < kTruthShare * kWrongDeg &&
         std::sqrt(position) < kTruthShare * kWrongDepths * frame.depth;
}

struct PoseError {
  double normalised, deg, depths;
};

PoseError compare(const pf_pose_t& pose, const Reference::Frame& truth) {
  double P[36];
  for (int i = 0; i < 36; ++i) P[i] = pose.covariance[i] + truth.pose.covariance[i];
  const PoseDifference off = pose_difference(pose, truth.pose);
  const double normalised = normalised_error(off.e, P, 6, 6, 0);
  return {normalised < 0 ? 1e12 : normalised, off.rad * kDegrees, off.m / std::max(truth.depth, 1e-9)};
}

/// A context that is shown pictures at the film's rate, and what came of it.
class Player {
 public:
  Player(const Film& film, const Reference& reference, Context& context, std::int64_t t_ns)
      : film_(film), reference_(reference), context_(context), t_ns_(t_ns) {
    begin();
  }

  /// What is counted from now on goes there.
  void begin(Trial* trial = nullptr) {
    trial_ = trial;
    if (pf_get_pose(context_.slam, &last_) != PF_OK) last_ = {};
  }
  /// Poses count in the map of now only: another one has a world of its own.
  void stay_in_map() { map_id_ = last_.map_id; }
  std::int64_t t_ns() const { return t_ns_; }
  void set_time(std::int64_t t_ns) { t_ns_ = t_ns; }

  /// Shows a frame of the film, or black. True when the state is tracking.
  bool show(int frame) {
    t_ns_ += film_.interval_ns();
    const pf_camera_t& camera = film_.camera();
    const pf_image_t image = {film_.pixels(frame), camera.width, camera.height, camera.width, t_ns_};
    pf_pose_t predicted;
    if (pf_predict_pose(context_.slam, t_ns_, &predicted) != PF_OK) predicted = last_;
    const pf_status_t status = pf_push_frame(context_.slam, &image);
    pf_pose_t pose;
    if (pf_get_pose(context_.slam, &pose) != PF_OK) return false;
    const bool tracking = status == PF_OK && pose.map_id == map_id_;
    if (trial_ != nullptr) {
      if (tracking && frame >= 0) judge(pose, frame);
      if (status != PF_OK && pose.map_id == map_id_) {
        const double against_last = growth(last_, pose);
        trial_->least_growth = std::min(trial_->least_growth, against_last);
        trial_->least_taken_in = std::min(trial_->least_taken_in, std::max(against_last, growth(predicted, pose)));
      }
    }
    last_ = pose;
    return tracking;
  }

 private:
  void judge(const pf_pose_t& pose, int frame) {
    const Reference::Frame& truth = reference_.frames[static_cast<std::size_t>(frame)];
    if (!truth.is_truth) return;
    const PoseError error = compare(pose, truth);
    ++trial_->judged;
    trial_->worst_normalised = std::max(trial_->worst_normalised, error.normalised);
    if (error.deg > trial_->worst_deg) trial_->worst_frame = frame;
    trial_->worst_deg = std::max(trial_->worst_deg, error.deg);
    trial_->worst_depths = std::max(trial_->worst_depths, error.depths);
    if (is_wrong(error.deg, error.depths))
      trial_->wrong_normalised = std::max(trial_->wrong_normalised, error.normalised);
  }

  /// The smaller ratio of the sigmas of rotation and position, or 1.
  static double growth(const pf_pose_t& from, const pf_pose_t& to) {
    double least = 1;
    for (int first = 0; first < 6; first += 3) {
      double before = 0, now = 0;
      for (int i = first; i < first + 3; ++i) {
        before += from.covariance[7 * i];
        now += to.covariance[7 * i];
      }
      if (before > 0) least = std::min(least, std::sqrt(now / before));
    }
    return least;
  }

  const Film& film_;
  const Reference& reference_;
  Context& context_;
  std::int64_t t_ns_;
  Trial* trial_ = nullptr;
  pf_pose_t last_{};
  std::uint32_t map_id_ = 0;
};

struct Shown {
  pf_pose_t pose;
  int frame;
};

/// The turn between two frames of one map needs neither its scale nor its place.
void count_turn(const Reference& reference, const Shown& from, const Shown& to, RandomOrder* result) {
  const Reference::Frame& a = reference.frames[static_cast<std::size_t>(from.frame)];
  const Reference::Frame& b = reference.frames[static_cast<std::size_t>(to.frame)];
  if (!a.tracked || !b.tracked) return;
  const auto turn = [](const pf_pose_t& p, const pf_pose_t& q) {
    return pf::sim::rotation_of(p.q_WC).transposed() * pf::sim::rotation_of(q.q_WC);
  };
  const double off = pf::sim::rotation_log(turn(a.pose, b.pose).transposed() * turn(from.pose, to.pose)).norm();
  ++result->turns;
  result->turns_wrong += off * kDegrees > kWrongDeg;
}

int count_in_view(const Film& film, const KidnapOptions& options, const std::vector<pf_feature_t>& map,
                  const pf_pose_t& pose) {
  const pf_camera_t& camera = film.camera();
  const pf::sim::Mat3 R_CW = pf::sim::rotation_of(pose.q_WC).transposed();
  const double border = options.config.map.border_px;
  int count = 0;
  for (const pf_feature_t& f : map) {
    const Vec3 p = R_CW * (vector_of(f.p_W) - vector_of(pose.p_WC));
    const double p_C[3] = {p.x, p.y, p.z};
    double pixel[2];
    if (p.z <= 0 || pf_camera_project(&camera, p_C, pixel) != PF_OK) continue;
    count += pixel[0] >= border && pixel[1] >= border && pixel[0] <= camera.width - 1 - border &&
             pixel[1] <= camera.height - 1 - border;
  }
  return count;
}

int count_kept(const Context& context, const std::vector<pf_feature_t>& old) {
  const std::vector<pf_feature_t> now = map_of(context);
  int kept = 0;
  for (const pf_feature_t& f : old)
    kept += std::any_of(now.begin(), now.end(), [&](const pf_feature_t& g) { return g.id == f.id; });
  return kept;
}

int frames_in(double seconds, const Film& film) {
  return static_cast<int>(std::lround(seconds * 1e9 / static_cast<double>(film.interval_ns())));
}

/// Frames of the film that are shown after a gap of so many frames.
std::vector<int> shown_after(const Film& film, int start, int gap, Return then, int count) {
  std::vector<int> shown;
  const int n = film.frames();
  for (int k = 0; k < count; ++k) {
    const int frame = then == Return::kOn     ? start + 1 + gap + k
                      : then == Return::kBack ? start - k
                                              : (start + n / 2) % n + k;
    if (frame < 0 || frame >= n) break;
    shown.push_back(frame);
  }
  return shown;
}

}  // namespace

double five_sigma_bound() {
  static const double bound = chi_square_quantile(1 - kFiveSigma, 6);
  return bound;
}

bool is_wrong_and_confident(const Trial& t) { return t.wrong_normalised > five_sigma_bound(); }

bool is_wrong(double deg, double depths) { return deg > kWrongDeg || depths > kWrongDepths; }

const std::vector<GapCase>& gap_cases() {
  static const std::vector<GapCase> cases = [] {
    std::vector<GapCase> all;
    for (const double seconds : {0.3, 1.0, 2.0, 3.0}) {
      for (const Return then : {Return::kOn, Return::kBack, Return::kElsewhere})
        all.push_back({seconds, GapPicture::kBlack, then});
    }
    for (const double seconds : {0.3, 1.0, 2.0, 3.0}) all.push_back({seconds, GapPicture::kElsewhere, Return::kBack});
    return all;
  }();
  return cases;
}

bool play_reference(const Film& film, const KidnapOptions& options, Context& context, Reference* reference) {
  if (options.has_target && pf_start_from_target(context.slam, &options.target) != PF_OK) return false;
  for (int i = 0; i < film.frames(); ++i) {
    const pf_camera_t& camera = film.camera();
    const pf_image_t image = {film.pixels(i), camera.width, camera.height, camera.width, film.t_ns(i)};
    Reference::Frame frame;
    const pf_status_t status = pf_push_frame(context.slam, &image);
    frame.tracked = status == PF_OK && pf_get_pose(context.slam, &frame.pose) == PF_OK;
    if (frame.tracked) {
      frame.measured = measured_in(context);
      frame.depth = median_depth(context, frame);
    }
    frame.tracked = frame.tracked && frame.depth > 0;
    frame.is_truth = frame.tracked && is_truth(frame);
    reference->frames.push_back(frame);
    if (i % options.every != 0 || !frame.tracked) continue;
    Reference::Start start;
    start.frame = i;
    context.save(&start.block);
    start.map = map_of(context);
    reference->starts.push_back(std::move(start));
  }
  return true;
}

void play_trials(const Film& film, const KidnapOptions& options, const Reference& reference, int start,
                 Context& context, Trial* trials, Survival* survival) {
  const Reference::Start& from = reference.starts[static_cast<std::size_t>(start)];
  const std::vector<GapCase>& cases = gap_cases();
  const int follow = frames_in(options.follow_s, film);
  Player player(film, reference, context, film.t_ns(from.frame));

  const auto play_one = [&](const GapCase& what, int gap, Trial* trial) {
    const std::vector<int> shown = shown_after(film, from.frame, gap, what.then, follow);
    if (static_cast<int>(shown.size()) < follow) return;
    trial->done = 1;
    trial->old_ids = static_cast<std::int32_t>(from.map.size());
    const Reference::Frame& first = reference.frames[static_cast<std::size_t>(shown[0])];
    if (first.tracked) trial->old_in_view = count_in_view(film, options, from.map, first.pose);
    if (first.tracked) trial->old_measured = count_measured(from.map, first.measured);
    for (int k = 0; k < follow; ++k)
      if (player.show(shown[static_cast<std::size_t>(k)]) && trial->tracked_after < 0) trial->tracked_after = k;
    trial->kept_ids = count_kept(context, from.map);
  };

  context.restore(from.block);
  player.begin();
  player.stay_in_map();
  // Black gaps of growing length share their beginning.
  context.restore(from.block);
  std::vector<unsigned char> dark = from.block;
  std::int64_t t_ns = film.t_ns(from.frame);
  int shown = 0;
  Trial in_the_dark;
  const auto wait_until = [&](int gap) {
    context.restore(dark);
    player.set_time(t_ns);
    player.begin(&in_the_dark);
    for (; shown < gap; ++shown) player.show(-1);
    context.save(&dark);
    t_ns = player.t_ns();
  };
  for (std::size_t c = 0; c < cases.size(); ++c) {
    if (cases[c].picture != GapPicture::kBlack) continue;
    const int gap = frames_in(cases[c].seconds, film);
    wait_until(gap);
    trials[c].least_growth = in_the_dark.least_growth;
    trials[c].least_taken_in = in_the_dark.least_taken_in;
    player.begin(&trials[c]);
    play_one(cases[c], gap, &trials[c]);
  }
  wait_until(frames_in(options.survive_s, film));
  survival->done = 1;
  survival->old_ids = static_cast<std::int32_t>(from.map.size());
  survival->kept_ids = count_kept(context, from.map);

  for (std::size_t c = 0; c < cases.size(); ++c) {
    if (cases[c].picture != GapPicture::kElsewhere) continue;
    const int gap = frames_in(cases[c].seconds, film);
    context.restore(from.block);
    player.set_time(film.t_ns(from.frame));
    player.begin(&trials[c]);
    const std::vector<int> elsewhere = shown_after(film, from.frame, 0, Return::kElsewhere, gap);
    if (static_cast<int>(elsewhere.size()) < gap) continue;
    for (const int frame : elsewhere) player.show(frame);
    play_one(cases[c], gap, &trials[c]);
  }
}

RandomOrder play_random(const Film& film, const KidnapOptions& options, const Reference& reference, int start,
                        std::uint64_t seed, Context& context) {
  const Reference::Start& from = reference.starts[static_cast<std::size_t>(start)];
  context.restore(from.block);
  Player player(film, reference, context, film.t_ns(from.frame));
  player.stay_in_map();
  pf::sim::Random random(seed, kOrderStream);
  RandomOrder result;
  pf_pose_t before{};
  int shown_before = -1;
  for (; result.frames < options.random_frames; ++result.frames) {
    Trial frame;
    player.begin(&frame);
    const int shown = random.below(film.frames());
    const bool in_map = player.show(shown);
    pf_state_t state;
    pf_get_state(context.slam, &state);
    result.tracking += state == PF_STATE_TRACKING;
    pf_pose_t pose;
    if (state == PF_STATE_TRACKING && pf_get_pose(context.slam, &pose) == PF_OK) {
      if (shown_before >= 0 && before.map_id == pose.map_id)
        count_turn(reference, {before, shown_before}, {pose, shown}, &result);
      before = pose;
      shown_before = shown;
    }
    result.in_map += in_map;
    result.judged += frame.judged;
    if (!in_map || frame.judged == 0) continue;
    if (!is_wrong(frame.worst_deg, frame.worst_depths)) {
      ++result.right;
      continue;
    }
    pf_report_t report;
    pf_get_report(context.slam, &report);
    const int wrong = result.judged - result.right - 1;
    if (wrong < RandomOrder::kMaxWrong)
      result.wrong[wrong] = {result.frames,          shown,          frame.worst_deg, frame.worst_depths,
                             frame.wrong_normalised, report.log_odds};
    result.confident += is_wrong_and_confident(frame);
  }
  return result;
}

}  // namespace pfsim
