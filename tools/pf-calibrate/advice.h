#ifndef PLANEFOLD_CALIBRATE_ADVICE_H
#define PLANEFOLD_CALIBRATE_ADVICE_H

#include <string>
#include <vector>

#include "fit.h"

namespace pf::calibrate {

/// Whether a calibration is good enough to track with, and what its views lack.
struct Verdict {
  bool good = false;
  std::vector<std::string> lacks;  ///< each is what is missing, and what to film for it
};

Verdict judge_fit(const Fit& fit, const Board& board);

/// One line.
std::string verdict_line(const Verdict& verdict);

}  // namespace pf::calibrate

#endif
