#include "find_calibration.h"

#include <algorithm>
#include <system_error>

#include "image_folder.h"
#include "meaning.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr size_t kMaxBytes = size_t{256} << 10;  ///< of a file that may be a calibration beside images
constexpr size_t kLayoutNames = 2;

/// Tables that the layouts name, which need not be looked into.
bool is_table(const std::string& name) {
  return name == "times.txt" || name == "rgb.txt" || name == "depth.txt" || name.rfind("groundtruth", 0) == 0;
}

bool is_of_known_form(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  std::error_code failed;
  if ((extension != ".yaml" && extension != ".yml" && extension != ".txt" && extension != ".json") ||
      is_table(path.filename().string()) || !is_file(path) || fs::file_size(path, failed) > kMaxBytes || failed) {
    return false;
  }
  try {
    return is_calibration(read_text(path, kMaxBytes, "calibration"));
  } catch (const std::exception&) {
    return false;
  }
}

/// Files of known forms in a folder, by name.
std::vector<fs::path> calibrations_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    if (is_of_known_form(entry->path())) {
      found.push_back(folder / entry->path().filename());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Whether two files are of the same camera; false where one cannot be read.
bool agree(const fs::path& a, const fs::path& b, const Asked& asked) {
  try {
    return is_same_lens(read_calibration(a.string(), asked).camera, read_calibration(b.string(), asked).camera);
  } catch (const std::exception&) {
    return false;
  }
}

std::string list_of(const std::vector<fs::path>& paths) {
  std::string list;
  for (const fs::path& path : paths) {
    list += (list.empty() ? "" : ", ") + path.filename().string();
  }
  return list;
}

fs::path first_there(const fs::path& where, const std::vector<std::string>& names, size_t count) {
  for (size_t i = 0; i < std::min(count, names.size()); ++i) {
    if (is_file(where / names[i])) {
      return where / names[i];
    }
  }
  return {};
}

/// The calibration of a folder of one camera of several, which lies above it; KITTI's raw recordings have calib_cam_to_cam.txt above the
/// folders of their drives. Empty: none.
fs::path calibration_above(const fs::path& camera, const std::vector<std::string>& names) {
  const fs::path above = (fs::absolute(camera) / ".").lexically_normal().parent_path().parent_path();
  for (const fs::path& file : {above / "calib_cam_to_cam.txt", above.parent_path() / "calib_cam_to_cam.txt"}) {
    if (is_file(file)) {
      return file;
    }
  }
  const fs::path named = first_there(above, names, names.size());
  return !named.empty() && has_several_cameras(above) ? named : fs::path();
}

void refuse_missing(const fs::path& where, const std::vector<std::string>& names, const char* others) {
  std::string list;
  for (const std::string& name : names) {
    list += (list.empty() ? "" : ", ") + name;
  }
  refuse(where.string() + ": no calibration inside (looked for " + list + others + "); give one with --calib FILE");
}

}  // namespace

fs::path named_calibration(const fs::path& where, const std::vector<std::string>& names) {
  const fs::path found = first_there(where, names, names.size());
  if (found.empty()) {
    refuse_missing(where, names, "");
  }
  return found;
}

fs::path find_calibration(const fs::path& where, const fs::path& images, const std::vector<std::string>& names,
                          const Asked& asked, std::vector<std::string>& notes) {
  std::vector<fs::path> found = calibrations_in(where);
  const fs::path of_layout = first_there(where, names, kLayoutNames);
  if (!of_layout.empty()) {
    found.erase(
        std::remove_if(found.begin(), found.end(),
                       [&](const fs::path& path) { return path == of_layout || agree(path, of_layout, asked); }),
        found.end());
    if (!found.empty()) {
      notes.push_back(of_layout.string() + ": is taken, and not " + list_of(found) + " beside it, which differs");
    }
    return of_layout;
  }
  if (found.empty() && images != where && is_folder(images)) {
    found = calibrations_in(images);
  }
  if (found.empty()) {
    const fs::path named = first_there(where, names, names.size());
    if (!named.empty()) {
      return named;
    }
    const fs::path above = calibration_above(where, names);
    if (!above.empty()) {
      notes.push_back(above.string() + ": is taken for the images of " + images.string());
      return above;
    }
    refuse_missing(where, names, " or another file of a known layout");
  }
  for (const fs::path& path : found) {
    if (path != found.front() && !agree(path, found.front(), asked)) {
      refuse(where.string() + ": has several calibrations with different numbers (" + list_of(found) +
             "); give one of them with --calib FILE");
    }
  }
  return found.front();
}

}  // namespace pf::sequence
