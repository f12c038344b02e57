#include "nodes.h"

#include <dirent.h>
#include <unistd.h>

#include <string>

namespace pf::libcamera {

int count_gone_nodes() {
  DIR* folder = opendir("/proc/self/fd");
  int gone = 0;
  const std::string end = " (deleted)";
  for (const dirent* entry = folder != nullptr ? readdir(folder) : nullptr; entry != nullptr; entry = readdir(folder)) {
    char target[256];
    const ssize_t length = readlinkat(dirfd(folder), entry->d_name, target, sizeof(target));
    const std::string path(target, length > 0 ? static_cast<size_t>(length) : 0);
    gone += (path.rfind("/dev/video", 0) == 0 && path.size() > end.size() &&
             path.compare(path.size() - end.size(), end.size(), end) == 0)
                ? 1
                : 0;
  }
  if (folder != nullptr) {
    closedir(folder);
  }
  return gone;
}

}  // namespace pf::libcamera
