#ifndef PLANEFOLD_CALIBRATE_OUTPUTS_H
#define PLANEFOLD_CALIBRATE_OUTPUTS_H

#include <string>

#include "fit.h"
#include "search.h"

namespace pf::calibrate {

/// false: the folder holds what no earlier run wrote, and error is one line. Asked before the search, which takes minutes.
bool check_outputs(const std::string& folder, const std::string& source, std::string& error);

/// Writes calib.yaml, calibration.json, corners.csv and coverage.png into a folder. false: error is one line.
bool write_outputs(const std::string& folder, const Board& board, const Search& search, const Fit& fit,
                   std::string& error);

/// The picture: where corners were seen, which way and how far (50 times enlarged) they lie from the fit.
bool draw_coverage(const std::string& path, const Fit& fit, std::string& error);

const char* model_name(int32_t model);

}  // namespace pf::calibrate

#endif
