#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "context.h"
#include "film.h"
#include "planefold/planefold.h"

namespace pfsim {

/// What is shown while the camera does not see what it should.
enum class GapPicture : std::int32_t { kBlack, kElsewhere };

/// What it sees after that: the film goes on after as many frames as the gap has replaced; it runs backwards from where it stopped; it
/// goes on half of the film away.
enum class Return : std::int32_t { kOn, kBack, kElsewhere };

struct GapCase {
  double seconds;
  GapPicture picture;
  Return then;
};

/// All that is tried at one frame.
const std::vector<GapCase>& gap_cases();

struct KidnapOptions {
  pf_config_t config;
  bool has_target = false;
  pf_target_t target;
  int every = 8;            ///< frames between the frames at which trials begin
  double follow_s = 1.5;    ///< after the gap
  double survive_s = 10;    ///< without a picture, after which ids are counted
  int random_frames = 700;  ///< in one run in random order
  int random_runs = 4;
  std::uint64_t seed = 1;
};

/// The film without a gap: the truth of the trials.
struct Reference {
  struct Frame {
    bool tracked = false;
    bool is_truth = false;  ///< known well enough to call another pose wrong
    pf_pose_t pose{};
    double depth = 0;                     ///< median, along the axis, of what was measured
    std::vector<std::uint32_t> measured;  ///< ids of the features that were inliers
  };
  struct Start {
    int frame;
    std::vector<unsigned char> block;
    std::vector<pf_feature_t> map;
  };
  std::vector<Frame> frames;
  std::vector<Start> starts;
};

/// One gap. Plain data, so that it may lie in memory shared between processes.
struct Trial {
  std::int32_t done = 0;
  std::int32_t old_in_view = 0;     ///< features of the old map that the truth has in the first picture after the gap
  std::int32_t old_measured = 0;    ///< of them, those that the run without a gap measures in that picture
  std::int32_t tracked_after = -1;  ///< frames after the gap until the state is tracking in the old map; -1: never
  std::int32_t judged = 0;          ///< frames in state tracking, in the old map, where the truth is known
  double worst_normalised = 0;      ///< of them: e^T (P + P_truth)^-1 e, 6 dof
  double worst_deg = 0, worst_depths = 0;  ///< of them: rotation; position over the median depth
  std::int32_t worst_frame = -1;           ///< of the film, where the rotation is worst
  double wrong_normalised = 0;  ///< largest normalised error of the frames that are wrong by 5 degrees or 10 % of depth
  double least_growth = 1;      ///< least ratio of successive standard deviations of the pose while coasting or lost
  double least_taken_in = 1;    ///< least ratio to the smaller of that and of the prediction
  std::int32_t old_ids = 0, kept_ids = 0;  ///< of the map when the gap began, and of them at the end of the trial
};

struct Survival {
  std::int32_t done = 0, old_ids = 0, kept_ids = 0;
};

struct RandomOrder {
  std::int32_t frames = 0, tracking = 0, in_map = 0;  ///< in_map: tracking in the map of the beginning
  std::int32_t judged = 0;                            ///< of those in the old map where the truth is known
  std::int32_t right = 0;      ///< of those right: within 5 degrees and 10 % of depth of the truth
  std::int32_t confident = 0;  ///< of those that are wrong: by more than five of their own standard deviations
  static constexpr int kMaxWrong = 100;
  struct Wrong {
    std::int32_t at = 0, frame = 0;  ///< shown so many frames after the beginning, and its number in the film
    double deg = 0, depths = 0, normalised = 0, log_odds = 0;
  } wrong[kMaxWrong];  ///< the first of those that are wrong
  std::int32_t turns = 0,
               turns_wrong = 0;  ///< from a tracked frame to the next one in the same map; wrong by over 5 degrees
};

bool is_wrong(double deg, double depths);
/// Normalised error of a pose, squared, that five standard deviations of one normal variable correspond to.
double five_sigma_bound();
/// A tracked frame was wrong, and by more than five of its own standard deviations.
bool is_wrong_and_confident(const Trial& t);

/// Plays the film once and keeps the context where trials begin.
bool play_reference(const Film& film, const KidnapOptions& options, Context& context, Reference* reference);

/// All cases at one start; trials has as many entries as gap_cases(). Those that the film is too short for are not done.
void play_trials(const Film& film, const KidnapOptions& options, const Reference& reference, int start,
                 Context& context, Trial* trials, Survival* survival);

/// Frames in random order after a start of the reference.
RandomOrder play_random(const Film& film, const KidnapOptions& options, const Reference& reference, int start,
                        std::uint64_t seed, Context& context);

}  // namespace pfsim
