/// Names and units of columns: lib/docs/reference/files.md lists whose they are.
#include "imu_header.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <iterator>

#include "time_unit.h"

namespace pf::sequence {

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

struct Unit {
  const char* name;
  double factor;
};

constexpr Unit kRates[] = {
    {"rad/s", 1.0},          {"rads-1", 1.0},         {"rad/sec", 1.0},       {"radian/s", 1.0},
    {"radians/s", 1.0},      {"rad_s", 1.0},          {"rads", 1.0},          {"radps", 1.0},
    {"rad_per_s", 1.0},      {"mrad/s", 1e-3},        {"deg/s", kDegree},     {"degs-1", kDegree},
    {"deg/sec", kDegree},    {"degree/s", kDegree},   {"degrees/s", kDegree}, {"deg_s", kDegree},
    {"degps", kDegree},      {"deg_per_s", kDegree},  {"dps", kDegree},       {"\xc2\xb0/s", kDegree},
    {"\xc2\xba/s", kDegree}, {"mdps", 1e-3 * kDegree}};

constexpr Unit kAccelerations[] = {{"m/s2", 1.0},
                                   {"ms-2", 1.0},
                                   {"m/s/s", 1.0},
                                   {"m/sec2", 1.0},
                                   {"m_s2", 1.0},
                                   {"ms2", 1.0},
                                   {"mps2", 1.0},
                                   {"mpss", 1.0},
                                   {"m_per_s2", 1.0},
                                   {"g", kStandardGravity},
                                   {"gs", kStandardGravity},
                                   {"g-force", kStandardGravity},
                                   {"mg", 1e-3 * kStandardGravity}};

double factor_of(const Unit* begin, const Unit* end, const std::string& unit) {
  const Unit* found = std::find_if(begin, end, [&](const Unit& u) { return unit == u.name; });
  return found == end ? 0.0 : found->factor;
}

bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

std::string small(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// "rad s^-1" to "rads-1", "m/s\u00b2" to "m/s2".
std::string plain_unit(const std::string& text) {
  std::string unit;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "\xc2\xb2") == 0) {
      unit += '2';
      ++i;
    } else if (text[i] != ' ' && text[i] != '^' && text[i] != '*') {
      unit += text[i];
    }
  }
  return unit;
}

bool is_axis(char c) { return c >= 'x' && c <= 'z'; }

bool is_unit_of_time(const std::string& unit) {
  TimeUnit parsed = TimeUnit::kSeconds;
  return parse_unit(unit, parsed);
}

/// Cuts the unit off a name in small letters: in brackets, behind " in ", or behind an underscore ("gyro_x_dps", "time_ns").
std::string cut_unit(std::string& name) {
  const size_t open = name.find_first_of("[(");
  if (open != std::string::npos) {
    const size_t close = std::min(name.find_first_of("])", open), name.size());
    const std::string unit = plain_unit(name.substr(open + 1, close - open - 1));
    name.erase(open);
    return unit;
  }
  const size_t in = name.rfind(" in ");
  if (in != std::string::npos) {
    const std::string unit = plain_unit(name.substr(in + 4));
    name.erase(in);
    return unit;
  }
  for (size_t at = name.find('_'); at != std::string::npos; at = name.find('_', at + 1)) {
    const std::string tail = name.substr(at + 1);
    const bool of_axis =
        at > 0 && is_axis(name[at - 1]) && (factor_of_rate(tail) > 0.0 || factor_of_acceleration(tail) > 0.0);
    if (of_axis || is_unit_of_time(tail)) {
      name.erase(at);
      return tail;
    }
  }
  return "";
}

bool has(const std::string& name, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return name.find(word) != std::string::npos; });
}

bool is_one_of(const std::string& name, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* word) { return name == word; });
}

/// Of three columns with an axis, by what they have in common: "gyrorotation", "w", "fieldlinearacceleration".
ImuRole role_of_axes(const std::string& family) {
  if (has(family, {"bias", "covariance", "mag", "quat", "orient", "attitude", "euler", "angle", "rotationvector",
                   "rotvec", "angularacc", "position", "compass"})) {
    return ImuRole::kOther;
  }
  if (has(family, {"gravity", "grav"})) {
    return ImuRole::kGravity;
  }
  if (has(family, {"gyr", "omega", "ang", "rot"}) || is_one_of(family, {"g", "w", "alpha", "rv"}) ||
      family.rfind("wrs", 0) == 0) {
    return ImuRole::kGyro;
  }
  if (has(family, {"vel"})) {
    return ImuRole::kOther;
  }
  if (has(family, {"user", "withoutg", "nograv"})) {
    return ImuRole::kMotion;
  }
  if (has(family, {"lin"})) {
    return ImuRole::kAccelOrMotion;
  }
  if (has(family, {"total"}) && has(family, {"acc"})) {
    return ImuRole::kTotal;
  }
  if (has(family, {"acc", "specificforce", "force"}) || is_one_of(family, {"a", "f", "gf", "sf"}) ||
      family.rfind("ars", 0) == 0) {
    return ImuRole::kAccel;
  }
  return family.empty() ? ImuRole::kPlain : ImuRole::kOther;
}

}  // namespace

double factor_of_rate(const std::string& unit) { return factor_of(std::begin(kRates), std::end(kRates), unit); }

double factor_of_acceleration(const std::string& unit) {
  return factor_of(std::begin(kAccelerations), std::end(kAccelerations), unit);
}

ImuColumn read_imu_column(const std::string& written) {
  ImuColumn column;
  std::string name = small(written);
  column.unit = cut_unit(name);
  std::string letters;
  std::copy_if(name.begin(), name.end(), std::back_inserter(letters), is_letter);
  if (has(letters, {"time", "stamp", "epoch"}) || letters == "t") {
    const bool of_another = has(letters, {"location", "gps", "pedometer", "activity", "altimeter", "heading", "device",
                                          "avaudio", "magnet", "battery", "duration"});
    const bool for_people =
        has(letters, {"logging", "elapsed", "since", "unix", "system", "text", "date"}) && !has(letters, {"stamp"});
    column.role = of_another ? ImuRole::kOther : for_people ? ImuRole::kElapsed : ImuRole::kTime;
    column.family = letters;
    return column;
  }
  if (letters == "secondselapsed") {
    column.role = ImuRole::kElapsed;
    column.unit = "s";
    return column;
  }
  if (letters.empty()) {
    return column;
  }
  const bool leads = letters.size() > 1 && !is_axis(letters.back()) && is_axis(letters.front()) && name.size() > 1 &&
                     !is_letter(name[1]);  // "x_acc"
  if (!leads && !is_axis(letters.back())) {
    return column;
  }
  column.axis = (leads ? letters.front() : letters.back()) - 'x';
  column.family = leads ? letters.substr(1) : letters.substr(0, letters.size() - 1);
  column.role = role_of_axes(column.family);
  column.is_ios = is_one_of(column.family, {"accelerometeracceleration", "motionuseracceleration", "motiongravity",
                                            "useracceleration", "useraccel"});
  return column;
}

}  // namespace pf::sequence
