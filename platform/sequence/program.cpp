#include "program.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>

#include "refuse.h"

extern char** environ;

namespace pf::sequence {

namespace {

constexpr int kPatienceMs = 60000;          ///< without a byte from the program
constexpr size_t kChunk = size_t{1} << 16;  ///< what a pipe holds
constexpr size_t kMaxLog = size_t{1} << 16;
constexpr int kFirstFree =
    10;  ///< descriptors of ours begin here, so that none lies where the program expects one of its own

/// A pipe whose ends no other program inherits.
void open_pipe(int& ours, int& theirs) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    refuse(std::string("no pipe to another program could be opened (") + std::strerror(errno) + ")");
  }
  ours = fcntl(ends[0], F_DUPFD_CLOEXEC, kFirstFree);
  theirs = fcntl(ends[1], F_DUPFD_CLOEXEC, kFirstFree);
  close(ends[0]);
  close(ends[1]);
  if (ours >= 0) {
    fcntl(ours, F_SETFL, O_NONBLOCK);
  }
}

void close_descriptor(int& descriptor) {
  if (descriptor >= 0) {
    close(descriptor);
  }
  descriptor = -1;
}

/// "[nut @ 0x55d0] no index" to "no index".
std::string_view without_origin(std::string_view line) {
  while (!line.empty() && line.front() == '[') {
    const size_t end = line.find("] ");
    if (end == std::string_view::npos) {
      break;
    }
    line.remove_prefix(end + 2);
  }
  return line;
}

}  // namespace

Program::Program(const std::vector<std::string>& words) : name_(words.front()) {
  std::array<int, kOutputs> ends{-1, -1, -1};
  try {
    for (size_t i = 0; i < kOutputs; ++i) {
      open_pipe(descriptors_[i], ends[i]);
    }
    start(words, ends);
  } catch (...) {
    std::for_each(ends.begin(), ends.end(), close_descriptor);
    close_outputs();
    throw;
  }
  std::for_each(ends.begin(), ends.end(), close_descriptor);
}

Program::~Program() {
  close_outputs();
  if (child_ > 0) {
    kill(child_, SIGKILL);
    while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
}

void Program::start(const std::vector<std::string>& words, const std::array<int, kOutputs>& ends) {
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  for (std::string& word : copies) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  for (size_t i = 0; i < kOutputs; ++i) {
    posix_spawn_file_actions_adddup2(&actions, ends[i], static_cast<int>(i) + 1);
  }
  // Whoever ignores signals here may have its reasons; the other program ends when nobody reads it any more.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults, none;
  sigemptyset(&none);
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGPIPE);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  const int failure = posix_spawnp(&child_, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    child_ = -1;
    refuse(failure == ENOENT ? "films are read by the program " + name_ +
                                   ", which is not installed; install ffmpeg (Debian: apt install ffmpeg)"
                             : "the program " + name_ + " could not be started (" + std::strerror(failure) + ")");
  }
}

void Program::close_outputs() { std::for_each(descriptors_.begin(), descriptors_.end(), close_descriptor); }

void Program::take(size_t output) {
  std::vector<char>& bytes = bytes_[output];
  const size_t before = bytes.size();
  bytes.resize(before + kChunk);
  const ssize_t count = read(descriptors_[output], bytes.data() + before, kChunk);
  bytes.resize(before + static_cast<size_t>(std::max<ssize_t>(count, 0)));
  if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) {
    close_descriptor(descriptors_[output]);
  }
  if (output == kLog && bytes.size() > kMaxLog) {
    bytes.erase(bytes.begin(), bytes.end() - kMaxLog / 2);
  }
}

bool Program::read_more(size_t limit) {
  std::array<pollfd, kOutputs> polled{};
  bool open = false;
  for (size_t i = 0; i < kOutputs; ++i) {
    const bool full = i == kData && bytes_[i].size() >= limit;
    polled[i] = {full ? -1 : descriptors_[i], POLLIN, 0};
    open = open || polled[i].fd >= 0;
  }
  if (!open) {
    return false;
  }
  const int ready = poll(polled.data(), polled.size(), kPatienceMs);
  if (ready == 0) {
    refuse("the program " + name_ + " has given nothing for a minute; is the disk or the network still there?");
  }
  for (size_t i = 0; ready > 0 && i < kOutputs; ++i) {
    if (polled[i].revents != 0) {
      take(i);
    }
  }
  return true;
}

bool Program::has_said(const char* text) const {
  const std::vector<char>& log = bytes_[kLog];
  return std::string_view(log.data(), log.size()).find(text) != std::string_view::npos;
}

std::string Program::last_words() const {
  std::string_view log(bytes_[kLog].data(), bytes_[kLog].size());
  while (!log.empty()) {
    const size_t end = log.find_last_not_of(" \r\n");
    if (end == std::string_view::npos) {
      break;
    }
    log = log.substr(0, end + 1);
    const size_t begin = log.rfind('\n');
    const std::string_view line = begin == std::string_view::npos ? log : log.substr(begin + 1);
    if (line.find("Last message repeated") == std::string_view::npos) {
      return std::string(without_origin(line));
    }
    log = log.substr(0, begin == std::string_view::npos ? 0 : begin);
  }
  return "";
}

}  // namespace pf::sequence
