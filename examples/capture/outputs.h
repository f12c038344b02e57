#ifndef PLANEFOLD_CAPTURE_OUTPUTS_H
#define PLANEFOLD_CAPTURE_OUTPUTS_H

#include <planefold/planefold.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "source.h"
#include "text_file.h"
#include "track_rows.h"
#include "view.h"

namespace pf::capture {

/// The text files of a run. They are written as the run goes and by whole rows, so that a run that ends early, or is killed, leaves what it
/// had up to the last frame.
class Outputs {
 public:
  /// Makes the folder, opens the files and writes calib.yaml. false: error is one line.
  bool open(const std::string& folder, bool tracks, bool patches, bool truth, bool relative, const pf_camera_t& camera,
            bool inertial, std::string& error);

  /// trajectory.txt and covariance.csv where the frame was tracked, trajectory_all.txt wherever there is a pose; of the second map
  /// trajectory_2.txt and so on, since each map has a world of its own;
  /// frames.csv in every frame, tracks.csv and planes.csv, patches.csv; anchors.csv from the first
  /// anchor on, corrections.csv where the map has moved; truth.tum where the source knows the truth
  /// of its last frame. false: error is one line (disk full, say).
  /// A row of relative.csv where window is not null; of lens.csv where the frame was tracked and the lens is estimated;
  /// of inertial.csv where there is a pose that depends on a unit's samples.
  bool write(const FrameView& view, Source& source, const MotionWindow* window, std::string& error);
  /// truth_planes.json, where the source knows them.
  bool write_true_planes(const std::vector<std::array<double, 4>>& planes, std::string& error) const;
  /// map.ply and report.json, in the place of earlier ones. false: error is one line. sigmas_in_map as in to_ply.
  bool write_state(const FrameView& last, const std::vector<double>& sigmas_in_map, const std::string& report,
                   std::string& error) const;

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Takes the name for a file of this run that somebody else writes. false: error is one line, and the file is not to be written.
  bool claim(const std::string& name, std::string& error) const;

 private:
  bool create(TextFile& file, const std::string& name, std::string& error) const;
  bool open_again(TextFile& file, const std::string& name, std::string& error) const;
  bool open_map(int map, std::string& error);
  bool open_anchors(std::string& error);
  bool put_correction(const FrameView& view, std::string& error);

  std::filesystem::path folder_;
  TextFile trajectory_, trajectory_all_, covariance_, frames_, tracks_, planes_, patches_, truth_, relative_, lens_,
      inertial_, anchors_, corrections_;
  TrackRows track_rows_;
  int map_ = 0;          ///< whose files are open
  int maps_opened_ = 0;  ///< so far: 1 .. this
};

}  // namespace pf::capture

#endif
