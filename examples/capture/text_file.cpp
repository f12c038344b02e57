#include "text_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace pf::capture {

namespace {

std::string incomplete(const std::string& path) {
  return path + ": could not be written completely (" + std::strerror(errno) + "); is the disk full?";
}

/// All of the text. false: errno says why.
bool write_all(int file, const std::string& text) {
  for (size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(file, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      return false;
    }
    done += static_cast<size_t>(count);
  }
  return true;
}

/// So that the new name is on the disk as well. Some file systems cannot, and then have nothing to sync.
void sync_folder_of(const std::string& path) {
  const size_t slash = path.find_last_of('/');
  const std::string folder = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file >= 0) {
    ::fsync(file);
    ::close(file);
  }
}

}  // namespace

void append(std::string& text, const char* format, ...) {
  char piece[512];
  va_list words;
  va_start(words, format);
  const int length = std::vsnprintf(piece, sizeof(piece), format, words);
  va_end(words);
  if (length > 0 && static_cast<size_t>(length) < sizeof(piece)) {
    text.append(piece, static_cast<size_t>(length));
  } else if (length > 0) {
    const size_t before = text.size();
    text.resize(before + static_cast<size_t>(length) + 1);
    va_start(words, format);
    std::vsnprintf(&text[before], static_cast<size_t>(length) + 1, format, words);
    va_end(words);
    text.pop_back();
  }
}

bool TextFile::create(const std::string& path) {
  close();
  path_ = path;
  failure_.clear();
  rows_.clear();
  size_ = 0;
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  return file_ >= 0;
}

bool TextFile::open_again(const std::string& path) {
  close();
  path_ = path;
  failure_.clear();
  rows_.clear();
  file_ = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  size_ = file_ >= 0 ? static_cast<long long>(::lseek(file_, 0, SEEK_END)) : 0;
  return file_ >= 0;
}

bool TextFile::write_rows(std::string& error) {
  if (file_ >= 0 && failure_.empty() && !rows_.empty()) {
    if (write_all(file_, rows_)) {
      size_ += static_cast<long long>(rows_.size());
    } else {
      failure_ = incomplete(path_);
      // What is there of the row that did not fit goes; where that fails too there is nothing left to try.
      static_cast<void>(!::ftruncate(file_, size_));
    }
  }
  rows_.clear();
  error = failure_.empty() ? error : failure_;
  return failure_.empty();
}

void TextFile::close() {
  if (file_ >= 0) {
    ::close(file_);
    file_ = -1;
  }
}

bool replace_file(const std::string& path, const std::string& text, std::string& error, bool synced) {
  const std::string beside = path + ".part";
  const int file = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  bool done = file >= 0 && write_all(file, text) && (!synced || ::fsync(file) == 0);
  const int why = errno;
  if (file >= 0) {
    done = ::close(file) == 0 && done;
  }
  if (done && std::rename(beside.c_str(), path.c_str()) == 0) {
    if (synced) {
      sync_folder_of(path);
    }
    return true;
  }
  errno = done ? errno : why;
  error = incomplete(path);
  ::unlink(beside.c_str());
  return false;
}

}  // namespace pf::capture
