#include "image_list.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "mask.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

/// Names of one kind: in their order, and with their numbers.
struct Kind {
  std::vector<std::string> names;
  std::set<std::string> numbers;
};

using Kinds = std::map<std::string, Kind>;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

char lower_case(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), lower_case);
  return text;
}

/// Text order, but runs of digits compare as numbers.
bool natural_less(const std::string& a, const std::string& b) {
  size_t i = 0;
  size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      size_t i_end = i;
      size_t j_end = j;
      while (i_end < a.size() && is_digit(a[i_end])) ++i_end;
      while (j_end < b.size() && is_digit(b[j_end])) ++j_end;
      while (i + 1 < i_end && a[i] == '0') ++i;
      while (j + 1 < j_end && b[j] == '0') ++j;
      if (i_end - i != j_end - j) {
        return i_end - i < j_end - j;
      }
      const int order = a.compare(i, i_end - i, b, j, j_end - j);
      if (order != 0) {
        return order < 0;
      }
      i = i_end;
      j = j_end;
    } else {
      if (a[i] != b[j]) {
        return a[i] < b[j];
      }
      ++i;
      ++j;
    }
  }
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

/// Whatever the case of letters.
bool matches(std::string_view name, std::string_view pattern) {
  if (pattern.empty()) {
    return name.empty();
  }
  if (pattern[0] != '*') {
    return !name.empty() && lower_case(name[0]) == lower_case(pattern[0]) && matches(name.substr(1), pattern.substr(1));
  }
  while (pattern.size() > 1 && pattern[1] == '*') pattern.remove_prefix(1);
  for (size_t i = 0; i <= name.size(); ++i) {
    if (matches(name.substr(i), pattern.substr(1))) {
      return true;
    }
  }
  return false;
}

/// The source that takes one kind alone: "images:DIR/left_*.png".
std::string source_of(const fs::path& folder, std::string kind) {
  std::replace(kind.begin(), kind.end(), '#', '*');
  return "'images:" + (folder / kind).string() + "'";
}

bool has_word(const std::string& kind, std::initializer_list<const char*> words) {
  const std::string text = lower(kind);
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

bool is_of_light(const std::string& kind) { return has_word(kind, {"color", "colour", "rgb", "gray", "grey"}); }

bool is_preview(const std::string& kind) { return has_word(kind, {"thumb", "preview", "poster", "screenshot"}); }

/// Whether the number that ends a kind of names, or that follows "cam", is that of a camera: each frame has the same two to four of
/// them, as 000012_10.png and 000012_11.png. Behind a point it is part of a time. camera: the kind with the first of them in its place.
bool names_cameras(const std::string& kind, const std::set<std::string>& digits, std::string& camera_kind) {
  constexpr size_t kMinFrames = 4, kMaxCameras = 4;
  const std::string text = lower(kind);
  const auto count = static_cast<size_t>(std::count(kind.begin(), kind.end(), '#'));
  std::istringstream parts(text);
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
        (i == k ? camera : frame) += number + (i == k ? "" : " ");
      }
      cameras_of[frame].insert(camera);
    }
    const std::set<std::string>& first = cameras_of.begin()->second;
    if (cameras_of.size() >= kMinFrames && first.size() >= 2 && first.size() <= kMaxCameras &&
        std::all_of(cameras_of.begin(), cameras_of.end(), [&](const auto& frame) { return frame.second == first; })) {
      camera_kind = kind;
      size_t at = camera_kind.find('#');
      for (size_t i = 0; i < k; ++i) at = camera_kind.find('#', at + 1);
      camera_kind.replace(at, 1, *first.begin());
      return true;
    }
  }
  return false;
}

void refuse_cameras(const fs::path& folder, const Kinds& kinds, const std::vector<std::string>& names) {
  std::string camera;
  for (const auto& [kind, files] : kinds) {
    if (names_cameras(kind, files.numbers, camera)) {
      refuse(folder.string() + ": images of several cameras lie side by side (" + names.front() + ", " + names.back() +
             "); name one camera, as in --source " + source_of(folder, camera) +
             ", keep one in a folder, or name the images in times.txt");
    }
  }
}

std::string count_of(size_t count) { return std::to_string(count) + (count == 1 ? " image" : " images"); }

/// Takes kinds out of kinds that are no part of a sequence: previews, and single files beside many of one kind.
void leave_out_single_files(const fs::path& folder, Kinds& kinds, std::vector<std::string>& notes) {
  constexpr size_t kShare = 20, kShareWithoutNumber = 3, kMost = 3;
  size_t largest = 0;
  for (const auto& [kind, files] : kinds) {
    largest = std::max(largest, is_preview(kind) ? 0 : files.names.size());
  }
  std::string left_out;
  size_t count = 0;
  for (auto kind = kinds.begin(); kind != kinds.end();) {
    const size_t size = kind->second.names.size();
    const size_t share = kind->first.find('#') == std::string::npos ? kShareWithoutNumber : kShare;
    const bool single = size <= kMost && share * size <= largest && !is_of_light(kind->first);
    if (largest > 1 && (single || is_preview(kind->first))) {
      left_out += (left_out.empty() ? "" : ", ") + (size == 1 ? kind->second.names[0] : kind->first);
      count += size;
      kind = kinds.erase(kind);
    } else {
      ++kind;
    }
  }
  if (count > 0) {
    notes.push_back(folder.string() + ": " + count_of(count) +
                    " left out, named otherwise than the sequence: " + left_out + " (times.txt can name them)");
  }
}

/// Kinds that share a number with another one: depth beside colour, left beside right.
std::set<std::string> side_by_side(const Kinds& kinds) {
  std::set<std::string> found;
  for (auto a = kinds.begin(); a != kinds.end(); ++a) {
    for (auto b = std::next(a); b != kinds.end(); ++b) {
      const auto& numbers = b->second.numbers;
      if (std::any_of(a->second.numbers.begin(), a->second.numbers.end(),
                      [&](const std::string& number) { return !number.empty() && numbers.count(number) > 0; })) {
        found.insert({a->first, b->first});
      }
    }
  }
  return found;
}

/// Of kinds side by side the one that is in colour or grey.
void keep_light(const fs::path& folder, Kinds& kinds, std::vector<std::string>& notes) {
  const std::set<std::string> beside = side_by_side(kinds);
  if (beside.empty()) {
    return;
  }
  std::string chosen, all, largest;
  size_t of_light = 0, most = 0;
  for (const std::string& kind : beside) {
    if (kinds[kind].names.size() > most) {
      most = kinds[kind].names.size();
      largest = kind;
    }
    all += (all.empty() ? "" : ", ") + kind;
    of_light += is_of_light(kind) ? 1 : 0;
    chosen = is_of_light(kind) ? kind : chosen;
  }
  if (of_light != 1) {
    refuse(folder.string() + ": images of several kinds lie side by side (" + all + "); name one, as in --source " +
           source_of(folder, largest) + ", keep one kind in a folder, or name the images in times.txt");
  }
  Kind kept = kinds[chosen];
  kinds.clear();
  kinds[chosen] = std::move(kept);
  notes.push_back(folder.string() + ": of " + all + " those of " + chosen + " are taken");
}

}  // namespace

bool is_image_name(const fs::path& name) {
  const std::string extension = lower(name.extension().string());
  return name.filename().string()[0] != '.' &&
         (extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".pgm");
}

std::vector<std::string> list_images(const fs::path& folder, const std::string& pattern) {
  require_folder(folder);
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (is_image_name(entry->path()) && name != kMaskName && (pattern.empty() || matches(name, pattern))) {
      names.push_back(name);
    }
  }
  if (error) {
    refuse(folder.string() + ": cannot be listed (" + error.message() + "); check its permissions");
  }
  std::sort(names.begin(), names.end(), natural_less);
  return names;
}

std::string kind_of(const std::string& name, std::string& numbers) {
  std::string kind;
  numbers.clear();
  for (const char c : name) {
    if (!is_digit(c)) {
      kind += c;
      numbers += numbers.empty() || numbers.back() == ' ' ? "" : " ";
    } else {
      kind += kind.empty() || kind.back() != '#' ? "#" : "";
      numbers += c;
    }
  }
  const size_t point = std::min(kind.rfind('.'), kind.size());
  std::transform(kind.begin() + static_cast<std::ptrdiff_t>(point), kind.end(),
                 kind.begin() + static_cast<std::ptrdiff_t>(point), lower_case);
  return kind;
}

std::vector<std::string> one_sequence(const fs::path& folder, const std::vector<std::string>& names,
                                      std::vector<std::string>& notes) {
  Kinds kinds;
  std::string numbers;
  for (const std::string& name : names) {
    const std::string kind = kind_of(name, numbers);
    kinds[kind].names.push_back(name);
    kinds[kind].numbers.insert(numbers);
  }
  refuse_cameras(folder, kinds, names);
  leave_out_single_files(folder, kinds, notes);
  keep_light(folder, kinds, notes);
  std::set<std::string> kept;
  for (const auto& [kind, files] : kinds) {
    kept.insert(files.names.begin(), files.names.end());
  }
  std::vector<std::string> result;
  std::copy_if(names.begin(), names.end(), std::back_inserter(result),
               [&](const std::string& name) { return kept.count(name) > 0; });
  return result;
}

}  // namespace pf::sequence
