#include "meaning.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include "numbers.h"

namespace pf::sequence {

namespace {

/// Words in names of fields, and the values beside 0, none, false and nothing with which such a field changes nothing.
struct Word {
  const char* word;
  const char* neutral[3];
};

constexpr Word kWords[] = {
    // the model of the lens
    {"model", {"pinhole", "perspective", nullptr}},
    {"projection", {"pinhole", "perspective", nullptr}},
    {"type", {"pinhole", "perspective", "camera"}},
    {"fisheye", {}},
    {"omni", {}},
    {"omnidirectional", {}},
    {"equidistant", {}},
    {"mirror", {}},
    {"xi", {}},
    {"alpha", {}},
    {"beta", {}},
    // further coefficients
    {"distortion", {}},
    {"dist", {}},
    {"coeffs", {}},
    {"coefficients", {}},
    {"prism", {}},
    {"tilt", {}},
    {"tau", {}},
    {"rational", {}},
    {"skew", {}},
    {"shear", {}},
    // images that were changed after, or before, the calibration
    {"distorted", {}},
    {"undistort", {}},
    {"undistorted", {}},
    {"rectify", {}},
    {"rectified", {}},
    {"rectification", {}},
    {"binning", {"1", nullptr, nullptr}},
    {"roi", {}},
    {"crop", {}},
    {"cropped", {}},
    {"resize", {"1", nullptr, nullptr}},
    {"resized", {}},
    {"scale", {"1", nullptr, nullptr}},
    {"downscale", {"1", nullptr, nullptr}},
    {"downsample", {"1", nullptr, nullptr}},
    {"half", {}},
    {"rotate", {}},
    {"rotated", {}},
    {"rotation", {}},
    {"flip", {}},
    {"flipped", {}},
    {"mirrored", {}},
    {"normalized", {}},
    {"normalised", {}},
    {"unit", {"px", "pixel", "pixels"}},
    {"units", {"px", "pixel", "pixels"}},
};

/// Of other sensors, and of what is shown.
constexpr const char* kOthers[] = {"depth", "imu", "gyro", "accel", "lidar", "laser", "velo", "viewer", "pose"};

/// "newDistortion_k4" to new, distortion, k4.
std::vector<std::string> words_of(const std::string& key) {
  std::vector<std::string> words(1);
  bool after_small = false;
  for (const char c : key.substr(0, 64)) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) == 0 || (after_small && std::isupper(letter) != 0)) {
      words.emplace_back();
    }
    after_small = std::islower(letter) != 0;
    if (std::isalnum(letter) != 0) {
      words.back() += static_cast<char>(std::tolower(letter));
    }
  }
  return words;
}

/// k1 to k9, p1 to p4, s1 to s4
bool is_coefficient(const std::string& word) {
  return word.size() == 2 && ((word[0] == 'k' && word[1] >= '1' && word[1] <= '9') ||
                              ((word[0] == 'p' || word[0] == 's') && word[1] >= '1' && word[1] <= '4'));
}

bool is_neutral(const YAML::Node& value, const Word* word, int depth) {
  if (!value.IsDefined() || value.IsNull()) {
    return true;
  }
  if (value.IsScalar()) {
    const std::string text = lower_case(value.Scalar());
    double number = 1.0;
    if (text.empty() || text == "none" || text == "false" || text == "no" || text == "off" ||
        (parse_double(text, number) && number == 0.0)) {
      return true;
    }
    return word != nullptr && std::any_of(std::begin(word->neutral), std::end(word->neutral), [&](const char* neutral) {
             double same = 0.0;
             return neutral != nullptr &&
                    (text == neutral || (parse_double(neutral, same) && parse_double(text, number) && number == same));
           });
  }
  if (depth == 0) {
    return false;
  }
  for (const auto& entry : value) {
    if (!is_neutral(value.IsMap() ? entry.second : YAML::Node(entry), word, depth - 1)) {
      return false;
    }
  }
  return true;
}

}  // namespace

Meaning meaning_of(const std::string& key, const YAML::Node& value) {
  constexpr int kMaxDepth = 2;
  const Word* first = nullptr;
  bool changes = false;
  for (const std::string& part : words_of(key)) {
    if (std::find(std::begin(kOthers), std::end(kOthers), part) != std::end(kOthers)) {
      return Meaning::kNone;
    }
    const Word* word =
        std::find_if(std::begin(kWords), std::end(kWords), [&](const Word& w) { return part == w.word; });
    const bool known = word != std::end(kWords);
    first = first == nullptr && known ? word : first;
    changes = changes || known || is_coefficient(part);
  }
  if (!changes) {
    return Meaning::kNone;
  }
  return is_neutral(value, first, kMaxDepth) ? Meaning::kNeutral : Meaning::kChanged;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace pf::sequence
