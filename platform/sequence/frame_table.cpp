#include "frame_table.h"

#include <algorithm>
#include <map>

#include "date_time.h"
#include "image_list.h"
#include "numbers.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

enum class Column { kTime, kName, kIndex, kExposure };

constexpr size_t kMaxColumns = 16;

struct Layout {
  std::vector<Column> columns;
  TimeUnit unit;
  bool said = false;  ///< the header says the unit

  size_t find(Column column) const {
    return static_cast<size_t>(std::find(columns.begin(), columns.end(), column) - columns.begin());
  }
  bool has(Column column) const { return find(column) < columns.size(); }
};

bool is_number(std::string_view word) {
  double value = 0.0;
  int64_t t_ns = 0;
  return parse_double(word, value) || parse_date_time(word, t_ns);
}

bool is_whole(std::string_view word) {
  int64_t value = 0;
  return parse_integer(word, value);
}

bool is_one_of(const std::string& word, std::initializer_list<const char*> known) {
  return std::any_of(known.begin(), known.end(), [&](const char* name) { return word == name; });
}

/// Images of a folder by what tables call them: the name, the name without extension, the number.
class Names {
 public:
  Names(const fs::path& folder, const std::string& pattern) {
    if (is_folder(folder)) {
      for (const std::string& name : list_images(folder, pattern)) {
        add(fs::path(name).stem().string(), name);
        int64_t number = 0;
        if (parse_integer(fs::path(name).stem().string(), number)) {
          add("#" + std::to_string(number), name);
        }
      }
    }
  }

  /// "" where there is none, or more than one.
  std::string find(std::string_view word) const {
    const auto named = names_.find(std::string(word));
    if (named != names_.end()) {
      return named->second;
    }
    int64_t number = 0;
    const auto numbered = parse_integer(word, number) ? names_.find("#" + std::to_string(number)) : names_.end();
    return numbered != names_.end() ? numbered->second : "";
  }

 private:
  void add(const std::string& key, const std::string& name) {
    const auto [at, added] = names_.emplace(key, name);
    if (!added && at->second != name) {
      at->second.clear();
    }
  }

  std::map<std::string, std::string> names_;
};

std::string row_text(const TableRow& row) {
  constexpr size_t kShown = 60;
  return row.line.size() <= kShown ? std::string(row.line) : std::string(row.line.substr(0, kShown)) + "..";
}

/// Fields of a row, with a date and the time of day behind it as one.
std::vector<std::string_view> with_dates(const TableRow& row) {
  std::vector<std::string_view> fields;
  for (const std::string_view field : row.fields) {
    const bool follows = !fields.empty() && is_date(fields.back());
    const std::string_view both =
        follows ? std::string_view(fields.back().data(),
                                   static_cast<size_t>(field.data() + field.size() - fields.back().data()))
                : field;
    int64_t t_ns = 0;
    if (follows && parse_date_time(both, t_ns)) {
      fields.back() = both;
    } else {
      fields.push_back(field);
    }
  }
  return fields;
}

/// Names with blanks in a row that is cut at blanks: what follows the time is one name where such an image is there.
std::vector<std::string_view> joined(const TableRow& row, const FrameTablePlace& place) {
  const std::vector<std::string_view> fields = with_dates(row);
  if (fields.size() < 3 || row.line.find_first_of(",;\"") != std::string_view::npos || !is_image_name(fields.back())) {
    return fields;
  }
  for (size_t k = 1; k + 1 < fields.size(); ++k) {
    const auto begin = static_cast<size_t>(fields[k].data() - row.line.data());
    const std::string_view name = row.line.substr(begin);
    if (is_file(place.images / fs::path(name)) || is_file(place.root / fs::path(name))) {
      std::vector<std::string_view> kept(fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(k));
      kept.push_back(name);
      return kept;
    }
  }
  return fields;
}

class Reader {
 public:
  Reader(const Table& table, const FrameTablePlace& place)
      : table_(table), place_(place), names_(place.images, place.pattern) {
    for (const TableRow& row : table.rows()) {
      rows_.push_back(joined(row, place));
    }
  }

  std::vector<Frame> read(std::vector<std::string>& notes);

 private:
  const TableRow& row(size_t i) const { return table_.rows()[i]; }
  [[noreturn]] void refuse_row(size_t i, const std::string& why) const { refuse(table_.where(row(i)) + why); }

  void require_equal_rows() const;
  void refuse_decimal_commas() const;
  bool layout_by_header(Layout& layout) const;
  Layout layout_by_content() const;
  void require_indices(const Layout& layout) const;
  std::vector<std::string> images_in_order(size_t count, std::vector<std::string>& notes) const;
  fs::path path_of(size_t i, std::string_view name) const;
  std::string header_text(const Layout& layout, TimeUnit unit) const;

  const Table& table_;
  const FrameTablePlace& place_;
  const Names names_;
  std::vector<std::vector<std::string_view>> rows_;
};

void Reader::require_equal_rows() const {
  const size_t columns = rows_[0].size();
  for (size_t i = 1; i < rows_.size(); ++i) {
    if (rows_[i].size() != columns) {
      refuse_row(i, "has " + std::to_string(rows_[i].size()) + " columns (" + row_text(row(i)) +
                        "), the rows before have " + std::to_string(columns) +
                        "; names with blanks need quotes or commas");
    }
  }
  if (columns > kMaxColumns) {
    refuse_row(0, "has " + std::to_string(columns) + " columns; a table of frames has a time and an image name");
  }
}

/// "0,9990" and "1,0323" alone are two columns, or times with decimal commas: then the first does not count, and the second are as long.
void Reader::refuse_decimal_commas() const {
  bool repeats = false;
  for (size_t i = 0; i < rows_.size(); ++i) {
    const auto& words = rows_[i];
    if (words.size() != 2 || words[1].size() < 2 || words[1].size() != rows_[0][1].size() || !is_whole(words[0]) ||
        !is_whole(words[1]) || row(i).line.find(',') == std::string_view::npos) {
      return;
    }
    repeats = repeats || (i > 0 && words[0] == rows_[i - 1][0]);
  }
  if (repeats) {
    refuse_row(0, "'" + row_text(row(0)) + "' looks like a time with a decimal comma; write decimal points");
  }
}

/// false: no header, or a remark in its place.
bool Reader::layout_by_header(Layout& layout) const {
  const std::vector<std::string>& header = table_.header();
  if (header.empty()) {
    return false;
  }
  const std::string first = table_.name() + ": ";
  if (header.size() != rows_[0].size()) {
    refuse(first + "its header names " + std::to_string(header.size()) + " columns, and line " +
           std::to_string(row(0).number) + " has " + std::to_string(rows_[0].size()));
  }
  std::string unknown;
  for (const std::string& column : header) {
    std::string unit_text;
    const std::string name = split_unit(column, unit_text);
    TimeUnit unit = TimeUnit::kSeconds;
    if (is_one_of(name, {"time", "times", "timestamp", "timestamps", "stamp", "t", "seconds", "sec", "ns"})) {
      layout.columns.push_back(Column::kTime);
      layout.said = parse_unit(unit_text.empty() ? name : unit_text, unit);
      layout.unit = layout.said ? unit : layout.unit;
      if (!layout.said && !unit_text.empty()) {
        refuse(first + "the unit of its column '" + column + "' is not known; known are s, ms, us, ns and frames");
      }
    } else if (is_one_of(name, {"name", "file", "filename", "file name", "image", "path", "imagename", "rgb"})) {
      layout.columns.push_back(Column::kName);
    } else if (is_one_of(name, {"index", "frame", "id", "number", "no", "nr", "seq", "frame id", "frame_id", "n"})) {
      layout.columns.push_back(Column::kIndex);
    } else if (name.rfind("exposure", 0) == 0) {
      layout.columns.push_back(Column::kExposure);
    } else {
      layout.columns.push_back(Column::kExposure);
      unknown += (unknown.empty() ? "'" : "', '") + column;
    }
  }
  const auto count = [&](Column column) { return std::count(layout.columns.begin(), layout.columns.end(), column); };
  const bool fits = count(Column::kTime) == 1 && is_number(rows_[0][layout.find(Column::kTime)]);
  if (!fits && !table_.has_header_row()) {
    layout = Layout{{}, place_.unit, false};
    return false;  // a remark with as many words as there are columns
  }
  if (!unknown.empty()) {
    refuse(first + "its column " + unknown + "' is not known; known are time, name, index and exposure");
  }
  if (count(Column::kTime) != 1 || count(Column::kName) > 1 || count(Column::kIndex) > 1) {
    refuse(first + "its header must name one time, and at most one name and one index");
  }
  return true;
}

Layout Reader::layout_by_content() const {
  const std::vector<std::string_view>& first = rows_[0];
  std::string kinds;  // of the columns: n a number, i a whole one, w a word
  for (size_t k = 0; k < first.size(); ++k) {
    const auto all = [&](const auto& is) {
      return std::all_of(rows_.begin(), rows_.end(), [&](const auto& words) { return is(words[k]); });
    };
    const auto some = [&](const auto& is) {
      return std::any_of(rows_.begin(), rows_.end(), [&](const auto& words) { return is(words[k]); });
    };
    kinds += all(is_whole) ? 'i' : some(is_number) ? 'n' : 'w';
  }
  const auto fits = [&](const char* form) {
    return kinds.size() == std::string_view(form).size() &&
           std::equal(kinds.begin(), kinds.end(), form, [](char kind, char wanted) {
             return kind == wanted || (wanted == 'n' && kind == 'i') || (wanted == 'f' && kind != 'w');
           });
  };
  // An image that a number or a word without extension names.
  const bool names_images = !names_.find(first[0]).empty();
  Layout layout{{}, place_.unit, false};
  if (fits("n")) {
    layout.columns = {Column::kTime};
  } else if (fits("nw")) {
    layout.columns = {Column::kTime, Column::kName};
  } else if (fits("wn")) {
    layout.columns = {Column::kName, Column::kTime};
  } else if (fits("inw")) {
    layout.columns = {Column::kIndex, Column::kTime, Column::kName};
  } else if (fits("wnn")) {
    layout.columns = {Column::kName, Column::kTime, Column::kExposure};
  } else if (fits("nn") && names_images) {
    layout.columns = {Column::kName, Column::kTime};
  } else if (fits("nnn") && names_images) {
    layout.columns = {Column::kName, Column::kTime, Column::kExposure};
  } else if ((fits("ww") || fits("iww")) && is_image_name(first.back())) {
    const std::string_view word = first[first.size() - 2];
    refuse_row(0, "'" + std::string(word) + "' is not a time in " + name_of(place_.unit));
  } else {
    std::string why = "'" + row_text(row(0)) + "' has " + std::to_string(first.size()) + " columns";
    if (fits("w")) {
      why = "expected a time and an image name, found '" + std::string(first[0]) + "'";
    }
    refuse_row(0, why +
                      "; known are time | time name | name time | index time name | name or index, time, exposure; a "
                      "first line can "
                      "name the columns: # time, name");
  }
  return layout;
}

/// An index that stands beside a name must count: else it may be a time, or anything.
void Reader::require_indices(const Layout& layout) const {
  if (!layout.has(Column::kIndex) || !layout.has(Column::kName)) {
    return;
  }
  const size_t at = layout.find(Column::kIndex);
  int64_t before = 0;
  for (size_t i = 0; i < rows_.size(); ++i) {
    int64_t index = 0;
    if (!parse_integer(rows_[i][at], index)) {
      refuse_row(i, "'" + std::string(rows_[i][at]) + "' is not the number of a frame");
    }
    if (i > 0 && index <= before) {
      refuse_row(i, "column " + std::to_string(at + 1) + " should count the frames, and " + std::to_string(index) +
                        " comes after " + std::to_string(before));
    }
    before = index;
  }
}

/// Names stay inside of the sequence's folder.
fs::path Reader::path_of(size_t i, std::string_view name) const {
  std::string text(name);
  const std::string known = names_.find(name);
  if (!is_image_name(fs::path(text)) && !known.empty()) {
    return place_.images / known;
  }
  if (text.find('/') == std::string::npos) {
    std::replace(text.begin(), text.end(), '\\', '/');  // as Windows has them
  }
  const fs::path relative(text);
  bool climbs = relative.is_absolute();
  for (const fs::path& part : relative) {
    climbs = climbs || part == "..";
  }
  if (climbs) {
    refuse_row(i, "the image name '" + std::string(name) + "' leaves the sequence's folder");
  }
  if (!is_image_name(relative) && !is_file(place_.images / relative)) {
    refuse_row(
        i, "'" + std::string(name) + "' names no image in " + place_.images.string() + "; images are PNG, JPEG or PGM");
  }
  const bool below_root =
      relative.has_parent_path() && !is_file(place_.images / relative) && is_file(place_.root / relative);
  return (below_root ? place_.root : place_.images) / relative;
}

/// Images for times without names.
std::vector<std::string> Reader::images_in_order(size_t count, std::vector<std::string>& notes) const {
  std::vector<std::string> names = one_sequence(place_.images, list_images(place_.images, place_.pattern), notes);
  if (names.size() != count) {
    refuse(table_.name() + ": has " + std::to_string(count) + " times for " + std::to_string(names.size()) +
           " images in " + place_.images.string() + "; without names in it there must be as many of both");
  }
  return names;
}

/// A first line that says what the columns are.
std::string Reader::header_text(const Layout& layout, TimeUnit unit) const {
  std::string text = "#";
  for (const Column column : layout.columns) {
    text += text.size() > 1 ? ", " : " ";
    switch (column) {
      case Column::kTime:
        text += std::string("time [") + short_name_of(unit) + "]";
        break;
      case Column::kName:
        text += "name";
        break;
      case Column::kIndex:
        text += "index";
        break;
      case Column::kExposure:
        text += "exposure";
        break;
    }
  }
  return text;
}

std::vector<Frame> Reader::read(std::vector<std::string>& notes) {
  if (rows_.empty()) {
    refuse(table_.name() + ": lists no frame");
  }
  require_equal_rows();
  refuse_decimal_commas();
  Layout layout{{}, place_.unit, false};
  if (!layout_by_header(layout)) {
    layout = layout_by_content();
  }
  require_indices(layout);
  const size_t time = layout.find(Column::kTime);
  size_t name = layout.find(Column::kName);
  name = name < layout.columns.size() ? name : layout.find(Column::kIndex);
  TimesAsWritten written{{}, layout.unit, layout.said, place_.rate_hz};
  for (const auto& words : rows_) {
    written.words.push_back(words[time]);
  }
  std::string doubt;
  const TimeUnit unit = unit_of(written, doubt);
  if (!doubt.empty()) {
    notes.push_back(table_.name() + ": " + doubt + "; a first line can say the unit: " + header_text(layout, unit));
  }
  const bool named = name < layout.columns.size();
  const std::vector<std::string> in_order = named ? std::vector<std::string>() : images_in_order(rows_.size(), notes);
  std::vector<Frame> frames;
  for (size_t i = 0; i < rows_.size(); ++i) {
    const std::string word(rows_[i][time]);
    int64_t t_ns = 0;
    if (!parse_time(word, unit, place_.rate_hz, t_ns)) {
      refuse_row(i, "'" + word + "' is not a time in " +
                        (unit == TimeUnit::kNanoseconds ? "whole nanoseconds" : name_of(unit)));
    }
    if (!frames.empty() && t_ns <= frames.back().t_ns) {
      refuse_row(i, "the time " + word + (t_ns == frames.back().t_ns ? " repeats" : " runs back") +
                        "; times must grow from frame to frame");
    }
    frames.push_back({t_ns, named ? path_of(i, rows_[i][name]) : place_.images / in_order[i]});
  }
  return frames;
}

}  // namespace

std::vector<Frame> read_frame_table(const Table& table, const FrameTablePlace& place, std::vector<std::string>& notes) {
  return Reader(table, place).read(notes);
}

}  // namespace pf::sequence
