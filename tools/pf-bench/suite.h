#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "../lib/calibration_options.h"

namespace bench {

/// One measurement. ratio = us / (the peer's us in the same run).
struct Row {
  std::string suite, name, scalar;
  int n = 0, m = 0;
  double us = 0;
  std::string peer;
  double ratio = 0;
  std::vector<std::pair<std::string, double>> figures = {};  ///< what else was measured, by name
};

struct SuiteOptions {
  std::string json;      ///< file for the rows, empty for none
  int repetitions = 61;  ///< of every interleaved measurement
  std::string kernels;   ///< kernel set by name, empty for the fastest

  /// Of suites that run on sequences.
  std::vector<std::string> sources;
  std::string start;
  pf::tools::CalibrationOptions calibration;
  std::string walls;    ///< file of walls known beforehand; none where it is empty
  int patches = 4;      ///< capacity for patches, where there are walls
  bool window = false;  ///< the back end
  bool planes = true;   ///< false: points only
  int masks = 0;        ///< pf_masks_t
  int features = 0;     ///< in view; 0: the library's default
  int passes = 3;       ///< through every sequence
  int seeds = 10;       ///< of suites that draw what they run on
  int frames = 100000;  ///< at most, of every sequence

  /// Of the suite that follows a patch: one of stored frames where source, patch and truth are given.
  std::string patch;    ///< X,Y,W,H in the first frame [px]
  std::string truth;    ///< file of homographies, nine numbers for each frame
  double hidden = 0.3;  ///< share of a drawn patch that something passes before
};

/// Tables on stdout as rows come, and a JSON file at the end.
class Report {
 public:
  explicit Report(const SuiteOptions& options) : options_(options) {}
  void add(const Row& row);
  void note(const std::string& key, const std::string& value);  ///< printed, and kept in the file's head
  int finish() const;                                           ///< 0, or 1 when the file cannot be written

 private:
  SuiteOptions options_;
  std::vector<Row> rows_;
  std::vector<std::pair<std::string, std::string>> notes_;
};

/// A suite is one file named *_suite.cpp with one of these at namespace scope; main finds it by itself.
struct Suite {
  enum Input { kNone, kSequences, kSeeds, kPatch };  ///< what it runs on, besides what it makes for itself
  Suite(const char* suite_name, const char* what, int (*entry)(const SuiteOptions&), Input takes_input = kNone);
  static const Suite* first();

  const char* name;
  const char* description;
  int (*run)(const SuiteOptions&);
  Input input;
  const Suite* next;
};

/// "double" or "float": what this program was built for.
const char* scalar_name();

}  // namespace bench
