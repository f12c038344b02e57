#include "yaml_text.h"

#include <cctype>

#include "yaml_fields.h"

namespace pf::sequence {

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

}  // namespace pf::sequence
