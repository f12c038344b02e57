#include "yaml_fields.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "file.h"
#include "meaning.h"
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

/// Letters to insert, remove or change until a becomes b.
size_t edits(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) {
    row[j] = j;
  }
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, changed});
    }
  }
  return row[b.size()];
}

/// Unlikeness of a key to one that is read: 0 for readout or readout_ms and readout_s, Fx and fx; 1 for heigth and height. More than
/// kMisspelled: another word.
constexpr size_t kMisspelled = 2;
size_t unlikeness(const std::string& found, const std::string& known) {
  std::string lower = found.substr(0, 64);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  const size_t unit = known.rfind('_');
  if (unit != std::string::npos && known.size() - unit <= 3 && lower.compare(0, unit, known, 0, unit) == 0) {
    return 0;
  }
  return edits(lower, known) + (known.size() < 4 ? 1 : 0);
}

/// Text of OpenCV's FileStorage, which begins with %YAML:1.0, as YAML: there "name:2" is a field, and files of ORB-SLAM2 have such.
std::string from_opencv(const std::string& text) {
  if (text.compare(0, 6, "%YAML:") != 0) {
    return text;
  }
  std::string yaml;
  bool in_name = true;  // since the line began, only letters that names have
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    yaml += c;
    if (c == ':' && in_name && i > 0 && i + 1 < text.size() && text[i - 1] != '\n' &&
        std::isspace(static_cast<unsigned char>(text[i + 1])) == 0) {
      yaml += ' ';
    }
    in_name = c == '\n' ||
              (in_name && (c == ' ' || c == '_' || c == '.' || std::isalnum(static_cast<unsigned char>(c)) != 0));
  }
  return yaml;
}

bool contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

bool matches(const std::vector<std::string>& patterns, const std::string& word) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
    return pattern.back() == '*' ? word.compare(0, pattern.size() - 1, pattern, 0, pattern.size() - 1) == 0
                                 : word == pattern;
  });
}

}  // namespace

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
    refuse(file + ": holds no fields (\"name: value\" lines); is it the right file?");
  }
  return all;
}

Fields Fields::edited(const std::vector<std::string>& above, const std::string& key, const std::string& name) const {
  YAML::Node copy(YAML::NodeType::Map);
  for (const auto& entry : node_) {
    const std::string found = entry.first.IsScalar() ? entry.first.Scalar() : std::string();
    if (above.empty() && found == key) {
      if (!name.empty()) {
        copy.force_insert(name, entry.second);
      }
    } else if (!above.empty() && found == above.front() && entry.second.IsMap()) {
      const Fields inner(entry.second, file_, {});
      copy.force_insert(found, inner.edited({above.begin() + 1, above.end()}, key, name).node_);
    } else {
      copy.force_insert(entry.first, entry.second);
    }
  }
  return Fields(copy, file_, above_);
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

void Fields::refuse_unknown(const std::string& key, const Known& known, const char* why) const {
  const auto nearest = std::min_element(known.read.begin(), known.read.end(), [&](const auto& a, const auto& b) {
    return unlikeness(key, a) < unlikeness(key, b);
  });
  const bool is_near = nearest != known.read.end() && unlikeness(key, *nearest) <= kMisspelled;
  throw UnknownField(file_ + ": field '" + name_of(one_line(key)) + "' is not known here" + why + ". Known are " +
                         names_of(known.read),
                     above_, key, is_near ? *nearest : "");
}

void Fields::check_keys(const Known& known, std::vector<std::string>& notes) const {
  std::vector<std::string> found, ignored;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : std::string("?");
    const bool read = contains(known.read, key);
    if (contains(found, key)) {
      if (read || known.ours) {
        refuse_field(key, "is there twice; remove the wrong one");
      }
      continue;
    }
    found.push_back(key);
    if (read || matches(known.unused, key)) {
      continue;
    }
    const Meaning meaning = meaning_of(key, entry.second);
    const bool misspelled = std::any_of(known.read.begin(), known.read.end(),
                                        [&](const auto& name) { return unlikeness(key, name) <= kMisspelled; });
    if (meaning == Meaning::kChanged) {
      refuse_unknown(key, known, ", and may change what other fields mean");
    }
    if (known.ours || (misspelled && meaning != Meaning::kNeutral)) {
      refuse_unknown(key, known, "");
    }
    ignored.push_back(key);
  }
  if (!ignored.empty()) {
    notes.push_back(file_ + ": ignored, because not known here: " + one_line(names_of(ignored)));
  }
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

namespace {

/// Whether the fields can be read, as they are or with other fields that are not known renamed or left out.
bool would_be_read(const Fields& fields, const std::function<void(const Fields&)>& read, int edits) {
  try {
    read(fields);
    return true;
  } catch (const UnknownField& unknown) {
    return edits > 0 &&
           ((!unknown.nearest().empty() &&
             would_be_read(fields.edited(unknown.above(), unknown.key(), unknown.nearest()), read, edits - 1)) ||
            would_be_read(fields.edited(unknown.above(), unknown.key(), ""), read, edits - 1));
  } catch (const ReadError&) {
    return false;
  }
}

}  // namespace

void read_with_hints(const Fields& fields, const std::function<void(const Fields&)>& read) {
  constexpr int kMaxEdits = 4;
  try {
    read(fields);
  } catch (const UnknownField& unknown) {
    const std::string line = unknown.what();
    if (!unknown.nearest().empty() &&
        would_be_read(fields.edited(unknown.above(), unknown.key(), unknown.nearest()), read, kMaxEdits)) {
      refuse(line + "; is '" + unknown.nearest() + "' meant?");
    }
    if (would_be_read(fields.edited(unknown.above(), unknown.key(), ""), read, kMaxEdits)) {
      refuse(line + "; remove it if it says nothing of these images");
    }
    refuse(line);
  }
}

}  // namespace pf::sequence
