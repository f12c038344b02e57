#include "folder.h"

#include <planefold_platform/sequence.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "film_facts.h"
#include "numbers.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr size_t kMaxTableBytes = size_t{256} << 20;

enum class Times { kSeconds, kNanoseconds };

/// Names in tables stay inside of their folder.
fs::path inside(const fs::path& folder, const fs::path& table, const Row& row, std::string_view name) {
  const fs::path relative(name);
  bool climbs = relative.is_absolute();
  for (const fs::path& part : relative) {
    climbs = climbs || part == "..";
  }
  if (climbs) {
    refuse(table.string() + " line " + std::to_string(row.number) + ": the image name '" + std::string(name) +
           "' leaves the sequence's folder");
  }
  return folder / relative;
}

/// Appends a frame; times must grow.
/// where  for messages: file and line
void append(std::vector<Frame>& frames, const std::string& where, std::string_view time, int64_t t_ns, fs::path path) {
  if (!frames.empty() && t_ns <= frames.back().t_ns) {
    refuse(where + "the time " + std::string(time) + (t_ns == frames.back().t_ns ? " repeats" : " runs back") +
           "; times must grow from frame to frame");
  }
  frames.push_back({t_ns, std::move(path)});
}

std::string line_of(const fs::path& table, const Row& row) {
  return table.string() + " line " + std::to_string(row.number) + ": ";
}

/// Rows of "time name" or "index time name" to frames.
std::vector<Frame> read_table(const fs::path& table, const std::string& text, const fs::path& images, Times times) {
  std::vector<Frame> frames;
  for (const Row& row : split_rows(text)) {
    const std::string where = line_of(table, row);
    if (row.words.size() < 2) {
      refuse(where + "expected a time and an image name, found '" + std::string(row.words[0]) + "'");
    }
    const size_t at = row.words.size() == 2 ? 0 : row.words.size() == 3 && times == Times::kSeconds ? 1 : 0;
    int64_t t_ns = 0;
    if (!(times == Times::kSeconds ? parse_seconds(row.words[at], t_ns) : parse_integer(row.words[at], t_ns))) {
      refuse(where + "'" + std::string(row.words[at]) + "' is not a time in " +
             (times == Times::kSeconds ? "seconds" : "whole nanoseconds"));
    }
    append(frames, where, row.words[at], t_ns, inside(images, table, row, row.words[at + 1]));
  }
  if (frames.empty()) {
    refuse(table.string() + ": lists no frame");
  }
  return frames;
}

std::vector<Frame> read_table(const fs::path& table, const fs::path& images, Times times) {
  return read_table(table, read_text(table, kMaxTableBytes, "times"), images, times);
}

/// KITTI's times.txt holds seconds alone, as 1.036224e-01.
bool has_times_alone(const std::string& text) {
  const std::vector<Row> rows = split_rows(text);
  double first = 0.0;
  return !rows.empty() && parse_double(rows[0].words[0], first) &&
         std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.words.size() == 1; });
}

/// Seconds, one a row, to frames.
/// names  images in their order, as many as there are times
std::vector<Frame> read_times_alone(const fs::path& table, const std::string& text, const fs::path& images,
                                    const std::vector<std::string>& names) {
  const std::vector<Row> rows = split_rows(text);
  if (rows.size() != names.size()) {
    refuse(table.string() + ": has " + std::to_string(rows.size()) + " times for " + std::to_string(names.size()) +
           " images in " + images.string() + "; without names in it there must be as many of both");
  }
  std::vector<Frame> frames;
  for (const Row& row : rows) {
    const std::string_view word = row.words[0];
    int64_t t_ns = 0;
    double seconds = 0.0;
    if (!parse_seconds(word, t_ns)) {
      if (!parse_double(word, seconds) || !(std::fabs(seconds) < 9e9)) {
        refuse(line_of(table, row) + "'" + std::string(word) + "' is not a time in seconds");
      }
      t_ns = std::llround(1e9 * seconds);
    }
    append(frames, line_of(table, row), word, t_ns, images / names[frames.size()]);
  }
  return frames;
}

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

/// "frame-000012.color.png" to "frame-#.color.png" and the digits "000012 ".
std::string kind_of(const std::string& name, std::string& digits) {
  std::string kind;
  digits.clear();
  for (const char c : name) {
    if (c < '0' || c > '9') {
      kind += c;
      digits += digits.empty() || digits.back() == ' ' ? "" : " ";
    } else {
      kind += kind.empty() || kind.back() != '#' ? "#" : "";
      digits += c;
    }
  }
  return kind;
}

bool is_of_light(const std::string& kind) {
  std::string lower(kind);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* word : {"color", "colour", "rgb", "gray", "grey"}) {
    if (lower.find(word) != std::string::npos) {
      return true;
    }
  }
  return false;
}

/// Whether the number that ends a kind of names, or that follows "cam", is that of a camera: each frame has the same two to four of
/// them, as 000012_10.png and 000012_11.png. Behind a point it is part of a time.
bool names_cameras(const std::string& kind, const std::set<std::string>& digits) {
  constexpr size_t kMinFrames = 4, kMaxCameras = 4;
  std::string lower(kind);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto count = static_cast<size_t>(std::count(kind.begin(), kind.end(), '#'));
  std::istringstream parts(lower);
  std::string before;
  for (size_t k = 0; k < count && std::getline(parts, before, '#'); ++k) {
    const bool last = k > 0 && k + 1 == count && before.back() != '.';
    if (!last && before.find("cam") == std::string::npos) {
      continue;
    }
    std::map<std::string, std::set<std::string>> cameras_of;
    for (const std::string& numbers : digits) {
      std::istringstream words(numbers);
      std::string frame, camera, number;
      for (size_t i = 0; words >> number; ++i) {
        (i == k ? camera : frame) += number + " ";
      }
      cameras_of[frame].insert(camera);
    }
    const std::set<std::string>& first = cameras_of.begin()->second;
    if (cameras_of.size() >= kMinFrames && first.size() >= 2 && first.size() <= kMaxCameras &&
        std::all_of(cameras_of.begin(), cameras_of.end(), [&](const auto& frame) { return frame.second == first; })) {
      return true;
    }
  }
  return false;
}

/// Of images that lie side by side under the same numbers, those of one kind. The others are named in the folder's warning; where it
/// cannot be told which are meant, all are refused.
std::vector<std::string> one_kind(const fs::path& images, const std::vector<std::string>& names, std::string& warning) {
  std::map<std::string, std::set<std::string>> kinds;
  std::string digits;
  for (const std::string& name : names) {
    const std::string kind = kind_of(name, digits);
    kinds[kind].insert(digits);
  }
  for (const auto& [kind, numbers] : kinds) {
    if (names_cameras(kind, numbers)) {
      refuse(images.string() + ": images of several cameras lie side by side (" + names.front() + ", " + names.back() +
             "); keep one camera in a folder, or name the images in times.txt");
    }
  }
  std::set<std::string> side_by_side;
  for (auto a = kinds.begin(); a != kinds.end(); ++a) {
    for (auto b = std::next(a); b != kinds.end(); ++b) {
      const bool share = std::any_of(a->second.begin(), a->second.end(), [&](const std::string& number) {
        return !number.empty() && b->second.count(number) > 0;
      });
      if (share) {
        side_by_side.insert({a->first, b->first});
      }
    }
  }
  if (side_by_side.empty()) {
    return names;
  }
  std::string chosen, all;
  size_t of_light = 0;
  for (const std::string& kind : side_by_side) {
    all += (all.empty() ? "" : ", ") + kind;
    of_light += is_of_light(kind) ? 1 : 0;
    chosen = is_of_light(kind) ? kind : chosen;
  }
  if (of_light != 1) {
    refuse(images.string() + ": images of several kinds lie side by side (" + all +
           "); keep one kind in a folder, or name the images in times.txt");
  }
  std::vector<std::string> kept;
  std::copy_if(names.begin(), names.end(), std::back_inserter(kept),
               [&](const std::string& name) { return kind_of(name, digits) == chosen; });
  warning = "; of " + all + " those of " + chosen + " are taken";
  return kept;
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

void open_images(Folder& folder, const std::string& calibration) {
  const fs::path& root = folder.root;
  refuse_other_layouts(root);
  find_calibration(folder, calibration, root,
                   {"calib.yaml", "calib.yml", "camchain.yaml", "sensor.yaml", "camera_info.yaml", "calib.txt"});
  fs::path images = root;
  for (const char* below : {"image_0", "images"}) {
    images = is_folder(root / below) ? root / below : images;
  }
  const fs::path times = root / "times.txt";
  if (is_file(times)) {
    const std::string text = read_text(times, kMaxTableBytes, "times");
    if (has_times_alone(text)) {
      std::string choice;
      folder.frames = read_times_alone(times, text, images, one_kind(images, list_images(images), choice));
      folder.warning = choice.empty() ? "" : times.string() + ": names no images" + choice;
    } else {
      folder.frames = read_table(times, text, images, Times::kSeconds);
    }
  } else {
    const double rate = folder.calibration.rate_hz > 0.0 ? folder.calibration.rate_hz : 30.0;
    std::string choice;
    for (const std::string& name : one_kind(images, list_images(images), choice)) {
      const double t = static_cast<double>(folder.frames.size()) / rate;
      folder.frames.push_back({static_cast<int64_t>(std::llround(t * 1e9)), images / name});
    }
    if (folder.frames.empty()) {
      refuse(images.string() + ": holds no PNG, JPEG or PGM image; check the path");
    }
    char text[64];
    std::snprintf(text, sizeof(text), "%g frames per second", rate);
    folder.warning =
        root.string() + ": no times.txt; the images are taken in the order of their names at " + text + choice;
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
  folder.frames = read_table(table, folder.root, Times::kSeconds);
  folder.truth_path = first_file(folder.root, {"groundtruth.txt", "groundtruth.tum"});
}

void open_euroc(Folder& folder, const std::string& calibration) {
  for (const char* below : {"mav0/cam0", "cam0", "."}) {
    const fs::path camera = folder.root / below;
    if (is_file(camera / "data.csv")) {
      find_calibration(folder, calibration, camera, {"sensor.yaml", "calib.yaml"});
      folder.frames = read_table(camera / "data.csv", camera / "data", Times::kNanoseconds);
      folder.truth_path = first_file(folder.root, {"groundtruth.tum"});
      if (folder.truth_path.empty()) {
        folder.truth_path = first_file(camera / ".." / "state_groundtruth_estimate0", {"data.csv"}).lexically_normal();
      }
      folder.imu_path = first_file(camera / ".." / "imu0", {"data.csv"}).lexically_normal();
      return;
    }
  }
  if (is_file(folder.root / "times.txt") || is_folder(folder.root / "images")) {
    open_images(folder, calibration);
    return;
  }
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
  find_calibration(folder, calibration, {}, {});
  for (const int64_t t_ns : facts.t_ns) {
    folder.frames.push_back({t_ns, folder.root});
  }
  folder.is_film = true;
  folder.film_rate_hz = facts.rate_hz;
  folder.warning = facts.warning;
}

}  // namespace

Folder open_folder(const std::string& source, const std::string& calibration) {
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
  if (is_film) {
    open_film(folder, calibration);
    return folder;
  }
  require_folder(folder.root);
  if (kind == "images") {
    open_images(folder, calibration);
  } else if (kind == "tum") {
    open_tum(folder, calibration);
  } else {
    open_euroc(folder, calibration);
  }
  return folder;
}

}  // namespace pf::sequence
