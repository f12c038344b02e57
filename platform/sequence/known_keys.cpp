/// Which keys of a map are known, and what is said of the others.
#include <algorithm>
#include <cctype>

#include "meaning.h"
#include "refuse.h"
#include "yaml_fields.h"
#include "yaml_text.h"

namespace pf::sequence {

namespace {

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

}  // namespace pf::sequence
