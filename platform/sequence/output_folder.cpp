/// Folders that programs write into: what an earlier run wrote is replaced, and nothing else is ever touched.
///
/// The list .planefold inside of such a folder names every file that was written, one a line and before it was made; a line that
/// ends in / is a folder. A later run deletes what the list names, and folders only when they are empty then.
#include <planefold_platform/sequence.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr const char* kList = ".planefold";
constexpr const char* kHead =
    "# Written by planefold's programs. A later run replaces these files and touches no others.";

int say(char message[PF_SEQUENCE_MESSAGE], const std::string& line) {
  if (message != nullptr) {
    std::snprintf(message, PF_SEQUENCE_MESSAGE, "%s", line.c_str());
  }
  return -1;
}

/// A list may have been edited: only names that stay inside of the folder count.
bool stays_inside(const fs::path& name) {
  bool inside = !name.empty() && name.is_relative();
  for (const fs::path& part : name) {
    inside = inside && part != "..";
  }
  return inside;
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

std::vector<std::string> read_list(const fs::path& folder) {
  std::vector<std::string> names;
  std::ifstream file(folder / kList);
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line[0] != '#' && stays_inside(line)) {
      names.push_back(line);
    }
  }
  return names;
}

/// Files first, then the folders from the last named to the first, where they are empty.
void remove_listed(const fs::path& folder, const std::vector<std::string>& names) {
  std::error_code ignored;
  for (const std::string& name : names) {
    if (name.back() != '/' && !fs::is_directory(fs::symlink_status(folder / name, ignored))) {
      fs::remove(folder / name, ignored);
    }
  }
  for (auto name = names.rbegin(); name != names.rend(); ++name) {
    const fs::path path = folder / name->substr(0, name->size() - 1);
    if (name->back() == '/' && fs::is_directory(fs::symlink_status(path, ignored)) && fs::is_empty(path, ignored)) {
      fs::remove(path, ignored);
    }
  }
}

bool write_lines(const fs::path& path, const char* mode, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), mode);
  if (file == nullptr) {
    return false;
  }
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return std::fclose(file) == 0 && written;
}

}  // namespace

int pf_check_output_folder(const char* path, const char* option, char message[PF_SEQUENCE_MESSAGE]) {
  if (path == nullptr || option == nullptr || path[0] == '\0') {
    return say(message, "the output folder has no name; give one");
  }
  const fs::path folder(path);
  const std::string other = std::string("; choose another ") + option;
  std::error_code failure;
  if (!fs::exists(folder, failure)) {
    return 0;
  }
  if (!fs::is_directory(folder, failure)) {
    return say(message, folder.string() + ": is a file, and a folder is needed" + other);
  }
  const bool empty = fs::is_empty(folder, failure);
  if (failure) {
    return say(message, folder.string() + ": cannot be listed (" + failure.message() + ")" + other);
  }
  if (!empty && !fs::is_regular_file(folder / kList, failure)) {
    return say(message, folder.string() + ": holds files of others (it has no " + kList + " of an earlier run)" +
                            other + ", or empty it yourself");
  }
  return 0;
}

int pf_check_output_input(const char* path, const char* option, const char* input, char message[PF_SEQUENCE_MESSAGE]) {
  if (path == nullptr || option == nullptr || input == nullptr) {
    return say(message, "an output folder, its option and an input are needed");
  }
  std::error_code failure;
  const fs::path folder = fs::weakly_canonical(path, failure), read = fs::weakly_canonical(input, failure);
  if (!is_inside(read, folder)) {  // a folder for output may lie among the images
    return 0;
  }
  for (const std::string& name : read_list(folder)) {
    if (is_inside(fs::weakly_canonical(folder / name, failure), read)) {
      return say(message, std::string(path) + ": an earlier run wrote " + input +
                              ", which this run reads and would delete; choose another " + option);
    }
  }
  return 0;
}

int pf_open_output_folder(const char* path, const char* option, char message[PF_SEQUENCE_MESSAGE]) {
  if (pf_check_output_folder(path, option, message) != 0) {
    return -1;
  }
  const fs::path folder(path);
  const std::string other = std::string("; choose another ") + option;
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) {
    return say(message, folder.string() + ": cannot be made (" + failure.message() + ")" + other);
  }
  remove_listed(folder, read_list(folder));
  if (!write_lines(folder / kList, "w", std::string(kHead) + "\n")) {
    return say(message, folder.string() + ": cannot be written (" + std::strerror(errno) + ")" + other);
  }
  return 0;
}

int pf_add_output_file(const char* path, const char* name, char message[PF_SEQUENCE_MESSAGE]) {
  if (path == nullptr || name == nullptr || !stays_inside(name)) {
    return say(message, "an output file needs a folder and a name inside of it");
  }
  const fs::path folder(path);
  const std::string line(name);
  std::error_code failure;
  if (line.back() != '/' && fs::exists(fs::symlink_status(folder / line, failure))) {
    for (const std::string& known : read_list(folder)) {
      if (known == line) {
        return 0;
      }
    }
    return say(message, (folder / line).string() + ": is there already, and no earlier run wrote it; move it away");
  }
  if (!write_lines(folder / kList, "a", line + "\n")) {
    return say(message,
               (folder / kList).string() + ": cannot be written (" + std::strerror(errno) + "); is the disk full?");
  }
  return 0;
}
