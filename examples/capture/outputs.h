#ifndef PLANEFOLD_CAPTURE_OUTPUTS_H
#define PLANEFOLD_CAPTURE_OUTPUTS_H

#include <planefold/planefold.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "view.h"

namespace pf::capture {

/// The text files of a run. They are written as the run goes, so that a run that ends early leaves what it had.
class Outputs {
 public:
  /// Makes the folder and opens the files. false: error is one line.
  bool open(const std::string& folder, bool tracks, bool truth, std::string& error);

  /// trajectory.txt and covariance.csv where the frame was tracked, trajectory_all.txt wherever there is a pose,
  /// frames.csv in every frame, tracks.csv.
  void write(const FrameView& view);
  void write_truth(const pf_pose_t& pose);
  /// truth_planes.json, where the source knows them.
  bool write_true_planes(const std::vector<std::array<double, 4>>& planes, std::string& error) const;
  /// map.ply and calib.yaml; false when a file could not be written completely. sigmas_in_map as in write_ply.
  bool finish(const FrameView& last, const std::vector<double>& sigmas_in_map, const pf_camera_t& camera,
              const std::string& report, std::string& error);

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Takes the name for a file of this run that somebody else writes. false: error is one line, and the file is not to be written.
  bool claim(const std::string& name, std::string& error) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;

  File create(const char* name, std::string& error) const;

  std::filesystem::path folder_;
  File trajectory_, trajectory_all_, covariance_, frames_, tracks_, truth_;
};

}  // namespace pf::capture

#endif
