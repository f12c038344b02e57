#include "template_run.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <set>

#include "context.h"
#include "pose_difference.h"
#include "statistics.h"
#include "template_truth.h"

namespace pfsim {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

struct CloseSim {
  void operator()(pf_sim_t* sim) const { pf_sim_close(sim); }
};

/// One context on its way through the frames.
struct Runner {
  Runner(const TemplateCase& one, const TemplateOptions& options, TemplateTruth* truth_)
      : context(one.config),
        truth(truth_),
        side(one.config.capacity.template_px),
        lost_error(options.lost_error),
        matches(1200),
        features(1000) {
    if (!options.templates.empty() && one.config.map.masks == PF_MASKS_PARTIAL) {
      templates.reset(std::fopen(options.templates.c_str(), "w"));
      if (templates) std::fputs("frame,id,side,region_side,grey,mask,region\n", templates.get());
    }
    if (options.table.empty()) return;
    table.reset(std::fopen((options.table + one.name + ".csv").c_str(), "w"));
    if (table) std::fputs("frame,true_x,true_y,true_z,x,y,z,inliers\n", table.get());
  }

  Context context;
  TemplateTruth* truth;
  int side;
  double lost_error;
  std::unique_ptr<std::FILE, CloseFile> table, templates;
  std::vector<pf_match_t> matches;
  std::vector<pf_feature_t> features;
  std::map<std::uint32_t, TemplateTruth::Patch> patches;
  std::set<std::uint32_t> straddling;
  std::map<std::uint32_t, int> lengths;  ///< frames in which a feature was an inlier

  void push(const pf_image_t& image, const pf_pose_t& pose, int judge_after, bool* looked, TemplateSums* sums) {
    ++sums->frames;
    const pf_status_t status = pf_push_frame(context.slam, &image);
    pf_pose_t estimate;
    bool has_pose = false;
    if (pf_get_pose(context.slam, &estimate) == PF_OK) {
      has_pose = true;
      const PoseDifference error = pose_difference(estimate, pose);
      sums->position2 += error.m * error.m;
      sums->rotation2 += error.rad * error.rad;
      if (error.m > lost_error) sums->lost = 1;
    }
    sums->tracked += status == PF_OK;
    pf_state_t state;
    if (pf_get_state(context.slam, &state) == PF_OK && state == PF_STATE_LOST) sums->lost = 1;
    const double inliers_before = sums->inliers;
    std::size_t count = 0;
    pf_get_matches(context.slam, matches.data(), matches.size(), &count);
    for (std::size_t k = 0; k < count && k < matches.size(); ++k) {
      const pf_match_t& match = matches[k];
      if (match.status == PF_MATCH_INLIER) {
        write_template(image, match, sums->frames - 1);
        ++lengths[match.id];
        sums->inliers += match.kind != PF_FEATURE_INVERSE_DEPTH;
      } else if (match.status == PF_MATCH_NEW) {
        if (!*looked) truth->look(pose);
        *looked = true;
        TemplateTruth::Patch patch = truth->cut(match.measured_px, side);
        sums->begun += 1;
        sums->straddling += patch.straddles;
        if (patch.straddles) {
          straddling.insert(match.id);
          patches[match.id] = std::move(patch);
        }
      }
    }
    if (table) {
      std::fprintf(table.get(), "%d,%.6f,%.6f,%.6f,", sums->frames - 1, pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]);
      if (has_pose)
        std::fprintf(table.get(), "%.6f,%.6f,%.6f,", estimate.p_WC[0], estimate.p_WC[1], estimate.p_WC[2]);
      else
        std::fputs(",,,", table.get());
      std::fprintf(table.get(), "%.0f\n", sums->inliers - inliers_before);
    }
    pf_report_t report;
    if (pf_get_report(context.slam, &report) == PF_OK && report.templates > 0) {
      sums->area += report.template_area;
      sums->area_frames += 1;
    }
    judge(pose, judge_after, looked, sums);
  }

  /// A straddling template with its mask, and the image about where it was found, in every fifth frame.
  void write_template(const pf_image_t& image, const pf_match_t& match, int frame) {
    constexpr int kEvery = 5, kReach = 20;
    pf_template_t found;
    if (!templates || frame % kEvery != 0 || straddling.count(match.id) == 0 ||
        pf_get_template(context.slam, match.id, &found) != PF_OK)
      return;
    std::FILE* const file = templates.get();
    std::fprintf(file, "%d,%u,%d,%d,", frame, match.id, found.side, 2 * kReach + 1);
    for (int i = 0; i < found.side * found.side; ++i) std::fprintf(file, "%02x", found.grey[i]);
    std::fputc(',', file);
    for (int i = 0; i < found.side * found.side; ++i) std::fprintf(file, "%02x", found.mask[i]);
    std::fputc(',', file);
    const int x = static_cast<int>(std::lround(match.measured_px[0])),
              y = static_cast<int>(std::lround(match.measured_px[1]));
    for (int v = y - kReach; v <= y + kReach; ++v)
      for (int u = x - kReach; u <= x + kReach; ++u) {
        const bool inside = u >= 0 && v >= 0 && u < image.width && v < image.height;
        std::fprintf(file, "%02x", inside ? image.pixels[v * image.stride + u] : 0);
      }
    std::fputc('\n', file);
  }

  /// Templates whose masks have learnt long enough, once each.
  void judge(const pf_pose_t& pose, int judge_after, bool* looked, TemplateSums* sums) {
    std::size_t count = 0;
    pf_get_features(context.slam, features.data(), features.size(), &count);
    for (std::size_t k = 0; k < count && k < features.size(); ++k) {
      const auto patch = patches.find(features[k].id);
      pf_template_t mask;
      if (patch == patches.end() || pf_get_template(context.slam, features[k].id, &mask) != PF_OK ||
          mask.frames < judge_after)
        continue;
      if (!*looked) truth->look(pose);
      *looked = true;
      const TemplateTruth::Agreement agreement = truth->judge(patch->second, mask, features[k].p_W);
      patches.erase(patch);
      if (agreement.pixels == 0) continue;
      sums->judged += 1;
      sums->mask += agreement.mask;
      sums->all_on += agreement.all_on;
      sums->surface += agreement.surface;
      sums->visible += agreement.visible;
    }
  }

  void finish(TemplateSums* sums) {
    std::vector<double> all;
    for (const auto& [id, frames] : lengths) {
      sums->tracks += 1;
      sums->track_frames += frames;
      all.push_back(frames);
    }
    sums->median_track = all.empty() ? 0 : median(all);
    // Coasting at the end is a loss that had no time to be called one.
    pf_state_t state;
    if (pf_get_state(context.slam, &state) != PF_OK || state != PF_STATE_TRACKING) sums->lost = 1;
    sums->done = 1;
  }
};

}  // namespace

void run_templates(const TemplateOptions& options, const std::vector<TemplateCase>& cases, std::uint64_t seed,
                   TemplateSums* sums) {
  pf_sim_options_t sim_options = options.sim;
  sim_options.seed = seed;
  const std::unique_ptr<pf_sim_t, CloseSim> sim(pf_sim_open(options.scene.c_str(), &sim_options));
  pf_target_t target;
  if (!sim || pf_sim_target(sim.get(), PF_TARGET_RECTANGLE, &target) != PF_OK) return;
  TemplateTruth truth(sim.get(), sim_options.camera);
  std::vector<std::unique_ptr<Runner>> runners;
  for (const TemplateCase& one : cases) {
    runners.push_back(std::make_unique<Runner>(one, options, &truth));
    pf_slam_t* slam = runners.back()->context.slam;
    if (slam == nullptr || pf_start_from_target(slam, &target) != PF_OK) return;
  }
  pf_image_t image;
  pf_pose_t pose;
  while (pf_sim_next(sim.get(), &image, &pose) != 0) {
    bool looked = false;
    for (std::size_t c = 0; c < cases.size(); ++c)
      runners[c]->push(image, pose, options.judge_after, &looked, &sums[c]);
  }
  for (std::size_t c = 0; c < cases.size(); ++c) runners[c]->finish(&sums[c]);
}

}  // namespace pfsim
