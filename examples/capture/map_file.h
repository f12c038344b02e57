#ifndef PLANEFOLD_CAPTURE_MAP_FILE_H
#define PLANEFOLD_CAPTURE_MAP_FILE_H

#include <planefold/planefold.h>

#include <string>
#include <vector>

namespace pf::capture {

/// Why no map can be saved under this path: it is a folder, there is no folder to hold it, or a file is there that is no saved map. One
/// line; "": it can.
std::string why_no_map_can_be_saved(const std::string& path);

/// A saved map that the run begins in, and the one that it leaves.
class MapFile {
 public:
  /// Reads the file that the run begins in; "": none. false: error is one line.
  bool read(const std::string& path, std::string& error);
  /// Puts it into a context that has no frames yet. log: lines of the library's log, of which the last one is the reason where the
  /// map is rejected. false: error is one line.
  bool load(pf_slam_t* slam, const std::vector<std::string>& log, std::string& error) const;
  /// Saves the map of a context, of this pf_map_kind_t: written beside the file, synced and renamed, so that the file is always the old map
  /// or the new one. note: a line for the user. false: there is no new file, and error is one line.
  static bool save(const pf_slam_t* slam, int32_t kind, const std::string& path, std::string& note, std::string& error);

  bool empty() const { return path_.empty(); }

 private:
  std::string path_, bytes_;
};

}  // namespace pf::capture

#endif
