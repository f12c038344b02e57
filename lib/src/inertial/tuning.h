#pragma once

#include "base/scalar.h"

/// Tuned numbers of the inertial unit, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Priors of an inertial unit.
namespace inertial {
inline constexpr Scalar kGyroBias = Scalar(0.1);   ///< [rad/s] sigma of each axis
inline constexpr Scalar kAccelBias = Scalar(0.2);  ///< [m/s^2] sigma of each axis
inline constexpr Scalar kGravity = Scalar(1);      ///< [rad] sigma of its direction, which is open
inline constexpr Scalar kYoungMap = Scalar(15);    ///< [s] oldest map of unknown scale that a metric one replaces
}  // namespace inertial

/// Agreement of samples and images. Slack and bound are from six runs of 60 s without faults (largest sum 38) and wrong units (pf-sim
/// --fault).
namespace unit_watch {
inline constexpr Scalar kSlack = Scalar(9);              ///< subtracted from each frame's chi-square of six
inline constexpr Scalar kBound = Scalar(100);            ///< of the sum, above which the unit is rejected
inline constexpr Scalar kBoundOnProbation = Scalar(30);  ///< in the first kTrial of its use after a rejection
inline constexpr Scalar kMaxOfFrame = Scalar(50);        ///< of a frame's chi-square: no single frame is enough
inline constexpr Scalar kMaxPoseNis = Scalar(38.3);      ///< chi-square of six, 1 - 1e-6: samples are not used for it
inline constexpr Scalar kSilence = Scalar(0.1);          ///< [s] without a sample, after which the mode is silent
inline constexpr Scalar kRate = Scalar(1);               ///< [rad/s] sigma of the rate where samples were wrong
inline constexpr Scalar kSpeed = Scalar(1);              ///< [m/s] the same of the velocity, or in units of W
inline constexpr Scalar kTime = Scalar(0.2);             ///< [s] for which the pose may have followed wrong samples
inline constexpr Scalar kTrial = Scalar(5);   ///< [s] in metres, before which a map depends on the unit alone
inline constexpr Scalar kWindow = Scalar(3);  ///< [s] for which a rejected gyro must agree; doubles each time
inline constexpr int kMaxDoublings = 8;       ///< of that
}  // namespace unit_watch

/// Gravity in the accelerometer's readings.
namespace force_check {
inline constexpr int kMinSamples = 20;         ///< in that time
inline constexpr Scalar kNear = Scalar(0.3);   ///< share of gravity that their mean may be off: 6 m/s in that time
inline constexpr Scalar kNone = Scalar(0.08);  ///< share of gravity below which there is none in it
}  // namespace force_check

/// The camera's rates against the gyroscope's.
namespace rate_alignment {
inline constexpr int kMinWithGyro = 2;            ///< one in so many of those has samples
inline constexpr int kMinIntervals = 15;          ///< between frames
inline constexpr Scalar kMirrored = Scalar(0.2);  ///< share of a rotation's residuals, below which a reflection fits
inline constexpr Scalar kMaxLeft = Scalar(0.35);  ///< of an accepted alignment: a correlation of 0.8
inline constexpr Scalar kClearly = Scalar(1.3);   ///< residuals of the next best delay over those of the best
inline constexpr Scalar kMaxSigmaDelay = Scalar(0.004);  ///< [s] of a clock that is known, to begin with
inline constexpr Scalar kMaxSigmaTurn = Scalar(0.07);    ///< [rad] of axes that are: errors are linear within it
inline constexpr Scalar kFloorDelay = Scalar(0.001);     ///< [s] least sigma, for rows and exposure
inline constexpr Scalar kFloorTurn = Scalar(0.01);       ///< [rad] the same
inline constexpr Scalar kMaxScale = Scalar(1.25);        ///< of a gyroscope that is used, and its inverse
inline constexpr Scalar kMinTurning = Scalar(0.05);      ///< [rad/s] sigma of the rates, at least, for an alignment
inline constexpr int kEvery = 5;                         ///< frames from fit to fit
inline constexpr Scalar kOpenDelay = Scalar(0.02);       ///< [s] sigma above which the delay is not linear
inline constexpr Scalar kOpenTurn = Scalar(0.2);         ///< [rad] the same of the axes
inline constexpr Scalar kOtherAxes = Scalar(0.35);       ///< [rad] that axes are off before they are named: 20 degrees
}  // namespace rate_alignment

/// A camera at rest.
namespace rest {
inline constexpr Scalar kTime = Scalar(1);                ///< [s] at rest before it counts
inline constexpr double kLate = 0.1;                      ///< [s] for which a motion may begin unseen
inline constexpr int kMinSamples = 20;                    ///< in that time
inline constexpr Scalar kMaxScatter = Scalar(2);          ///< standard deviations that the densities allow
inline constexpr Scalar kMaxGyroBias = Scalar(0.3);       ///< [rad/s] that a gyro at rest may show
inline constexpr Scalar kMaxGravityError = Scalar(1);     ///< [m/s^2] of the mean specific force
inline constexpr Scalar kMaxMotionPx = Scalar(1);         ///< [px] of the picture as a whole, root mean square
inline constexpr int kMinPixels = 8;                      ///< features by which that is judged
inline constexpr Scalar kMaxApartPx = Scalar(3);          ///< [px] of these from their median displacement
inline constexpr Scalar kMinMotionPx = Scalar(0.2);       ///< [px] least motion of the image that differs from none
inline constexpr Scalar kMinMeanMotionPx = Scalar(0.05);  ///< [px] the same of its mean over kMeanGain's frames
inline constexpr Scalar kMaxMeanMotionPx = Scalar(0.3);   ///< [px] of that since the rest began
inline constexpr Scalar kMeanGain = Scalar(0.1);          ///< of that running mean, per frame
inline constexpr Scalar kMaxNis = Scalar(38.3);           ///< chi-square of six, 1 - 1e-6: above it the camera moves
inline constexpr Scalar kAnyNis = Scalar(1e9);            ///< the same, once the frame has shown no motion
inline constexpr Scalar kHidden = Scalar(2);              ///< sigmas of a frame's mean acceleration that pass for none
inline constexpr int kMinTogether = 2;                    ///< one in so many pixels moves with the median
}  // namespace rest

/// A start in metres from a moving camera.
namespace moving_verdict {
inline constexpr Scalar kInterval = Scalar(0.03);        ///< [s] between poses at least
inline constexpr Scalar kMinSpan = Scalar(1.5);          ///< [s] of a solution's poses
inline constexpr int kMinPoses = 16;                     ///< of a solution
inline constexpr int kLocated = 32;                      ///< poses that are found anew in a frame
inline constexpr Scalar kMaxDepthSigma = Scalar(0.3);    ///< of a feature's inverse depth, relative
inline constexpr int kMinPixels = 8;                     ///< with a depth, in each of these frames
inline constexpr Scalar kHuber = Scalar(3);              ///< sigmas of a pixel beyond which it counts linearly
inline constexpr int kRounds = 5;                        ///< of a pose's refinement
inline constexpr Scalar kDrift = Scalar(0.0001);         ///< of poses' positions, of the median depth [/sqrt(s)]
inline constexpr Scalar kTiltDensity = Scalar(0.00005);  ///< [rad/sqrt(s)] of the drift of the poses' rotations
inline constexpr Scalar kRotation = Scalar(0.0001);  ///< [rad/sqrt(Hz)] of their noise: 0.1 mrad that last for a second
inline constexpr Scalar kMaxSigmaScale = Scalar(0.025);    ///< of the log scale
inline constexpr Scalar kMaxSigmaGravity = Scalar(0.015);  ///< [rad] of its direction
inline constexpr Scalar kLateSigmaScale = Scalar(0.1);     ///< of the log scale then
inline constexpr Scalar kLateSigmaGravity = Scalar(0.03);  ///< [rad] of gravity's direction then
inline constexpr Scalar kMaxMisfit = Scalar(3);            ///< chi-square over its degrees of freedom
inline constexpr Scalar kMaxApart = Scalar(9);             ///< of two halves, in the sum of their variances
inline constexpr int kBetterDelay = 2;                     ///< times better known, before samples are integrated again
}  // namespace moving_verdict

/// The inertial unit's noise, learned. A frame's innovation over its expectation is a likelihood's slope in the log of the variance.
namespace unit_noise {
inline constexpr Scalar kLeast = Scalar(0.3333);    ///< of a density to the stated one
inline constexpr Scalar kMost = Scalar(10);         ///< the same, at most
inline constexpr int kMaxGap = 4;                   ///< median intervals that three samples in a row span, at most
inline constexpr int kWindow = 100;                 ///< samples of which differences are averaged
inline constexpr Scalar kWhite = Scalar(0.7);       ///< of third to second differences, each over that of white noise
inline constexpr Scalar kGain = Scalar(0.3);        ///< of the mean over windows
inline constexpr Scalar kStep = Scalar(4);          ///< change of the variance's factor by a window, at most
inline constexpr Scalar kRate = Scalar(0.1);        ///< step of the log variance per frame
inline constexpr Scalar kSlack = Scalar(1.3);       ///< mean share above which innovations are not explained
inline constexpr Scalar kMostOfFrame = Scalar(5);   ///< nis / dof of one frame, at most
inline constexpr Scalar kNearBound = Scalar(0.95);  ///< of kMost: no noise explains it
}  // namespace unit_noise

}  // namespace pf::tuning
