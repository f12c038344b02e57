#include "fields.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace pf::walls {

namespace {

/// Follows a parser through the text, so that an error can say where it is; refuses a field that is there twice.
class Follower : public nlohmann::json_sax<Json> {
 public:
  const std::string& error() const { return error_; }

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t&) override { return value(); }
  bool binary(binary_t&) override { return value(); }
  bool string(string_t& text) override {
    if (!levels_.empty() && levels_.back().key == "name") levels_.back().name = text.substr(0, kShown);
    return value();
  }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    Level& level = levels_.back();
    level.key = name.substr(0, kShown);
    if (level.keys.insert(name).second) return true;
    error_ = place() + "is there twice";
    return false;
  }
  bool parse_error(std::size_t position, const std::string& token, const nlohmann::detail::exception&) override {
    std::string shown;
    for (const char c : token.substr(0, kShown)) shown += c >= ' ' && c <= '~' ? c : '?';
    error_ = place() + "is no JSON at character " + std::to_string(position) +
             (shown.empty() ? "" : ", near '" + shown + "'") + "; numbers must be finite";
    return false;
  }

 private:
  static constexpr size_t kShown = 40;
  static constexpr size_t kMaxDepth = 16;
  struct Level {
    bool is_list = false;
    size_t index = 0;
    std::string key, name;
    std::set<std::string> keys;
  };

  bool value() {
    if (!levels_.empty() && levels_.back().is_list) ++levels_.back().index;
    return true;
  }
  bool open(bool is_list) {
    if (levels_.size() == kMaxDepth) {
      error_ = place() + "is nested too deeply";
      return false;
    }
    levels_.emplace_back();
    levels_.back().is_list = is_list;
    return true;
  }
  bool close() {
    levels_.pop_back();
    return value();
  }
  /// "wall 'north': field 'to' ": the list and the object in it, by name or number, and the innermost field.
  std::string place() const {
    std::string wall, field;
    for (size_t i = 0; i < levels_.size(); ++i) {
      if (i == 1 && levels_[i].is_list)
        wall = std::string(levels_[0].key == "faces" ? "face " : "wall ") + std::to_string(levels_[i].index + 1);
      if (i == 2 && !levels_[i].is_list && !levels_[i].name.empty()) wall = "wall '" + levels_[i].name + "'";
      if (!levels_[i].is_list && !levels_[i].key.empty()) field = levels_[i].key;
    }
    return (wall.empty() ? "" : wall + ": ") + (field.empty() ? "" : "field '" + field + "' ");
  }

  std::vector<Level> levels_;
  std::string error_;
};

}  // namespace

Json parse_json(const std::string& text, const std::string& file) {
  Follower follower;
  if (!Json::sax_parse(text, &follower)) throw ReadError(file + ": " + follower.error());
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw ReadError(file + ": is no file of walls; it must be an object with planefold_walls: 1");
  return json;
}

Fields::Fields(const Json& object, std::string file, std::string where)
    : object_(object), file_(std::move(file)), where_(std::move(where)) {
  if (!object.is_object()) throw ReadError(file_ + ": " + where_ + ": must be an object, { .. }");
}

void Fields::refuse(const char* key, const std::string& why) const {
  throw ReadError(file_ + ": " + (where_.empty() ? "" : where_ + ": ") + "field '" + key + "' " + why);
}

void Fields::check_keys(std::initializer_list<const char*> required,
                        std::initializer_list<const char*> optional) const {
  for (const char* key : required)
    if (!has(key)) refuse(key, "is missing");
  const auto is_one = [](const std::string& key) { return [&key](const char* known) { return key == known; }; };
  for (const auto& item : object_.items()) {
    const std::string key = item.key().substr(0, 60);
    if (!std::any_of(required.begin(), required.end(), is_one(key)) &&
        !std::any_of(optional.begin(), optional.end(), is_one(key)))
      refuse(key.c_str(), "is not known");
  }
}

double Fields::number_of(const Json& value, const char* key) const {
  if (!value.is_number()) refuse(key, "must be a number");
  const double number = value.get<double>();
  if (!std::isfinite(number)) refuse(key, "is not finite");
  constexpr double kLargest = 1e5;  // [m]
  if (std::fabs(number) > kLargest) refuse(key, "is larger than 100000; the unit is the metre, or the degree");
  return number;
}

double Fields::number(const char* key) const { return number_of(at(key), key); }

double Fields::positive(const char* key, double largest) const {
  const double value = number(key);
  char why[96];
  std::snprintf(why, sizeof(why), "is %g; more than 0 and at most %g is possible", value, largest);
  if (!(value > 0.0) || value > largest) refuse(key, why);
  return value;
}

std::vector<double> Fields::numbers_of(const Json& list, const char* key, size_t count) const {
  if (!list.is_array() || list.size() != count) refuse(key, "must be " + std::to_string(count) + " numbers");
  std::vector<double> numbers;
  for (const Json& value : list) numbers.push_back(number_of(value, key));
  return numbers;
}

std::vector<double> Fields::numbers(const char* key, size_t count) const { return numbers_of(at(key), key, count); }

std::string Fields::word(const char* key, std::initializer_list<const char*> known) const {
  std::string all;
  for (const char* name : known) {
    if (at(key).is_string() && at(key).get<std::string>() == name) return name;
    all += (all.empty() ? "" : ", ") + std::string(name);
  }
  refuse(key, "must be one of " + all);
}

}  // namespace pf::walls
