#include "film.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <utility>

#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr size_t kMaxAhead = size_t{256} << 20;  ///< bytes of pixels that may come before the time of the first of them
constexpr const char* kTimeBase = "1/1000000000";

/// One of the two outputs of ffmpeg: no frame is dropped or repeated to make the rate a fixed one.
void append_output(std::vector<std::string>& words, bool old_option, const char* format, const char* where) {
  words.insert(words.end(), {"-map", "0:V:0", "-c:v", "rawvideo", "-pix_fmt", "gray"});
  words.insert(words.end(), {old_option ? "-vsync" : "-fps_mode", "passthrough", "-enc_time_base", kTimeBase});
  words.insert(words.end(), {"-flush_packets", "1", "-f", format, where});
}

}  // namespace

Film::Film(fs::path path) : path_(std::move(path)) {
  begin();
  if (!fetch() && program_->has_said("fps_mode")) {
    old_option_ = true;
    begin();
  }
  if (!fetch()) {
    const std::string said = program_->last_words();
    refuse(path_.string() + ": ffmpeg shows no frame of it" + (said.empty() ? "" : " (" + said + ")") +
           "; does it play elsewhere?");
  }
}

void Film::begin() {
  std::vector<std::string> words = {"ffmpeg", "-v", "error", "-nostdin", "-copyts", "-protocol_whitelist", "file,pipe"};
  words.insert(words.end(), {"-i", "file:" + path_.string()});
  append_output(words, old_option_, "rawvideo", "pipe:1");
  append_output(words, old_option_, "framecrc", "pipe:3");
  program_ = std::make_unique<Program>(words);
  stamps_.clear();
  next_ = 0;
  has_dropped_ = false;
}

/// "#tb 0: 1/1000000000", "#dimensions 0: 640x480", and of each frame "0, dts, pts, duration, bytes, checksum".
void Film::parse_line(const std::string& line) {
  int64_t pts = 0, bytes = 0, numerator = 0, denominator = 0;
  ImageSize size;
  if (std::sscanf(line.c_str(), "#tb 0: %" SCNd64 "/%" SCNd64, &numerator, &denominator) == 2) {
    units_per_second_ = numerator == 1 ? denominator : 0;
  } else if (std::sscanf(line.c_str(), "#dimensions 0: %" SCNd32 "x%" SCNd32, &size.width, &size.height) == 2) {
    size_ = size;
  } else if (std::sscanf(line.c_str(), "0, %*d, %" SCNd64 ", %*d, %" SCNd64, &pts, &bytes) == 2) {
    if (units_per_second_ != 1000000000 || bytes <= 0 || size_.width <= 0 || size_.height <= 0) {
      refuse(path_.string() + ": this ffmpeg gives times or sizes of frames that cannot be understood ('" + line +
             "')");
    }
    stamps_.push_back({pts, static_cast<size_t>(bytes)});
  }
}

void Film::parse_times() {
  std::vector<char>& bytes = program_->bytes(Program::kTimes);
  auto begin = bytes.begin();
  for (auto end = begin; (end = std::find(begin, bytes.end(), '\n')) != bytes.end(); begin = end + 1) {
    parse_line(std::string(begin, end));
  }
  bytes.erase(bytes.begin(), begin);
}

bool Film::fetch() {
  const std::vector<char>& data = program_->bytes(Program::kData);
  for (;;) {
    parse_times();
    if (!stamps_.empty() && data.size() >= stamps_.front().bytes) {
      return true;
    }
    if (data.size() >= kMaxAhead) {
      refuse(path_.string() + ": this ffmpeg does not say the times of its frames");
    }
    if (!program_->read_more(stamps_.empty() ? kMaxAhead : stamps_.front().bytes)) {
      return false;
    }
  }
}

void Film::drop() {
  std::vector<char>& data = program_->bytes(Program::kData);
  data.erase(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(stamps_.front().bytes));
  last_t_ns_ = has_dropped_ ? std::max(last_t_ns_, stamps_.front().t_ns) : stamps_.front().t_ns;
  has_dropped_ = true;
  stamps_.pop_front();
  ++next_;
}

std::string Film::where(int64_t index) const { return path_.string() + ", frame " + std::to_string(index); }

bool Film::read(int64_t index, const unsigned char*& pixels, int64_t& t_ns) {
  if (index < next_) {
    begin();
  }
  while (next_ < index) {
    if (!fetch()) {
      return false;
    }
    drop();
  }
  if (!fetch()) {
    return false;
  }
  const Stamp& stamp = stamps_.front();
  if (stamp.bytes != static_cast<size_t>(size_.width) * static_cast<size_t>(size_.height)) {
    refuse(where(index) + ": from here on its pictures are of another size than " + std::to_string(size_.width) +
           " x " + std::to_string(size_.height) + "; cut the film here, or scale it to one size");
  }
  if (has_dropped_ && stamp.t_ns <= last_t_ns_) {
    throw ImageError(where(index) + ": its time does not come after that of the frame before");
  }
  pixels = reinterpret_cast<const unsigned char*>(program_->bytes(Program::kData).data());
  t_ns = stamp.t_ns;
  return true;
}

std::string Film::how_it_ended() const {
  char seconds[64] = "";
  std::snprintf(seconds, sizeof(seconds), ", at %.3f s", 1e-9 * static_cast<double>(last_t_ns_));
  const std::string said = program_->last_words();
  return path_.string() + ": ends after " + std::to_string(next_) + " frames" + (has_dropped_ ? seconds : "") +
         (said.empty() ? "" : " (ffmpeg: " + said + ")");
}

}  // namespace pf::sequence
