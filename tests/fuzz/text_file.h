// A file in a temporary folder of its own, for readers that want a path.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "bytes.h"

class TextFile {
 public:
  explicit TextFile(const char* name) {
    char pattern[] = "/tmp/planefold_fuzz_XXXXXX";
    require(mkdtemp(pattern) != nullptr, "a temporary folder");
    folder_ = pattern;
    path_ = folder_ + "/" + name;
    owner_ = true;
  }
  TextFile(TextFile&& other) noexcept : folder_(other.folder_), path_(other.path_), owner_(other.owner_) {
    other.owner_ = false;
    other.path_.clear();
  }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  TextFile& operator=(TextFile&&) = delete;
  ~TextFile() {
    if (!path_.empty()) std::remove(path_.c_str());
    if (owner_) rmdir(folder_.c_str());
  }

  /// Another file in the same folder, which must live shorter.
  TextFile beside(const char* name) const { return TextFile(folder_, folder_ + "/" + name); }

  const std::string& folder() const { return folder_; }
  const char* path() const { return path_.c_str(); }

  void write(const uint8_t* data, size_t size) const {
    std::FILE* file = std::fopen(path_.c_str(), "wb");
    require(file != nullptr && (size == 0 || std::fwrite(data, 1, size, file) == size), "a file can be written");
    std::fclose(file);
  }

 private:
  TextFile(std::string folder, std::string path) : folder_(std::move(folder)), path_(std::move(path)) {}

  std::string folder_, path_;
  bool owner_ = false;
};
