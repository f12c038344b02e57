#include "film.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace pf::capture {

namespace {

/// The program's place on the PATH, or "".
std::string find_program(const std::string& name) {
  const char* variable = std::getenv("PATH");
  std::string path = variable != nullptr ? variable : "/usr/bin:/bin";
  for (size_t begin = 0; begin <= path.size();) {
    const size_t end = std::min(path.find(':', begin), path.size());
    const std::string candidate = path.substr(begin, end - begin) + "/" + name;
    if (access(candidate.c_str(), X_OK) == 0) {
      return candidate;
    }
    begin = end + 1;
  }
  return "";
}

}  // namespace

bool Film::open(const std::string& path, int width, int height, double rate_hz, std::string& warning) {
  const std::string program = find_program("ffmpeg");
  if (program.empty()) {
    warning = "no film: the program ffmpeg is not installed (the pictures are still written)";
    return false;
  }
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  const double frames_per_second = std::clamp(rate_hz, 1.0, 240.0);
  const std::string rate = std::to_string(frames_per_second);
  const std::string second = std::to_string(static_cast<int>(frames_per_second + 0.5));
  std::vector<std::string> words = {program, "-loglevel", "error", "-nostdin", "-y"};
  words.insert(words.end(), {"-f", "rawvideo", "-pix_fmt", "bgr0", "-video_size", size, "-framerate", rate});
  words.insert(words.end(), {"-i", "pipe:0", "-c:v", "libx264", "-preset", "veryfast", "-crf", "20", "-g", second});
  words.insert(words.end(), {"-threads", "2", "-pix_fmt", "yuv420p", "-flush_packets", "1"});
  words.insert(words.end(), {"-movflags", "+frag_keyframe+empty_moov+default_base_moof", "file:" + path});
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    warning = "no film: no pipe to ffmpeg could be opened";
    return false;
  }
  child_ = fork();
  if (child_ == 0) {
    setsid();
    dup2(ends[0], STDIN_FILENO);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  ::close(ends[0]);
  pipe_ = child_ > 0 ? fdopen(ends[1], "wb") : nullptr;
  if (pipe_ == nullptr) {
    ::close(ends[1]);
    warning = "no film: ffmpeg could not be started";
    return false;
  }
  return true;
}

void Film::add(const Canvas& canvas) {
  if (pipe_ == nullptr || failed_) {
    return;
  }
  const unsigned char* row = canvas.pixels();
  const size_t bytes = 4 * static_cast<size_t>(canvas.width());
  for (int y = 0; y < canvas.height(); ++y, row += canvas.stride()) {
    failed_ = failed_ || std::fwrite(row, 1, bytes, pipe_) != bytes;
  }
}

bool Film::close() {
  if (pipe_ == nullptr) {
    return true;
  }
  failed_ = std::fclose(pipe_) != 0 || failed_;
  pipe_ = nullptr;
  int status = 0;
  if (waitpid(child_, &status, 0) != child_ || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    failed_ = true;
  }
  return !failed_;
}

}  // namespace pf::capture
