#include "film_facts.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <map>

#include "numbers.h"
#include "program.h"
#include "refuse.h"

namespace pf::sequence {

namespace {

constexpr size_t kMaxAnswer = size_t{1} << 30;
constexpr size_t kMinFrames = 2;
/// A film that ends so much earlier than it says itself is cut off: seconds and intervals between frames, whichever is more.
constexpr double kMissingS = 0.5, kMissingFrames = 5.0;

struct Packets {
  std::vector<int64_t> t_ns;
  size_t frames = 0;  ///< with or without a time
};

struct Answer : Packets {                ///< of the first film in the file
  std::map<std::string, Packets> films;  ///< by the index of their stream
  std::map<std::string, std::string> stream, format;

  bool has_film() const { return stream.count("width") != 0; }
};

std::map<std::string, std::string> fields_of(std::string_view line) {
  std::map<std::string, std::string> fields;
  for (size_t begin = 0; begin < line.size();) {
    const size_t end = std::min(line.find('|', begin), line.size());
    const std::string_view field = line.substr(begin, end - begin);
    const size_t equals = field.find('=');
    if (equals != std::string_view::npos) {
      fields.emplace(field.substr(0, equals), field.substr(equals + 1));
    }
    begin = end + 1;
  }
  return fields;
}

double number(const std::map<std::string, std::string>& fields, const char* name) {
  const auto found = fields.find(name);
  double value = 0.0;
  return found != fields.end() && parse_double(found->second, value) ? value : 0.0;
}

/// Lines of ffprobe's compact form: "packet|stream_index=0|pts_time=0.033333|flags=K_".
void parse_line(std::string_view line, Answer& answer) {
  const auto begins = [&](std::string_view word) { return line.substr(0, word.size()) == word; };
  if (begins("packet|")) {
    const auto fields = fields_of(line);
    const auto flags = fields.find("flags");
    if (flags != fields.end() && flags->second.find('D') != std::string::npos) {
      return;  // the film says that it is not shown
    }
    const auto index = fields.find("stream_index");
    Packets& film = answer.films[index != fields.end() ? index->second : ""];
    ++film.frames;
    const auto time = fields.find("pts_time");
    int64_t t_ns = 0;
    if (time != fields.end() && parse_seconds(time->second, t_ns)) {
      film.t_ns.push_back(t_ns);
    }
  } else if (begins("stream|") && answer.stream.empty()) {
    answer.stream = fields_of(line);
  } else if (begins("format|")) {
    answer.format = fields_of(line);
  }
}

Answer ask(Program& program, const fs::path& path) {
  Answer answer;
  std::vector<char>& bytes = program.bytes(Program::kData);
  for (bool more = true; more;) {
    more = program.read_more(kMaxAnswer);
    auto begin = bytes.begin();
    for (auto end = begin; (end = std::find(begin, bytes.end(), '\n')) != bytes.end(); begin = end + 1) {
      parse_line(std::string_view(&*begin, static_cast<size_t>(end - begin)), answer);
    }
    bytes.erase(bytes.begin(), begin);
    size_t frames = 0;
    for (const auto& film : answer.films) {
      frames += film.second.frames;
    }
    if (bytes.size() >= kMaxAnswer || frames > kMaxAnswer / sizeof(int64_t)) {
      refuse(path.string() + ": has more frames than any film; is it one?");
    }
  }
  static_cast<Packets&>(answer) = answer.films[answer.stream["index"]];
  std::sort(answer.t_ns.begin(), answer.t_ns.end());
  return answer;
}

bool is_mp4(const fs::path& path) {
  std::array<char, 12> begin{};
  std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
  const std::string_view kind(begin.data() + 4, 4);
  return kind == "ftyp" || kind == "moov" || kind == "mdat" || kind == "wide" || kind == "free";
}

[[noreturn]] void refuse_film(const fs::path& path, const Program& program, const Answer& answer) {
  const std::string said = program.last_words();
  const bool has_stream = answer.has_film();
  if (!has_stream && number(answer.format, "nb_streams") > 0.0) {
    refuse(path.string() + ": holds sound or a cover picture, but no film; check the file");
  }
  if (program.has_said("moov atom not found") || (is_mp4(path) && !has_stream)) {
    refuse(path.string() +
           ": has no index (moov), without which the frames of an MP4 or MOV cannot be found: its recording was cut "
           "off, or it "
           "was not copied completely; copy it again, or repair it with another film of the same camera (untrunc)");
  }
  refuse(path.string() + ": " + (has_stream ? "none of its frames can be found" : "ffprobe finds no film in it") +
         (said.empty() ? "" : " (" + said + ")") + "; check the file");
}

double median_interval_s(const std::vector<int64_t>& t_ns) {
  std::vector<int64_t> intervals;
  for (size_t i = 1; i < t_ns.size(); ++i) {
    intervals.push_back(t_ns[i] - t_ns[i - 1]);
  }
  if (intervals.empty()) {
    return 0.0;
  }
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return 1e-9 * static_cast<double>(*middle);
}

/// What is missing at its end, as the film itself or ffprobe says; "" where nothing is.
std::string missing_end(const Answer& answer, const Program& program, double interval_s) {
  for (const char* text : {"no index at the end", "File ended prematurely", "partial file", "Truncated"}) {
    if (program.has_said(text)) {
      return text;
    }
  }
  // Some forms count this from the first frame and some from zero: the earlier end is believed. Sound may last longer.
  const bool alone = number(answer.format, "nb_streams") == 1.0;
  const double of_stream_s = number(answer.stream, "duration");
  const double until_s = (of_stream_s > 0.0 ? of_stream_s
                          : alone           ? number(answer.format, "duration")
                                            : 0.0) +
                         std::min(0.0, number(answer.format, "start_time"));
  const double last_s = answer.t_ns.empty() ? until_s : 1e-9 * static_cast<double>(answer.t_ns.back());
  if (until_s - last_s > std::max(kMissingS, kMissingFrames * interval_s)) {
    char text[64];
    std::snprintf(text, sizeof(text), "it says that it lasts until %.3f s", until_s);
    return text;
  }
  return "";
}

/// Width of a pixel by its height, before any rotation: "4:3"; 1 where the film does not say it.
double pixel_aspect(const std::map<std::string, std::string>& stream) {
  const auto found = stream.find("sample_aspect_ratio");
  int across = 0, down = 0;
  const bool says = found != stream.end() && std::sscanf(found->second.c_str(), "%d:%d", &across, &down) == 2;
  return says && across > 0 && down > 0 ? static_cast<double>(across) / down : 1.0;
}

std::vector<std::string> doubts_of(const Answer& answer, const Program& program, double interval_s) {
  std::vector<std::string> doubts;
  const std::string missing = missing_end(answer, program, interval_s);
  if (!missing.empty()) {
    char text[96];
    const double last_s = answer.t_ns.empty() ? 0.0 : 1e-9 * static_cast<double>(answer.t_ns.back());
    std::snprintf(text, sizeof(text), "is cut off after %zu frames, at %.3f s (", answer.frames, last_s);
    doubts.push_back(text + missing + ")");
  }
  const auto order = answer.stream.find("field_order");
  if (order != answer.stream.end() && order->second.size() == 2) {
    doubts.push_back("is interlaced (" + order->second +
                     "): every other row of a frame is of another time; deinterlace it first (ffmpeg -vf bwdif)");
  }
  if (answer.t_ns.size() < answer.frames) {
    doubts.emplace_back("does not say the times of all its frames; they are then counted at its frame rate");
  }
  if (answer.films.size() > 1) {
    doubts.push_back("holds " + std::to_string(answer.films.size()) +
                     " films; the first is taken (ffmpeg -i FILM -map 0:v:1 -c copy SECOND.mkv takes out the second)");
  }
  if (pixel_aspect(answer.stream) != 1.0) {
    doubts.push_back("has pixels of " + answer.stream.at("sample_aspect_ratio") +
                     ", width to height: a calibration must be of these pixels, with another fx than fy");
  }
  return doubts;
}

void require_film_file(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    refuse(path.string() + ": no such film; check the path after the colon of the source");
  }
  if (fs::is_directory(path, error)) {
    refuse(path.string() + ": is a folder, not a film; write images:" + path.string());
  }
  if (!fs::is_regular_file(path, error)) {
    refuse(path.string() + ": is not an ordinary file; a film is read more than once");
  }
  if (!std::ifstream(path, std::ios::binary)) {
    refuse(path.string() + ": cannot be read; check its permissions");
  }
  if (fs::file_size(path, error) == 0) {
    refuse(path.string() + ": is empty (0 bytes); was it copied completely?");
  }
}

}  // namespace

FilmFacts probe_film(const fs::path& path) {
  require_film_file(path);
  Program program({"ffprobe", "-v", "warning", "-protocol_whitelist", "file", "-select_streams", "V", "-show_entries",
                   "packet=stream_index,pts_time,flags:"
                   "stream=index,width,height,sample_aspect_ratio,field_order,duration:"
                   "format=start_time,duration,nb_streams",
                   "-of", "compact", "-i", "file:" + path.string()});
  const Answer answer = ask(program, path);
  if (!answer.has_film() || answer.frames == 0) {
    refuse_film(path, program, answer);
  }
  if (answer.frames < kMinFrames) {
    refuse(path.string() + ": has a single frame; a film has at least two");
  }
  FilmFacts facts;
  facts.t_ns = answer.t_ns;
  const double interval_s = median_interval_s(answer.t_ns);
  facts.rate_hz = interval_s > 0.0 ? 1.0 / interval_s : 0.0;
  facts.size = {static_cast<int32_t>(number(answer.stream, "width")),
                static_cast<int32_t>(number(answer.stream, "height"))};
  facts.pixel_aspect = pixel_aspect(answer.stream);
  for (const std::string& doubt : doubts_of(answer, program, interval_s)) {
    facts.notes.push_back(path.string() + ": " + doubt);
  }
  if (facts.t_ns.size() < answer.frames) {  // counted, so that there is one for each frame
    const double rate_hz = facts.rate_hz > 0.0 ? facts.rate_hz : 30.0;
    facts.t_ns.clear();
    for (size_t i = 0; i < answer.frames; ++i) {
      facts.t_ns.push_back(static_cast<int64_t>(1e9 * static_cast<double>(i) / rate_hz));
    }
  }
  return facts;
}

bool looks_like_film(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* known : {".mp4", ".mov",  ".m4v", ".mkv", ".webm", ".avi", ".nut", ".mpg",  ".mpeg", ".ts",
                            ".mts", ".m2ts", ".wmv", ".flv", ".3gp",  ".ogv", ".y4m", ".h264", ".h265", ".mjpeg"}) {
    if (extension == known) {
      return true;
    }
  }
  std::array<char, 16> begin{};
  std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
  const std::string_view bytes(begin.data(), begin.size());
  return bytes.substr(4, 4) == "ftyp" || bytes.substr(0, 4) == "\x1a\x45\xdf\xa3" ||
         bytes.substr(0, 13) == "nut/multimedi" || (bytes.substr(0, 4) == "RIFF" && bytes.substr(8, 4) == "AVI ");
}

}  // namespace pf::sequence
