#pragma once

#include "track/align_plane.h"
#include "track/template_normal.h"
#include "track/tracker.h"
#include "vision/template_mask.h"

/// Finds templates whose pixels belong to their dominant plane in part only, and learns which those are, and the plane's normal.
/// lib/docs/theory/templates.md; what of it is the paper's: lib/docs/theory/masoud2015.md

namespace pf {

class TemplateMatcher {
 public:
  /// side 0: there are no templates, and nothing is taken.
  bool layout(Arena& arena, int side);
  /// max_misfit: mean square of a match's residuals over sigma_plane^2, at most.
  void init(const Camera& camera, MaskMode mode, float max_misfit);

  void begin_frame() { noise_ = -1; }
  /// Begins a template on pixels of this frame's image.
  void begin(const ImageView& image, const SourcePatch& patch, const Vec2& pixel, PlanarTemplate* shape,
             std::uint8_t* mask);

  /// Finds a template whose point has a depth: by the mask's correlation in the ellipse, then by the residuals that it leaves.
  /// A view with which it cannot be compared, and an ellipse of more than kReach px, are the tracker's.
  SearchOutcome search(const Tracker& tracker, const SearchTask& task);

  /// Updates normal (where it is the template's own) and mask of a template that was found at `pixel`. task: after the frame's update.
  /// False where neither changes.
  bool learn(const Tracker& tracker, const SearchTask& task, const Vec2& pixel, PlanarTemplate* shape,
             std::uint8_t* mask);

  /// Slopes by which a template is warped: of its plane's normal, of its own, or facing the first camera.
  static Vec2 slope_of(const SearchTask& task, const TemplateWarp& warp);

 private:
  struct Pattern {
    int size = 0, row = 0;  ///< floats from row to row
    float weight = 0, grey = 0, grey2 = 0;
  };

  void fill_patch(const SourcePatch& patch, const PlanarTemplate& shape);
  void fill_mask(const PlanarTemplate& shape, const std::uint8_t* mask);
  void make_pattern(const SearchTask& task, const Mat2& A, Pattern* pattern);
  void fill_region(const ImageView& image, const Pattern& pattern, int left, int top);
  float score(const Pattern& pattern, int x, int y) const;
  bool find(const ImageView& image, const SearchTask& task, const Pattern& pattern, Vec2* position);
  bool judge(const PlanarTemplate& shape, const std::uint8_t* mask, float gain, Scalar shift_sigma,
             const Vec2& slope_sigma, float max_misfit);

  Camera camera_;
  MaskMode mode_ = MaskMode::kNone;
  float max_misfit_ = 1;
  int side_ = 0;
  float noise_ = -1;                           ///< of this frame's image [grey levels]; negative: not computed yet
  PlaneAligner* aligner_ = nullptr;            ///< all of these null without templates
  PlanePatch* patch_ = nullptr;                ///< the pixels of a template with one more on each side
  std::uint8_t* learnt_ = nullptr;             ///< mask after the frame
  std::uint8_t* probability_ = nullptr;        ///< of each pixel before it
  float *grey_ = nullptr, *weight_ = nullptr;  ///< of a pattern
  float* region_ = nullptr;                    ///< of the image, about where it is searched
};

}  // namespace pf
