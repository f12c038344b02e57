#include "file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "film_facts.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Text order, but runs of digits compare as numbers.
bool natural_less(const std::string& a, const std::string& b) {
  size_t i = 0;
  size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      size_t i_end = i;
      size_t j_end = j;
      while (i_end < a.size() && is_digit(a[i_end])) ++i_end;
      while (j_end < b.size() && is_digit(b[j_end])) ++j_end;
      while (i + 1 < i_end && a[i] == '0') ++i;
      while (j + 1 < j_end && b[j] == '0') ++j;
      if (i_end - i != j_end - j) {
        return i_end - i < j_end - j;
      }
      const int order = a.compare(i, i_end - i, b, j, j_end - j);
      if (order != 0) {
        return order < 0;
      }
      i = i_end;
      j = j_end;
    } else {
      if (a[i] != b[j]) {
        return a[i] < b[j];
      }
      ++i;
      ++j;
    }
  }
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

bool is_image_name(const fs::path& name) {
  std::string extension = name.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".pgm";
}

}  // namespace

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

std::vector<std::string> list_images(const fs::path& folder) {
  require_folder(folder);
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (is_image_name(entry->path())) {
      names.push_back(entry->path().filename().string());
    }
  }
  if (error) {
    refuse(folder.string() + ": cannot be listed (" + error.message() + "); check its permissions");
  }
  std::sort(names.begin(), names.end(), natural_less);
  return names;
}

}  // namespace pf::sequence
