#include "yaml_fields.h"

#include <cctype>
#include <cmath>

#include "numbers.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

/// Nesting that text could reach, counted without parsing: brackets, and the blanks or dashes that a line begins with.
/// yaml-cpp recurses once per level, so that this bounds the stack.
bool too_deep(const std::string& text) {
  int brackets = 0;
  int dashes = 0;
  bool beginning = true;
  for (char c : text) {
    if (c == '\n') {
      beginning = true;
      dashes = 0;
      continue;
    }
    if (beginning && (c == '-' || c == '?' || c == ':')) {
      ++dashes;
    } else if (c != ' ' && c != '\t') {
      beginning = false;
    }
    brackets += (c == '[' || c == '{') ? 1 : 0;
    brackets -= ((c == ']' || c == '}') && brackets > 0) ? 1 : 0;
    if (brackets > kMaxYamlDepth || dashes > kMaxYamlDepth) {
      return true;
    }
  }
  return false;
}

std::string one_line(std::string text) {
  for (char& c : text) {
    c = static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return text.size() > 200 ? text.substr(0, 200) + ".." : text;
}

}  // namespace

Fields::Fields(const std::string& text, const std::string& file) : file_(file) {
  if (text.size() > kMaxYamlBytes || text.find('\0') != std::string::npos || too_deep(text)) {
    refuse(file + ": is not a YAML file of the expected kind (too large, too deep, or binary)");
  }
  try {
    node_ = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    refuse(file + ": is not valid YAML: " + one_line(error.what()));
  }
  if (!node_.IsMap()) {
    refuse(file + ": holds no fields (\"name: value\" lines); is it the right file?");
  }
}

void Fields::refuse_field(const std::string& key, const std::string& why) const {
  refuse(file_ + ": field '" + prefix_ + key + "' " + one_line(why));
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

bool Fields::has(const std::string& key) const {
  const YAML::Node found = static_cast<const YAML::Node&>(node_)[key];
  return found.IsDefined() && !found.IsNull();
}

Fields Fields::below(const std::string& key) const {
  const YAML::Node node = at(key);
  if (!node.IsMap()) {
    refuse_field(key, "must hold fields of its own");
  }
  return Fields(node, file_, prefix_ + key + ".");
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
