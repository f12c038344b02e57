#include "map_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "text_file.h"

namespace pf::capture {

namespace {

constexpr size_t kMaxBytes = size_t{1} << 26;  ///< of a file that is worth reading: the largest context has 50 MB

/// The whole file. false: errno says why, and is EFBIG where it is no map by its size alone.
bool read_whole(const std::string& path, std::string& bytes) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    return false;
  }
  bytes.resize(kMaxBytes);
  size_t size = 0;
  ssize_t count = 1;
  while (count != 0 && size < kMaxBytes) {
    count = ::read(file, bytes.data() + size, kMaxBytes - size);
    if (count < 0 && errno != EINTR) {
      break;
    }
    size += count > 0 ? static_cast<size_t>(count) : 0;
  }
  const int why = size == kMaxBytes ? EFBIG : errno;
  ::close(file);
  bytes.resize(size);
  errno = why;
  return count == 0 && size < kMaxBytes;
}

/// The first bytes of every saved map (lib/docs/reference/map_format.md).
constexpr char kFirstBytes[] = "\x89PFMAP\r\n";

}  // namespace

std::string why_no_map_can_be_saved(const std::string& path) {
  const std::string begin = "--save-map " + path + ": ";
  struct stat entry {};
  if (::stat(path.c_str(), &entry) == 0) {
    if (S_ISDIR(entry.st_mode)) return begin + "is a folder; name a file";
    std::string bytes;
    const bool is_map = read_whole(path, bytes) && bytes.rfind(kFirstBytes, 0) == 0;
    return is_map || entry.st_size == 0 ? "" : begin + "is there and is no saved map; name another file";
  }
  const size_t slash = path.find_last_of('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  if (::stat(folder.c_str(), &entry) != 0 || !S_ISDIR(entry.st_mode)) return begin + "there is no folder " + folder;
  return ::access(folder.c_str(), W_OK) == 0 ? "" : begin + "the folder " + folder + " cannot be written";
}

bool MapFile::read(const std::string& path, std::string& error) {
  path_ = path;
  if (!path.empty() && !read_whole(path, bytes_)) {
    error = path + ": " +
            (errno == ENOENT   ? "no such saved map; check the path"
             : errno == EISDIR ? "is a folder; a file that --save-map wrote is needed"
             : errno == EFBIG  ? "is too large for a saved map"
                               : std::strerror(errno));
    return false;
  }
  return true;
}

bool MapFile::load(pf_slam_t* slam, const std::vector<std::string>& log, std::string& error) const {
  if (empty()) {
    return true;
  }
  const pf_status_t status = pf_load_map(slam, bytes_.data(), bytes_.size());
  if (status == PF_ERROR_MAP && !log.empty()) {
    error = path_ + ": " + log.back();
  } else if (status == PF_ERROR_FULL) {
    error = path_ + ": has more places or planes than this run keeps; raise --max-places or --max-planes";
  } else if (status == PF_ERROR_STATE) {
    error = path_ + ": the run starts in this map: leave --start, --second-pose and --walls away";
  } else if (status < PF_OK) {
    error = path_ + ": " + pf_status_text(status);
  }
  return status >= PF_OK;
}

bool MapFile::save(const pf_slam_t* slam, int32_t kind, const std::string& path, std::string& note,
                   std::string& error) {
  size_t bytes = 0;
  pf_status_t status = pf_map_size(slam, kind, &bytes);
  std::string map(bytes, '\0');
  if (status == PF_OK) {
    status = pf_save_map(slam, kind, map.data(), map.size(), &bytes);
  }
  if (status != PF_OK) {
    error = path + ": no map was saved: " +
            (status == PF_NOTE_NOTHING  ? "no keyframe has seen enough points of known depth yet"
             : status == PF_ERROR_STATE ? "the run has not started"
                                        : pf_status_text(status));
    return false;
  }
  map.resize(bytes);
  if (!replace_file(path, map, error, true)) {
    return false;
  }
  note = "map of " + std::to_string(bytes / 1000) + " kB saved: " + path;
  return true;
}

}  // namespace pf::capture
