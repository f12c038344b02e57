#include "table.h"

#include <algorithm>
#include <cctype>

#include "numbers.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr const char* kBlanks = " \t\r\v\f";

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(kBlanks);
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

void put_utf8(std::string& out, uint32_t code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xc0 | (code >> 6));
    out += static_cast<char>(0x80 | (code & 0x3f));
  } else {
    out += static_cast<char>(0xe0 | (code >> 12));
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3f));
    out += static_cast<char>(0x80 | (code & 0x3f));
  }
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Whether a line is cut at blanks, with decimal commas: "1,05 00001.png". Each comma stands in a number of digits, one at most in each.
bool has_decimal_commas(std::string_view line) {
  bool blank = false, commas = false;
  for (size_t begin = 0; begin < line.size();) {
    const size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    const std::string_view word = line.substr(begin, end - begin);
    const size_t comma = word.find(',');
    if (comma != word.npos) {
      commas = true;
      if (comma == 0 || comma + 1 == word.size() || word.find_first_not_of("0123456789,+-eE") != word.npos ||
          word.find(',', comma + 1) != word.npos) {
        return false;
      }
    }
    blank = blank || (begin > 0 && !word.empty());
    begin = end + 1;
  }
  return commas && blank;
}

/// The separator of a line: a comma or semicolon outside of quotes, or a blank. Where there are semicolons or blanks, commas inside of
/// numbers are decimal ones.
char separator_of(std::string_view line) {
  if (has_decimal_commas(line)) {
    return ' ';
  }
  bool quoted = false, semicolon = false, comma = false, decimal = true;
  for (size_t i = 0; i < line.size(); ++i) {
    quoted = line[i] == '"' ? !quoted : quoted;
    semicolon = semicolon || (!quoted && line[i] == ';');
    if (!quoted && line[i] == ',') {
      comma = true;
      decimal = decimal && i > 0 && i + 1 < line.size() && is_digit(line[i - 1]) && is_digit(line[i + 1]);
    }
  }
  return semicolon && (!comma || decimal) ? ';' : comma ? ',' : ' ';
}

/// "1,05" to "1.05", in the text itself.
void put_decimal_points(char* field, size_t size) {
  const std::string_view text(field, size);
  if (std::count(text.begin(), text.end(), ',') == 1 && text.find_first_not_of("0123456789,+-eE") == text.npos) {
    field[text.find(',')] = '.';
  }
}

bool is_blank(char c) { return std::string_view(kBlanks).find(c) != std::string_view::npos; }

/// The field that begins at a quote; at moves behind the closing one. Doubled quotes become one, in the text itself.
std::string_view quoted_field(char* line, size_t size, size_t& at) {
  const size_t begin = ++at;
  size_t end = begin;
  for (; at < size; ++at) {
    if (line[at] == '"') {
      if (at + 1 >= size || line[at + 1] != '"') {
        ++at;
        break;
      }
      ++at;
    }
    line[end++] = line[at];
  }
  return {line + begin, end - begin};
}

/// Fields of a line, which may be changed where a quote is doubled inside of quotes.
std::vector<std::string_view> split(char* line, size_t size, char separator) {
  const bool blanks = separator == ' ';
  std::vector<std::string_view> fields;
  size_t at = 0;
  while (true) {
    while (at < size && is_blank(line[at])) ++at;
    if (blanks && at >= size) {
      return fields;
    }
    std::string_view field;
    if (at < size && line[at] == '"') {
      field = quoted_field(line, size, at);
    }
    const size_t begin = at;
    while (at < size && !(blanks ? is_blank(line[at]) : line[at] == separator)) ++at;
    if (field.data() == nullptr) {
      field = trimmed({line + begin, at - begin});
      if (separator != ',') {
        put_decimal_points(line + begin, at - begin);
      }
    }
    fields.push_back(field);
    if (at >= size) {
      return fields;
    }
    ++at;
    if (!blanks && trimmed({line + at, size - at}).empty()) {
      return fields;  // a separator that ends the row
    }
  }
}

/// Names in a header; a unit in brackets belongs to the name before it.
std::vector<std::string> names_of(std::string line) {
  const char separator = separator_of(line);
  std::vector<std::string> names;
  for (const std::string_view field : split(line.data(), line.size(), separator)) {
    if (separator == ' ' && !names.empty() && !field.empty() && (field[0] == '[' || field[0] == '(')) {
      names.back() += " " + std::string(field);
    } else {
      names.emplace_back(field);
    }
  }
  return names;
}

bool is_number(std::string_view field) {
  double value = 0.0;
  return parse_double(field, value);
}

/// With a point, as the name of a picture has it; "angular_velocity.x" and "header.stamp.secs" have none.
bool is_picture(std::string_view field) {
  constexpr std::string_view kEnds[] = {"png",  "jpg",  "jpeg", "pgm",  "ppm", "bmp", "tif",
                                        "tiff", "webp", "exr",  "heic", "dng", "gif", "raw"};
  const size_t point = field.rfind('.');
  std::string end(point == std::string_view::npos ? std::string_view() : field.substr(point + 1));
  std::transform(end.begin(), end.end(), end.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(std::begin(kEnds), std::end(kEnds), end) != std::end(kEnds);
}

/// A first row that names columns: no field of it is a number or a file.
bool names_columns(const TableRow& row) {
  return std::none_of(row.fields.begin(), row.fields.end(), [](std::string_view field) {
    return field.empty() || is_number(field) || std::isdigit(static_cast<unsigned char>(field[0])) != 0 ||
           is_picture(field) || field[0] == '-';
  });
}

}  // namespace

std::string without_byte_order_mark(std::string text) {
  if (text.compare(0, 3, "\xef\xbb\xbf") == 0) {
    text.erase(0, 3);
    return text;
  }
  const bool little = text.compare(0, 2, "\xff\xfe") == 0;
  if (!little && text.compare(0, 2, "\xfe\xff") != 0) {
    return text;
  }
  std::string out;
  for (size_t i = 2; i + 1 < text.size(); i += 2) {
    const auto first = static_cast<unsigned char>(text[i]);
    const auto second = static_cast<unsigned char>(text[i + 1]);
    put_utf8(out, little ? first + 256u * second : 256u * first + second);
  }
  return out;
}

std::string split_unit(const std::string& column, std::string& unit) {
  std::string name;
  for (const char c : column) {
    name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  unit.clear();
  const size_t open = name.find_first_of("[(");
  if (open != std::string::npos) {
    const size_t close = name.find_first_of("])", open);
    unit = std::string(trimmed(
        std::string_view(name).substr(open + 1, (close == std::string::npos ? name.size() : close) - open - 1)));
    name.erase(open);
  } else {
    for (const char* end : {"_s", "_ms", "_us", "_ns", "_sec"}) {
      const std::string_view tail(end);
      if (name.size() > tail.size() && name.compare(name.size() - tail.size(), tail.size(), tail) == 0) {
        unit = tail.substr(1);
        name.erase(name.size() - tail.size());
        break;
      }
    }
  }
  return std::string(trimmed(name));
}

Table::Table(std::string text, std::string name)
    : text_(without_byte_order_mark(std::move(text))), name_(std::move(name)) {
  std::string comment;
  size_t number = 0;
  for (size_t begin = 0; begin < text_.size();) {
    const size_t end = std::min(text_.find_first_of("\r\n", begin), text_.size());
    const std::string_view line = trimmed(std::string_view(text_).substr(begin, end - begin));
    begin = end + (text_.compare(end, 2, "\r\n") == 0 ? 2 : 1);
    ++number;
    if (line.empty()) {
      continue;
    }
    if (line[0] == '#' || line[0] == '%') {
      if (rows_.empty()) {
        comment = line.substr(std::min(line.find_first_not_of("#% \t"), line.size()));
      }
      continue;
    }
    if (line.find('\0') != std::string_view::npos) {
      refuse(name_ + " line " + std::to_string(number) + ": holds bytes that are no text; is it a table?");
    }
    char* const start = text_.data() + (line.data() - text_.data());
    TableRow row{number, line, split(start, line.size(), separator_of(line))};
    if (rows_.empty() && header_.empty() && names_columns(row)) {
      header_ = names_of(std::string(line));
      has_header_row_ = true;
      continue;
    }
    rows_.push_back(std::move(row));
  }
  if (header_.empty() && !comment.empty() && !rows_.empty()) {
    header_ = names_of(comment);
    if (header_.size() != rows_.front().fields.size()) {
      header_.clear();  // a remark
    }
  }
}

std::string Table::where(const TableRow& row) const { return name_ + " line " + std::to_string(row.number) + ": "; }

}  // namespace pf::sequence
