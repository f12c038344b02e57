#ifndef PLANEFOLD_CAPTURE_TEXT_FILE_H
#define PLANEFOLD_CAPTURE_TEXT_FILE_H

#include <string>

namespace pf::capture {

/// Appends as printf does.
__attribute__((format(printf, 2, 3))) void append(std::string& text, const char* format, ...);

/// A text file that grows by whole rows. What write_rows() took is in the file when it returns, all of it or nothing: a program that is
/// killed leaves no half row, and neither does a full disk.
class TextFile {
 public:
  TextFile() = default;
  ~TextFile() { close(); }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;

  /// An empty file. false: errno says why.
  bool create(const std::string& path);
  /// One that was closed, behind its last row. The same.
  bool open_again(const std::string& path);
  bool is_open() const { return file_ >= 0; }
  /// Rows that write_rows() is to write; each must end with a newline by then.
  std::string& rows() { return rows_; }
  /// false: error is one line. A file that failed once writes no more, so that it has no gap.
  bool write_rows(std::string& error);
  void close();

 private:
  std::string path_, rows_, failure_;
  int file_ = -1;
  long long size_ = 0;  ///< up to the last whole row
};

/// Replaces a file by a new one with this text: written beside it (path.part) and renamed, so that a reader at any time sees the old or the
/// new one, whole. synced: so does one after the power was lost. false: error is one line, and the old file is still there.
bool replace_file(const std::string& path, const std::string& text, std::string& error, bool synced = false);

}  // namespace pf::capture

#endif
