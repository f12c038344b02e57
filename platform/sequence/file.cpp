#include "file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "film_facts.h"
#include "refuse.h"

namespace pf::sequence {

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

void require_folder(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    refuse(path.string() + ": no such folder; check the path after the colon of the source");
  }
  if (!fs::is_directory(path, error)) {
    refuse(path.string() + (looks_like_film(path) ? ": is a film; write video:" + path.string()
                                                  : ": is not a folder; give the folder that holds the sequence (of a "
                                                    "film write video:FILE)"));
  }
  fs::directory_iterator entries(path, error);
  if (error) {
    refuse(path.string() + ": cannot be listed (" + error.message() + "); check its permissions");
  }
}

void read_bytes(const fs::path& path, size_t limit, const char* what, std::vector<unsigned char>& bytes) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    refuse(path.string() + ": no such " + what + " file; check the path");
  }
  if (!fs::is_regular_file(path, error)) {
    refuse(path.string() + ": is not a file; an " + std::string("ordinary file is needed as ") + what);
  }
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  if (!file) {
    refuse(path.string() + ": cannot be read (" + std::strerror(errno) + "); check its permissions");
  }
  const uintmax_t size = fs::file_size(path, error);
  if (error || size > limit) {
    refuse(path.string() + ": larger than the " + std::to_string(limit) + " bytes that a file of this kind (" + what +
           ") may have; is it the right file?");
  }
  bytes.resize(static_cast<size_t>(size));
  const size_t read = bytes.empty() ? 0 : std::fread(bytes.data(), 1, bytes.size(), file.get());
  bytes.resize(read);
  if (bytes.empty()) {
    refuse(path.string() + ": is empty (0 bytes); was it copied completely?");
  }
}

std::string read_text(const fs::path& path, size_t limit, const char* what) {
  std::vector<unsigned char> bytes;
  read_bytes(path, limit, what, bytes);
  return std::string(bytes.begin(), bytes.end());
}

std::vector<Row> split_rows(std::string_view text) {
  std::vector<Row> rows;
  size_t number = 0;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    ++number;
    Row row{number, {}};
    constexpr const char* kSeparators = " \t\r,";
    size_t begin = line.find_first_not_of(kSeparators);
    if (begin == std::string_view::npos || line[begin] == '#') {
      continue;
    }
    while (begin != std::string_view::npos) {
      const size_t stop = line.find_first_of(kSeparators, begin);
      row.words.push_back(line.substr(begin, stop == std::string_view::npos ? stop : stop - begin));
      begin = stop == std::string_view::npos ? stop : line.find_first_not_of(kSeparators, stop);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace pf::sequence
