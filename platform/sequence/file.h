#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FILE_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FILE_H

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace pf::sequence {

namespace fs = std::filesystem;

/// All bytes of a file of at most limit bytes. Throws ReadError when it is missing, a folder, unreadable, larger, or empty.
/// what   for the message: "image", "calibration"
void read_bytes(const fs::path& path, size_t limit, const char* what, std::vector<unsigned char>& bytes);

std::string read_text(const fs::path& path, size_t limit, const char* what);

/// Throws ReadError unless the path is a folder that can be listed.
void require_folder(const fs::path& path);

bool is_file(const fs::path& path);
bool is_folder(const fs::path& path);

/// One line of a table: its words, and its number in the file for messages.
struct Row {
  size_t number;
  std::vector<std::string_view> words;
};

/// Lines of text cut at blanks and commas; empty lines and those that begin with # are left out. The words point into text.
std::vector<Row> split_rows(std::string_view text);

}  // namespace pf::sequence

#endif
