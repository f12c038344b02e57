#include "yaml_fields.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "file.h"
#include "meaning.h"
#include "numbers.h"
#include "refuse.h"
#include "yaml_text.h"

namespace pf::sequence {

Fields::Fields(const std::string& text, const std::string& file) : Fields(documents(text, file).front()) {}

std::vector<Fields> Fields::documents(const std::string& text, const std::string& file) {
  if (text.size() > kMaxYamlBytes || text.find('\0') != std::string::npos || too_deep(text)) {
    refuse(file + ": is not a YAML file of the expected kind (too large, too deep, or binary)");
  }
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '<') {
    refuse(file + ": is XML, and only YAML is read; OpenCV writes it to a name that ends in .yml");
  }
  std::vector<YAML::Node> nodes;
  try {
    nodes = YAML::LoadAll(from_opencv(text));
  } catch (const YAML::Exception& error) {
    refuse(file + ": is not valid YAML: " + one_line(error.what()));
  }
  std::vector<Fields> all;
  for (const YAML::Node& node : nodes) {
    if (node.IsMap()) {
      all.push_back(Fields(node, file, {}));
    } else if (node.IsDefined() && !node.IsNull()) {
      all.clear();
      break;
    }
  }
  if (all.empty()) {
    throw NoFields(file + ": holds no fields (\"name: value\" lines); is it the right file?");
  }
  return all;
}

std::string Fields::name_of(const std::string& key) const {
  std::string name;
  for (const std::string& above : above_) {
    name += above + ".";
  }
  return name + key;
}

std::string Fields::names_of(const std::vector<std::string>& keys) const {
  std::string names;
  for (const std::string& key : keys) {
    names += (names.empty() ? "'" : ", '") + name_of(key) + "'";
  }
  return names;
}

void Fields::refuse_field(const std::string& key, const std::string& why) const {
  refuse(file_ + ": field '" + name_of(key) + "' " + one_line(why));
}

YAML::Node Fields::at(const std::string& key) const {
  YAML::Node found;
  try {
    found.reset(static_cast<const YAML::Node&>(node_)[key]);
  } catch (const YAML::Exception&) {
    refuse_field(key, "is missing; add it");
  }
  if (!found.IsDefined() || found.IsNull()) {
    refuse_field(key, "is missing; add it");
  }
  return found;
}

std::vector<std::string> Fields::keys() const {
  std::vector<std::string> all;
  for (const auto& entry : node_) {
    all.push_back(entry.first.IsScalar() ? entry.first.Scalar() : std::string());
  }
  return all;
}

bool Fields::is_map(const std::string& key) const { return has(key) && at(key).IsMap(); }

bool Fields::is_scalar(const std::string& key) const { return has(key) && at(key).IsScalar(); }

bool Fields::has(const std::string& key) const {
  const YAML::Node found = static_cast<const YAML::Node&>(node_)[key];
  return found.IsDefined() && !found.IsNull();
}

bool Fields::has_any(const std::vector<std::string>& keys) const {
  return std::any_of(keys.begin(), keys.end(), [&](const std::string& key) { return has(key); });
}

Fields Fields::below(const std::string& key) const {
  const YAML::Node node = at(key);
  if (!node.IsMap()) {
    refuse_field(key, "must hold fields of its own");
  }
  std::vector<std::string> above = above_;
  above.push_back(key);
  return Fields(node, file_, above);
}

Fields Fields::with_those_below(const std::string& key) const {
  YAML::Node all(YAML::NodeType::Map);
  for (const auto& entry : below(key).node_) {
    if (entry.first.IsScalar() && has(entry.first.Scalar())) {
      below(key).refuse_field(entry.first.Scalar(), "is there above '" + key + "' too; remove one of them");
    }
    all.force_insert(entry.first, entry.second);
  }
  for (const auto& entry : node_) {
    all.force_insert(entry.first, entry.second);
  }
  return Fields(all, file_, above_);
}

std::string Fields::text(const std::string& key) const {
  const YAML::Node node = at(key);
  if (!node.IsScalar()) {
    refuse_field(key, "must be a single word");
  }
  return node.Scalar();
}

std::string Fields::text_or(const std::string& key, const std::string& otherwise) const {
  return has(key) ? text(key) : otherwise;
}

double Fields::to_number(const YAML::Node& node, const std::string& key) const {
  double value = 0.0;
  // YAML writes .nan and .inf where the parser of numbers expects nan and inf.
  std::string word = node.IsScalar() ? node.Scalar() : std::string();
  const size_t dot = word.find_first_not_of("+-");
  if (dot != std::string::npos && dot + 1 < word.size() && word[dot] == '.' &&
      std::isalpha(static_cast<unsigned char>(word[dot + 1])) != 0) {
    word.erase(dot, 1);
  }
  if (!node.IsScalar() || !parse_double(word, value)) {
    refuse_field(key, "must be a number" + (node.IsScalar() ? ", not '" + node.Scalar() + "'" : std::string()));
  }
  if (!std::isfinite(value)) {
    refuse_field(key, "is not a finite number ('" + node.Scalar() + "')");
  }
  return value;
}

double Fields::number(const std::string& key) const { return to_number(at(key), key); }

double Fields::number_or(const std::string& key, double otherwise) const { return has(key) ? number(key) : otherwise; }

int Fields::integer(const std::string& key) const {
  const double value = number(key);
  if (value != std::floor(value) || std::fabs(value) > 1e9) {
    refuse_field(key, "must be a whole number, not '" + text(key) + "'");
  }
  return static_cast<int>(value);
}

bool Fields::flag_or(const std::string& key, bool otherwise) const {
  if (!has(key)) {
    return otherwise;
  }
  const std::string word = lower_case(text(key));
  if (word != "0" && word != "1" && word != "false" && word != "true" && word != "no" && word != "yes") {
    refuse_field(key, "is '" + text(key) + "'; known are 0 and 1");
  }
  return word == "1" || word == "true" || word == "yes";
}

std::vector<double> Fields::numbers_in_text(const std::string& key) const {
  std::vector<double> values;
  const std::string words = text(key);
  for (const Row& row : split_rows(words)) {
    for (const std::string_view word : row.words) {
      double value = 0.0;
      if (!parse_double(word, value) || !std::isfinite(value)) {
        refuse_field(key, "holds '" + std::string(word) + "', which is not a finite number");
      }
      values.push_back(value);
    }
  }
  return values;
}

std::vector<double> Fields::vector(const std::string& key, size_t limit) const { return flat(key, limit, 0); }

std::vector<double> Fields::flat(const std::string& key, size_t limit, size_t columns) const {
  const YAML::Node node = at(key);
  if (node.IsMap()) {
    return below(key).numbers("data", limit);
  }
  std::vector<double> values;
  for (const YAML::Node& entry : node) {
    if (entry.IsSequence() && columns > 0 && entry.size() != columns) {
      refuse_field(key, "must have " + std::to_string(columns) + " numbers in every row");
    }
    const std::vector<double> row =
        entry.IsSequence() ? to_numbers(entry, key, limit) : std::vector<double>{to_number(entry, key)};
    values.insert(values.end(), row.begin(), row.end());
    if (values.size() > limit) {
      break;
    }
  }
  if (!node.IsSequence() || values.size() > limit) {
    refuse_field(key, "must be a list of at most " + std::to_string(limit) + " numbers");
  }
  return values;
}

std::vector<double> Fields::matrix(const std::string& key, size_t rows, size_t columns) const {
  const std::vector<double> values = flat(key, rows * columns, columns);
  const std::string size = std::to_string(rows) + " x " + std::to_string(columns);
  const Fields inside = is_map(key) ? below(key) : *this;
  if (values.size() != rows * columns ||
      (is_map(key) && inside.has("rows") && inside.number("rows") != static_cast<double>(rows))) {
    inside.refuse_field(is_map(key) ? "data" : key, "must be a matrix of " + size + " numbers");
  }
  return values;
}

std::vector<double> Fields::to_numbers(const YAML::Node& node, const std::string& key, size_t limit) const {
  if (!node.IsSequence() || node.size() > limit) {
    refuse_field(key, "must be a list of at most " + std::to_string(limit) + " numbers");
  }
  std::vector<double> values;
  for (const YAML::Node& entry : node) {
    values.push_back(to_number(entry, key));
  }
  return values;
}

std::vector<double> Fields::numbers(const std::string& key, size_t limit) const {
  return to_numbers(at(key), key, limit);
}

std::vector<std::vector<double>> Fields::rows(const std::string& key, size_t limit, size_t columns) const {
  const YAML::Node node = at(key);
  if (!node.IsSequence() || node.size() > limit) {
    refuse_field(key, "must be a list of at most " + std::to_string(limit) + " entries");
  }
  std::vector<std::vector<double>> values;
  for (const YAML::Node& entry : node) {
    values.push_back(to_numbers(entry, key, columns));
    if (values.back().size() != columns) {
      refuse_field(key, "must have " + std::to_string(columns) + " numbers in every entry");
    }
  }
  return values;
}

}  // namespace pf::sequence
