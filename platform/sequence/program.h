#ifndef PLANEFOLD_PLATFORM_SEQUENCE_PROGRAM_H
#define PLANEFOLD_PLATFORM_SEQUENCE_PROGRAM_H

#include <sys/types.h>

#include <array>
#include <string>
#include <vector>

namespace pf::sequence {

/// Another program (ffmpeg, ffprobe) whose outputs are read. It is started without a shell, has no input, and ends with this object.
class Program {
 public:
  enum Output { kData = 0, kLog = 1, kTimes = 2 };  ///< its descriptors 1, 2 and 3
  static constexpr size_t kOutputs = 3;

  /// words  the program's name, which is looked for on the PATH, and its arguments. Throws ReadError where it cannot be started.
  explicit Program(const std::vector<std::string>& words);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Waits until the program has written something and takes it. Of kData nothing more is taken once limit bytes wait there.
  /// false: it has closed all its outputs. Throws ReadError where it writes nothing for a minute.
  bool read_more(size_t limit);

  /// What has been read and not been taken yet. Of kLog the end is kept.
  std::vector<char>& bytes(Output output) { return bytes_[output]; }

  /// The last line of its log that says something, without the parts of ffmpeg that it names; "" where there is none.
  std::string last_words() const;
  bool has_said(const char* text) const;

 private:
  void start(const std::vector<std::string>& words, const std::array<int, kOutputs>& ends);
  void take(size_t output);
  void close_outputs();

  std::string name_;
  pid_t child_ = -1;
  std::array<int, kOutputs> descriptors_{-1, -1, -1};
  std::array<std::vector<char>, kOutputs> bytes_;
};

}  // namespace pf::sequence

#endif
