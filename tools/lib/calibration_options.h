#ifndef PLANEFOLD_TOOLS_CALIBRATION_OPTIONS_H
#define PLANEFOLD_TOOLS_CALIBRATION_OPTIONS_H

#include <cstdio>
#include <sstream>
#include <string>

namespace pf::tools {

/// Which calibration a program takes in place of the one that lies beside the images, and which of its cameras.
struct CalibrationOptions {
  std::string file;    ///< "": the one beside the images
  std::string camera;  ///< "": the one that the folder of the images is named after, or the first

  /// App  CLI::App, which is no business of all who include this
  template <typename App>
  void add_to(App& app) {
    app.add_option("--calib", file, "calibration file (default: the one beside the images)");
    app.add_option("--camera", camera, "of a calibration file of several cameras: the name there or its number");
  }

  const char* file_or_null() const { return file.empty() ? nullptr : file.c_str(); }
};

/// What a sequence has to be noted, each line for itself.
inline void print_notes(const char* program, const char* lines) {
  std::istringstream rest(lines);
  for (std::string line; std::getline(rest, line);) {
    std::fprintf(stderr, "%s: note: %s\n", program, line.c_str());
  }
}

}  // namespace pf::tools

#endif
