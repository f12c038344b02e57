/// Layouts of folders: lib/docs/guide/data_sets.md has a command for each.
#include "folder.h"

#include <planefold_platform/sequence.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "film_facts.h"
#include "find_calibration.h"
#include "frame_gaps.h"
#include "frame_names.h"
#include "image_folder.h"
#include "image_list.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr size_t kMaxTableBytes = size_t{256} << 20;

/// Folders above the images whose names may be that of a camera: cam1/data.
constexpr size_t kFoldersThatName = 2;

fs::path first_file(const fs::path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (is_file(folder / name)) {
      return folder / name;
    }
  }
  return {};
}

/// images    folder that they lie in
/// any_name  whether a file of a known form will do whose name is not one of those
void set_calibration(Folder& folder, const std::string& given, const fs::path& where, const fs::path& images,
                     const std::vector<std::string>& names, bool any_name) {
  if (given == PF_SEQUENCE_UNCALIBRATED) {
    folder.calibration.form = "none";
    return;
  }
  const fs::path absolute = fs::absolute(images).lexically_normal();
  for (const fs::path& part : absolute) {
    folder.asked.folders.insert(folder.asked.folders.begin(), part.string());
  }
  folder.asked.folders.resize(std::min<size_t>(folder.asked.folders.size(), kFoldersThatName));
  folder.calibration_path = !given.empty() ? fs::path(given)
                            : any_name     ? find_calibration(where, images, names, folder.asked, folder.notes)
                                           : named_calibration(where, names);
  read_calibration_of(folder);
}

/// Refuses a folder of another layout, which has its images elsewhere.
/// kind  that the user wrote
void refuse_other_layouts(const fs::path& root, const std::string& kind) {
  if (is_file(root / "times.txt") || is_folder(root / "images") || is_folder(root / "image_0") ||
      !list_images(root).empty()) {
    return;
  }
  if (kind != "tum" && is_file(root / "rgb.txt")) {
    refuse(root.string() + ": has no images itself but an rgb.txt, as TUM's sequences do; write tum:" + root.string());
  }
  if (kind != "euroc" && (is_file(root / "mav0" / "cam0" / "data.csv") || is_file(root / "cam0" / "data.csv"))) {
    refuse(root.string() +
           ": has no images itself but cam0/data.csv, as EuRoC's sequences do; write euroc:" + root.string());
  }
}

/// The first file of the folder whose name ends so, whatever the case of letters; empty: none.
fs::path file_that_ends(const fs::path& folder, const std::string& end) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  fs::path found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), last; !error && entry != last; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.size() > end.size() && name[0] != '.' && std::equal(end.rbegin(), end.rend(), name.rbegin(), same) &&
        (found.empty() || entry->path() < found)) {
      found = entry->path();
    }
  }
  return found;
}

/// What a folder without images may hold in their place, and what to do.
std::string what_it_holds(const fs::path& folder) {
  for (const char* end :
       {".bmp", ".tif", ".tiff", ".webp", ".ppm", ".heic", ".heif", ".avif", ".exr", ".dng", ".jp2", ".jxl", ".gif"}) {
    const fs::path other = file_that_ends(folder, end);
    if (!other.empty()) {
      std::string format(end + 1);
      std::transform(format.begin(), format.end(), format.begin(), [](unsigned char c) { return std::toupper(c); });
      return " but " + format + " (" + other.filename().string() +
             "); convert them (ImageMagick: mogrify -format png *" + other.extension().string() + ")";
    }
  }
  return "; check the path";
}

/// KITTI's odometry poses, or a pose file for each image; empty: none.
fs::path truth_of_images(const fs::path& root, const fs::path& images) {
  const fs::path inside = first_file(root, {"groundtruth.tum", "groundtruth.txt"});
  if (!inside.empty()) {
    return inside;
  }
  const fs::path whole = fs::absolute(root / ".").lexically_normal().parent_path();
  const fs::path poses = whole.parent_path().parent_path() / "poses" / (whole.filename().string() + ".txt");
  if (whole.parent_path().filename() == "sequences" && is_file(poses)) {
    return poses;
  }
  return file_that_ends(images, "pose.txt").empty() ? fs::path() : images;
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
           what_it_holds(images));
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
  const std::string missing = missing_numbers(names);
  folder.notes.insert(folder.notes.begin(), folder.root.string() +
                                                ": no times.txt; the images are taken in the order of their names at " +
                                                text + (missing.empty() ? "" : "; " + missing));
}

void open_images(Folder& folder, const std::string& calibration, const std::string& pattern) {
  const fs::path& root = folder.root;
  refuse_other_layouts(root, "images");
  const fs::path times = first_file(root, {"times.txt", "timestamps.txt", "times.csv", "timestamps.csv"});
  const fs::path images = pattern.empty() ? find_images(root, !times.empty(), folder.notes) : root;
  set_calibration(
      folder, calibration, root, images,
      {"calib.yaml", "calib.yml", "camchain.yaml", "sensor.yaml", "camera_info.yaml", "calib.txt", "calibration.txt"},
      true);
  if (times.empty()) {
    count_frames(folder, images, pattern);
  } else {
    read_frames(folder, times, images, pattern, TimeUnit::kSeconds);
  }
  folder.truth_path = truth_of_images(root, images);
  folder.imu_path = first_file(root, {"imu.csv", "gyro_accel.csv"});
}

/// Rows "time depth time rgb" of an associations.txt as a table of the images in colour.
std::unique_ptr<Table> colour_of(const fs::path& associations) {
  const Table pairs(read_text(associations, kMaxTableBytes, "times"), associations.string());
  std::string text;
  size_t lines = 0;
  for (const TableRow& row : pairs.rows()) {
    const size_t first = row.fields.size() != 4                                ? row.fields.size()
                         : row.fields[1].find("rgb") != std::string_view::npos ? 0
                         : row.fields[3].find("rgb") != std::string_view::npos ? 2
                                                                               : 4;
    if (first >= row.fields.size()) {
      refuse(pairs.where(row) + "expected two times, each with a name, one of them in rgb/; found '" +
             std::string(row.line) + "'");
    }
    for (; lines + 1 < row.number; ++lines) {
      text += '\n';  // so that rows keep their numbers
    }
    text += std::string(row.fields[first]) + ",\"" + std::string(row.fields[first + 1]) + "\"";
  }
  return std::make_unique<Table>(std::move(text), associations.string());
}

void open_tum(Folder& folder, const std::string& calibration) {
  const fs::path& root = folder.root;
  const fs::path table = root / "rgb.txt";
  const fs::path pairs =
      first_file(root, {"associations.txt", "association.txt", "associate.txt", "associated.txt", "assoc.txt"});
  if (!is_file(table) && pairs.empty()) {
    refuse_other_layouts(root, "tum");
    if (!is_folder(root / "rgb")) {
      refuse(table.string() + ": missing; a tum: folder holds rgb.txt and rgb/ (use images: for other layouts)");
    }
  }
  set_calibration(folder, calibration, root, root / "rgb",
                  {"calib.yaml", "calib.yml", "camchain.yaml", "camera_info.yaml", "calibration.txt"}, false);
  if (is_file(table)) {
    read_frames(folder, table, root, "", TimeUnit::kSeconds);
  } else if (!pairs.empty()) {
    folder.frames = read_frame_table(*colour_of(pairs),
                                     {root, "", root, TimeUnit::kSeconds, folder.calibration.rate_hz}, folder.notes);
    folder.notes.push_back(root.string() + ": has no rgb.txt; the images in colour of " + pairs.filename().string() +
                           " are taken");
  } else {
    count_frames(folder, root / "rgb", "");
  }
  folder.truth_path = first_file(root, {"groundtruth.txt", "groundtruth.tum"});
  if (folder.truth_path.empty()) {
    folder.truth_path = file_that_ends(root, ".gt.freiburg");  // as the synthetic rooms of ICL and NUIM have it
  }
}

void open_euroc(Folder& folder, const std::string& calibration) {
  for (const char* below : {"mav0/cam0", "cam0", "."}) {
    const fs::path camera = folder.root / below;
    if (is_file(camera / "data.csv")) {
      const fs::path recording = (camera / ".." / "..").lexically_normal();  // the folder that holds mav0
      const fs::path beside = recording / "dso" / "camchain.yaml";           // as the TUM VI data set has it
      const bool is_beside = calibration.empty() && first_file(camera, {"sensor.yaml", "calib.yaml"}).empty();
      set_calibration(folder, is_beside && is_file(beside) ? beside.string() : calibration, camera, camera / "data",
                      {"sensor.yaml", "calib.yaml"}, false);
      read_frames(folder, camera / "data.csv", camera / "data", "", TimeUnit::kNanoseconds);
      folder.truth_path = first_file(folder.root, {"groundtruth.tum"});
      for (const char* truth : {"state_groundtruth_estimate0", "mocap0", "vicon0"}) {
        if (folder.truth_path.empty()) {
          folder.truth_path = first_file(camera / ".." / truth, {"data.csv"}).lexically_normal();
        }
      }
      folder.imu_path = first_file(camera / ".." / "imu0", {"data.csv"}).lexically_normal();
      return;
    }
  }
  if (is_file(folder.root / "times.txt") || is_folder(folder.root / "images")) {
    open_images(folder, calibration, "");
    return;
  }
  refuse_other_layouts(folder.root, "euroc");
  refuse(folder.root.string() +
         ": no mav0/cam0/data.csv inside; give the folder that holds mav0, or mav0 or cam0 itself");
}

/// A film lies beside anything, so no calibration is looked for.
void open_film(Folder& folder, const std::string& calibration) {
  const FilmFacts facts = probe_film(folder.root);
  if (calibration.empty()) {
    refuse(folder.root.string() +
           ": a film says nothing of its camera's lens; give its calibration with --calib FILE (pf-capture can do "
           "without)");
  }
  const fs::path beside = fs::absolute(folder.root).parent_path();
  set_calibration(folder, calibration, beside, beside, {}, false);
  for (const int64_t t_ns : facts.t_ns) {
    folder.frames.push_back({t_ns, folder.root});
  }
  folder.is_film = true;
  folder.film_rate_hz = facts.rate_hz;
  folder.film_size = facts.size;
  folder.pixel_aspect = facts.pixel_aspect;
  folder.notes.insert(folder.notes.end(), facts.notes.begin(), facts.notes.end());
}

}  // namespace

void read_calibration_of(Folder& folder) {
  try {
    folder.calibration = read_calibration(folder.calibration_path.string(), folder.asked);
  } catch (const ReadError& error) {
    throw CalibrationError(error.what());
  }
}

Folder open_folder(const std::string& source, const std::string& calibration, const std::string& camera) {
  const size_t colon = source.find(':');
  const std::string kind = source.substr(0, colon);
  const std::string where = colon == std::string::npos ? "" : source.substr(colon + 1);
  const bool is_film = kind == "video";
  if (kind != "images" && kind != "euroc" && kind != "tum" && !is_film) {
    refuse("source '" + source + "': begins with none of images:, euroc:, tum:, video:");
  }
  if (where.empty()) {
    refuse("source '" + source + "': names no " +
           (is_film ? "film; write video:FILE" : "folder; write " + kind + ":DIR"));
  }
  Folder folder{};
  folder.root = where;
  folder.asked.camera = camera;
  if (is_film) {
    open_film(folder, calibration);
    return folder;
  }
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
