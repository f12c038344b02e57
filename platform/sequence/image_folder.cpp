#include "image_folder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "image_list.h"
#include "numbers.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr size_t kMaxCalibrationBytes = size_t{1} << 20;

/// fx 0 cx, 0 fy cy of a projection matrix in KITTI's calib.txt. false: not there.
bool read_intrinsics(const fs::path& file, std::string_view name, std::array<double, 4>& found) {
  const std::string text = read_text(file, kMaxCalibrationBytes, "calibration");
  for (const Row& row : split_rows(text)) {
    if (row.words.size() == 13 && row.words[0] == name) {
      return parse_double(row.words[1], found[0]) && parse_double(row.words[3], found[1]) &&
             parse_double(row.words[6], found[2]) && parse_double(row.words[7], found[3]);
    }
  }
  return false;
}

/// The calibration that is read is P0, of the left grey camera; KITTI's rectified cameras have the same.
void require_intrinsics_of_grey(const fs::path& root, const std::string& camera) {
  const fs::path file = root / "calib.txt";
  std::array<double, 4> grey{}, colour{};
  if (!is_file(file) || !read_intrinsics(file, "P0:", grey) || !read_intrinsics(file, camera + ":", colour)) {
    return;
  }
  for (size_t i = 0; i < grey.size(); ++i) {
    if (std::fabs(grey[i] - colour[i]) > 1e-6 * std::fabs(grey[i])) {
      refuse(file.string() + ": " + camera +
             " of the colour images differs from P0, which is read; give the calibration with --calib");
    }
  }
}

/// Folders inside that hold images, themselves or in a folder of that name.
std::vector<std::string> folders_with_images(const fs::path& root, const char* below = "") {
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator entry(root, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name[0] == '.' || name[0] == '@' || name == "__MACOSX" || !is_folder(entry->path())) {
      continue;  // what other systems put beside the files of users
    }
    std::error_code closed;
    for (fs::directory_iterator file(entry->path() / below, closed); !closed && file != end; file.increment(closed)) {
      if (is_image_name(file->path())) {
        found.push_back(name);
        break;
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

bool is_of_light(const std::string& name) {
  return name.find("depth") == std::string::npos && name.find("thumb") == std::string::npos &&
         name.find("preview") == std::string::npos && name.find("mask") == std::string::npos &&
         name.find("label") == std::string::npos;
}

}  // namespace

bool has_several_cameras(const fs::path& root) {
  return std::max(folders_with_images(root).size(), folders_with_images(root, "data").size()) > 1;
}

fs::path find_images(const fs::path& root, bool has_times, std::vector<std::string>& notes) {
  for (const char* below : {"images", "image_0"}) {
    if (is_folder(root / below)) {
      return root / below;
    }
  }
  if (!list_images(root).empty()) {
    return root;
  }
  for (const auto& [below, camera] : {std::pair("image_2", "P2"), std::pair("image_3", "P3")}) {
    if (is_folder(root / below)) {
      require_intrinsics_of_grey(root, camera);
      notes.push_back(root.string() + ": has no image_0; the colour images of " + below + " are taken");
      return root / below;
    }
  }
  const std::vector<std::string> all = folders_with_images(root);
  const std::vector<std::string> cameras = all.empty() ? folders_with_images(root, "data") : std::vector<std::string>();
  if (!cameras.empty() && !has_times) {  // as KITTI's raw recordings
    refuse(root.string() + ": has its images in " + cameras.front() + "/data" +
           (cameras.size() > 1 ? " to " + cameras.back() + "/data" : "") +
           "; name a camera, as in --source images:" + (root / cameras.front()).string());
  }
  std::vector<std::string> chosen;
  std::string names;
  for (const std::string& name : all) {
    names += (names.empty() ? "" : ", ") + name + "/";
    if (is_of_light(name)) {
      chosen.push_back(name);
    }
  }
  if (chosen.size() == 1) {
    notes.push_back(root.string() + ": of the images inside (" + names + ") those of " + chosen[0] + "/ are taken");
    return root / chosen[0];
  }
  if (chosen.size() > 1 && !has_times) {
    refuse(root.string() + ": has images in several folders (" + names +
           "); name one, as in --source images:" + (root / chosen[0]).string());
  }
  return root;
}

}  // namespace pf::sequence
