#include "folder.h"

#include <planefold_platform/sequence.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "image_folder.h"
#include "image_list.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr size_t kMaxTableBytes = size_t{256} << 20;

fs::path first_file(const fs::path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (is_file(folder / name)) {
      return folder / name;
    }
  }
  return {};
}

void find_calibration(Folder& folder, const std::string& given, const fs::path& where,
                      std::initializer_list<const char*> names) {
  if (given == PF_SEQUENCE_UNCALIBRATED) {
    folder.calibration.form = "none";
    return;
  }
  folder.calibration_path = given.empty() ? first_file(where, names) : fs::path(given);
  if (folder.calibration_path.empty()) {
    std::string list;
    for (const char* name : names) {
      list += (list.empty() ? "" : ", ") + std::string(name);
    }
    refuse(where.string() + ": no calibration inside (looked for " + list + "); give one with --calib FILE");
  }
  folder.calibration = read_calibration(folder.calibration_path.string());
}

/// Refuses a folder of another layout, which has its images elsewhere.
void refuse_other_layouts(const fs::path& root) {
  if (is_file(root / "times.txt") || is_folder(root / "images") || is_folder(root / "image_0") ||
      !list_images(root).empty()) {
    return;
  }
  if (is_file(root / "rgb.txt")) {
    refuse(root.string() + ": has no images itself but an rgb.txt, as TUM's sequences do; write tum:" + root.string());
  }
  if (is_file(root / "mav0" / "cam0" / "data.csv") || is_file(root / "cam0" / "data.csv")) {
    refuse(root.string() +
           ": has no images itself but cam0/data.csv, as EuRoC's sequences do; write euroc:" + root.string());
  }
}

/// Frames of a table, with names below images or root.
void read_frames(Folder& folder, const fs::path& table, const fs::path& images, const std::string& pattern,
                 TimeUnit unit) {
  const Table rows(read_text(table, kMaxTableBytes, "times"), table.string());
  folder.frames =
      read_frame_table(rows, {images, pattern, folder.root, unit, folder.calibration.rate_hz}, folder.notes);
}

/// Frames of a folder without a table.
void count_frames(Folder& folder, const fs::path& images, const std::string& pattern) {
  const std::vector<std::string> names = one_sequence(images, list_images(images, pattern), folder.notes);
  if (names.empty()) {
    refuse(images.string() + ": holds no PNG, JPEG or PGM image" + (pattern.empty() ? "" : " of the name " + pattern) +
           "; check the path");
  }
  const double rate = folder.calibration.rate_hz > 0.0 ? folder.calibration.rate_hz : kAssumedRate;
  folder.frames = frames_by_names(images, names, folder.calibration.rate_hz, folder.notes);
  if (!folder.frames.empty()) {
    return;
  }
  for (const std::string& name : names) {
    const double t = static_cast<double>(folder.frames.size()) / rate;
    folder.frames.push_back({static_cast<int64_t>(std::llround(t * 1e9)), images / name});
  }
  char text[64];
  std::snprintf(text, sizeof(text), "%g frames per second", rate);
  folder.notes.insert(
      folder.notes.begin(),
      folder.root.string() + ": no times.txt; the images are taken in the order of their names at " + text);
}

void open_images(Folder& folder, const std::string& calibration, const std::string& pattern) {
  const fs::path& root = folder.root;
  refuse_other_layouts(root);
  find_calibration(folder, calibration, root,
                   {"calib.yaml", "calib.yml", "camchain.yaml", "sensor.yaml", "camera_info.yaml", "calib.txt"});
  const fs::path times = first_file(root, {"times.txt", "timestamps.txt", "times.csv", "timestamps.csv"});
  const fs::path images = pattern.empty() ? find_images(root, !times.empty(), folder.notes) : root;
  if (times.empty()) {
    count_frames(folder, images, pattern);
  } else {
    read_frames(folder, times, images, pattern, TimeUnit::kSeconds);
  }
  folder.truth_path = first_file(root, {"groundtruth.tum", "groundtruth.txt"});
  folder.imu_path = first_file(root, {"imu.csv"});
}

void open_tum(Folder& folder, const std::string& calibration) {
  const fs::path table = folder.root / "rgb.txt";
  if (!is_file(table)) {
    refuse(table.string() + ": missing; a tum: folder holds rgb.txt and rgb/ (use images: for other layouts)");
  }
  find_calibration(folder, calibration, folder.root, {"calib.yaml", "calib.yml", "camchain.yaml", "camera_info.yaml"});
  read_frames(folder, table, folder.root, "", TimeUnit::kSeconds);
  folder.truth_path = first_file(folder.root, {"groundtruth.txt", "groundtruth.tum"});
}

void open_euroc(Folder& folder, const std::string& calibration) {
  for (const char* below : {"mav0/cam0", "cam0", "."}) {
    const fs::path camera = folder.root / below;
    if (is_file(camera / "data.csv")) {
      find_calibration(folder, calibration, camera, {"sensor.yaml", "calib.yaml"});
      read_frames(folder, camera / "data.csv", camera / "data", "", TimeUnit::kNanoseconds);
      folder.truth_path = first_file(folder.root, {"groundtruth.tum"});
      if (folder.truth_path.empty()) {
        folder.truth_path = first_file(camera / ".." / "state_groundtruth_estimate0", {"data.csv"}).lexically_normal();
      }
      folder.imu_path = first_file(camera / ".." / "imu0", {"data.csv"}).lexically_normal();
      return;
    }
  }
  if (is_file(folder.root / "times.txt") || is_folder(folder.root / "images")) {
    open_images(folder, calibration, "");
    return;
  }
  refuse(folder.root.string() +
         ": no mav0/cam0/data.csv inside; give the folder that holds mav0, or mav0 or cam0 itself");
}

}  // namespace

Folder open_folder(const std::string& source, const std::string& calibration) {
  const size_t colon = source.find(':');
  const std::string kind = source.substr(0, colon);
  const std::string where = colon == std::string::npos ? "" : source.substr(colon + 1);
  if (kind != "images" && kind != "euroc" && kind != "tum") {
    refuse("source '" + source + "': begins with none of images:, euroc:, tum:");
  }
  if (where.empty()) {
    refuse("source '" + source + "': names no folder; write " + kind + ":DIR");
  }
  Folder folder{};
  folder.root = where;
  std::string pattern;
  if (kind == "images" && !is_folder(folder.root) && folder.root.filename().string().find('*') != std::string::npos) {
    pattern = folder.root.filename().string();
    folder.root = folder.root.has_parent_path() ? folder.root.parent_path() : fs::path(".");
  }
  require_folder(folder.root);
  if (kind == "images") {
    open_images(folder, calibration, pattern);
  } else if (kind == "tum") {
    open_tum(folder, calibration);
  } else {
    open_euroc(folder, calibration);
  }
  return folder;
}

}  // namespace pf::sequence
