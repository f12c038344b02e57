#pragma once

#include "base/scalar.h"

/// Tuned numbers of what is believed, each with the probability that it stands for. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Log-odds that the pose is right, natural logarithms (lib/docs/theory/belief.md).
namespace pose_belief {
inline constexpr Scalar kTracked = Scalar(6.2);      ///< from which a pose is used: wrong in 0.2 %
inline constexpr Scalar kMost = Scalar(13.8);        ///< that a pose can have: wrong once in a million
inline constexpr Scalar kMaxFrame = Scalar(6.9);     ///< of one frame: one place in 1,000 looks like another
inline constexpr Scalar kAnew = Scalar(-6.9);        ///< of a prediction that nothing supports: right once in 1,000
inline constexpr Scalar kElsewhere = Scalar(-13.8);  ///< of any other pose: pictures may be of another place altogether
inline constexpr double kHazard = 0.005;  ///< [1/s] that what a prediction relies on ends: a cut, a grip, a blow
}  // namespace pose_belief

/// Share of views that look like another part of the map (alike_share.h).
namespace alike_share {
inline constexpr Scalar kWeight = Scalar(1);  ///< views that are not alike, which are assumed before any is known
}  // namespace alike_share

/// Log-odds that a feature is a point of the scene (feature_belief.h). A new one has zero: half of them are never measured again.
namespace feature_belief {
inline constexpr Scalar kMost = Scalar(6.9);   ///< that a feature can have: none once in a thousand
inline constexpr Scalar kNone = Scalar(-4.6);  ///< below which it is none: wrong in 1 %
}  // namespace feature_belief

/// Log-odds that a feature lies on a plane (plane_membership.h).
namespace plane_membership {
inline constexpr Scalar kSure = Scalar(4.6);  ///< from which on it is a member: ln 100
}  // namespace plane_membership

/// Log-odds that the lens has changed (lens_belief.h).
namespace lens_belief {
inline constexpr Scalar kKept = Scalar(0.01);       ///< relative sigma of one picture against the map's own errors
inline constexpr Scalar kChange = Scalar(0.2);      ///< the same of a change
inline constexpr Scalar kLeast = Scalar(-6.9);      ///< a lens changes once in 1,000 pictures at most
inline constexpr Scalar kMost = Scalar(6.9);        ///< so that pictures can also show that it has changed back
inline constexpr Scalar kSuspected = Scalar(-2.2);  ///< from which a pose is not used: changed in 10 %
inline constexpr Scalar kCertain = Scalar(4.6);     ///< from which the log has it: in 99 %
}  // namespace lens_belief

/// What chance finds in wrong places of real images, measured in 48,000 searches (lib/docs/lab/2026-11/belief.md).
namespace chance {
inline constexpr Scalar kMaxFindShare = Scalar(0.25);  ///< of searches that find something; found: 0.04 .. 0.24
inline constexpr Scalar kMinArea = Scalar(250);        ///< [px^2] per find in small ellipses, times kMaxFindShare
}  // namespace chance

/// Whether an image is as sharp as those before it (sharpness_belief.h). Sharpness is a natural logarithm.
namespace sharpness_belief {
inline constexpr Scalar kLessSharp = Scalar(0.1);     ///< share of images that are less sharp
inline constexpr Scalar kRange = Scalar(2);           ///< of which they are less sharp; smear of 9 px: 0.4 to 0.6
inline constexpr Scalar kPriorSpread = Scalar(0.2);   ///< sigma of images of one film: 0.03 to 0.26 in seven sequences
inline constexpr Scalar kLeastSpread = Scalar(0.05);  ///< the same, at least
inline constexpr Scalar kGain = Scalar(0.1);          ///< of a frame, in mean and variance
}  // namespace sharpness_belief

/// What a wrong place has in common with the right one, measured on frames in random order in the window, which searches for all points in
/// view (lib/docs/lab/2026-11/belief.md).
namespace common_part {
inline constexpr Scalar kShare = Scalar(0.5);  ///< of wrong places that have one
inline constexpr Scalar kPart = Scalar(0.05);  ///< of the features, in the mean, which are found as usual
}  // namespace common_part

/// Chance that a feature which is in view is found.
namespace find_share {
inline constexpr Scalar kPrior = Scalar(0.7);   ///< mean, before any frame
inline constexpr Scalar kWeight = Scalar(4);    ///< searches that earlier frames' mean counts as, of this frame's own
inline constexpr Scalar kGain = Scalar(0.3);    ///< of a frame, in the mean
inline constexpr Scalar kLeast = Scalar(0.05);  ///< mean, at least
inline constexpr Scalar kGreatest = Scalar(0.95);  ///< mean, at most
}  // namespace find_share

}  // namespace pf::tuning
