#ifndef PLANEFOLD_PLATFORM_SEQUENCE_TABLE_H
#define PLANEFOLD_PLATFORM_SEQUENCE_TABLE_H

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pf::sequence {

/// A row of a table. The views point into the table's text.
struct TableRow {
  size_t number;                         ///< of its line in the file, from 1
  std::string_view line;                 ///< without blanks at its ends
  std::vector<std::string_view> fields;  ///< without quotes and without blanks at their ends
};

/// A text table as spreadsheets, scripts and other programs write it.
///
/// A row with a comma outside of quotes is cut at commas, one with a semicolon at semicolons, and another at blanks. Fields may be in
/// quotes (RFC 4180). Byte order marks, UTF-16 and all three kinds of line ends are read; empty lines and those that begin with # are
/// left out. The header is the last comment before the first row, or a first row without any number.
class Table {
 public:
  /// name  of the file, for messages. Throws ReadError for text that is no table.
  Table(std::string text, std::string name);
  Table(const Table&) = delete;
  Table& operator=(const Table&) = delete;

  const std::vector<TableRow>& rows() const { return rows_; }
  /// Names of columns; empty where there is no header, or a comment that does not have a name for each column.
  const std::vector<std::string>& header() const { return header_; }
  /// The header is a row of its own: no remark.
  bool has_header_row() const { return has_header_row_; }
  const std::string& name() const { return name_; }
  /// "FILE line N: ", for messages.
  std::string where(const TableRow& row) const;

 private:
  std::string text_;
  std::string name_;
  std::vector<TableRow> rows_;
  std::vector<std::string> header_;
  bool has_header_row_ = false;
};

/// Text without a byte order mark; UTF-16 with one becomes UTF-8.
std::string without_byte_order_mark(std::string text);

/// "Timestamp [ns]" to "timestamp"; unit becomes "ns". Units are known in [] or () behind the name, and as _s, _ms, _us, _ns.
std::string split_unit(const std::string& column, std::string& unit);

}  // namespace pf::sequence

#endif
