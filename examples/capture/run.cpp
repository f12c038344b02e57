#include "run.h"

#include <planefold_platform/sequence.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

#include "anchors.h"
#include "focal_search.h"
#include "imu_feed.h"
#include "map_shape.h"
#include "outputs.h"
#include "progress.h"
#include "realtime.h"
#include "recorder.h"
#include "rejections.h"
#include "relative_motion.h"
#include "session.h"
#include "show.h"
#include "source.h"
#include "statistics.h"
#include "steady.h"
#include "target_distance.h"
#include "text_file.h"

namespace pf::capture {

namespace {

volatile std::sig_atomic_t g_interrupted = 0;
void on_interrupt(int) { g_interrupted = 1; }

/// What report.json says of a run that has not ended: it stays so where the program is killed.
constexpr const char* kRunning = "still running when this was written, or killed since";

int fail(const std::string& line, int code = kExitRun) {
  std::fprintf(stderr, "pf-capture: %s\n", line.c_str());
  return code;
}

/// Each of the lines.
void note(const std::string& lines) {
  std::istringstream rest(lines);
  for (std::string line; std::getline(rest, line);) {
    std::fprintf(stderr, "pf-capture: note: %s\n", line.c_str());
  }
}

/// "images:/data/desk/" to "desk"; a scene keeps its "sim:".
std::string short_name(const std::string& source) {
  const size_t end = source.find_last_not_of('/');
  const size_t begin = source.find_last_of('/', end);
  return begin == std::string::npos ? source : source.substr(begin + 1, end - begin);
}

/// A run from the first frame to the last: one step per frame, and what is kept between them.
class Run {
 public:
  /// guess  of the focal length; null where the source has a calibration
  Run(const Options& options, Source& source, const FocalGuess* guess)
      : options_(options), source_(source), guess_(guess), progress_(options.quiet) {}

  int go();

 private:
  bool open(std::string& error, int& code);
  Read step(int64_t index);
  void track_slowly(int64_t begin_ns) const;
  void tell_notices();
  void handle_keys();
  void point_at(const double pixel[2]);
  void anchor_at(const double pixel[2]);
  void point_at_pointer(void (Run::*act)(const double pixel[2]));
  bool begin_line_on(const double pixel[2], std::string& line);
  void save(const std::string& name);
  bool write_down(std::string& error);
  bool refresh_report();
  int finish();
  std::string why_nothing_was_tracked() const;
  std::vector<Rejection> find_rejections() const;
  static void tell_rejections(const std::vector<Rejection>& rejections);
  void tell_focal();

  const Options& options_;
  Source& source_;
  const FocalGuess* guess_;
  Session session_;
  Outputs outputs_;
  Statistics statistics_;
  RelativeMotion relative_;
  Progress progress_;
  Recorder recorder_;
  ImuFeed imu_;
  Show show_;
  FrameView view_;
  int64_t count_ = 0;
  bool records_itself_ = false;  ///< the source sees to it, with the frames that are passed over
  bool done_any_ = false;
  bool quit_ = false;
  bool paused_ = false;
  bool withdrawn_ = false;    ///< the target
  bool told_target_ = false;  ///< how far away it is
  bool saved_mid_ = false;
  bool told_film_failed_ = false;
  int64_t reported_ns_ = 0;  ///< when report.json was written
  std::string failure_;
};

bool Run::open(std::string& error, int& code) {
  const SourceInfo& info = source_.info();
  if (!imu_.open(options_, source_, options_.there_and_back || options_.loop > 0 ? "" : info.imu_path, error, code)) {
    return false;
  }
  if (!session_.open(options_, source_, imu_, error, code)) {
    return false;
  }
  code = kExitUsage;  // of folders that the command line names
  relative_.open(options_.relative, session_.target() != nullptr);
  const bool patches = options_.tracks && session_.config().capacity.max_patches > 0;
  if (!outputs_.open(options_.out, options_.tracks, patches, info.knows_truth, options_.relative > 0,
                     session_.config().camera, imu_.is_inertial(), error) ||
      !outputs_.write_true_planes(source_.planes(), error)) {
    return false;
  }
  if (!options_.record.empty()) {
    if (!recorder_.open(options_.record, info.camera, info.rate_hz, error)) {
      return false;
    }
    if (!imu_.record_to(options_.record, error)) {
      return false;
    }
    records_itself_ = source_.record_to(recorder_);
  }
  code = kExitRun;
  if (!imu_.start(error)) {
    return false;
  }
  if (options_.film && !outputs_.claim("overlay.mp4", error)) {
    return false;
  }
  std::vector<std::string> notes;
  const std::string title = options_.title.empty() ? short_name(options_.source) : options_.title;
  show_.open(options_, session_, "planefold   " + title, outputs_.path("overlay.mp4"), info.rate_hz, notes);
  if (!place_thread(options_.processor, options_.priority)) {
    notes.emplace_back("--cpu or --priority: the system does not allow it (needs root, or RLIMIT_RTPRIO)");
  }
  for (const std::string& line : notes) {
    note(line);
  }
  return true;
}

int Run::go() {
  const SourceInfo& info = source_.info();
  if (!info.warning.empty()) {
    note(info.warning);
  }
  if (options_.skip >= info.count) {
    return fail("--skip " + std::to_string(options_.skip) + " leaves nothing: the source has " +
                    std::to_string(info.count) + " frames",
                kExitUsage);
  }
  count_ = info.count - options_.skip;
  if (options_.frames > 0 && !options_.there_and_back) {
    count_ = std::min(count_, options_.frames);
  }
  std::string error;
  int code = kExitRun;
  if (!open(error, code)) {
    return fail(error, code);
  }
  reported_ns_ = steady_ns();
  for (int64_t index = 0; index < count_ && !quit_ && g_interrupted == 0;) {
    const Read read = step(index);
    if (read == Read::kEnd || read == Read::kFailed) {
      break;
    }
    index += read == Read::kDone || read == Read::kUnusable ? 1 : 0;
    tell_notices();
    handle_keys();
    if (!refresh_report()) {
      break;
    }
  }
  return finish();
}

/// One frame. kFailed: failure_ says why.
Read Run::step(int64_t index) {
  const int64_t at = options_.skip + index;
  pf_image_t image{};
  const Read read = source_.read(at, image, failure_);
  if (read == Read::kUnusable) {
    statistics_.add_unreadable("frame " + std::to_string(at) + ": " + failure_);
    failure_.clear();
    return read;
  }
  if (read == Read::kFailed && !source_.is_live()) {
    failure_ = "frame " + std::to_string(at) + ": " + failure_;
  }
  if (read != Read::kDone) {
    return read;
  }
  const int64_t begin_ns = steady_ns();
  if (options_.withdraw_target_after >= 0 && index >= options_.withdraw_target_after && !withdrawn_) {
    session_.withdraw_target();
    withdrawn_ = true;
  }
  view_.index = index;
  view_.count = source_.info().endless && options_.frames <= 0 ? 0 : count_;
  imu_.push_until(image.t_ns, session_.slam());
  if (!session_.push(image, view_, failure_)) {
    failure_ = "frame " + std::to_string(at) + " (" + source_.name(at) + "): " + failure_;
    return Read::kFailed;
  }
  for (std::string line; session_.take_notice(view_, line);) {
    note(line);
  }
  if (view_.tracked && session_.target() != nullptr && !told_target_) {
    told_target_ = true;
    note(doubt_of_target(*session_.target(), options_.start, view_.pose));
  }
  imu_.add_frame(index, session_.slam(), view_.pose, view_.tracked);
  follow_planes(session_.slam(), view_.hits);
  for (const Options::Tap& tap : options_.taps) {
    if (tap.frame == index) {
      point_at(tap.pixel);
    }
  }
  for (const Options::Tap& tap : options_.anchors) {
    if (tap.frame == index) {
      anchor_at(tap.pixel);
    }
  }
  track_slowly(begin_ns);
  source_.pushed();
  if (recorder_.is_open()) {
    recorder_.mark_tracked(image.t_ns);
    if (!records_itself_) {
      recorder_.add(image);
    }
  }
  view_.pixels.resize(static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
  for (int32_t y = 0; y < image.height; ++y) {
    std::copy_n(image.pixels + static_cast<ptrdiff_t>(y) * image.stride, image.width,
                view_.pixels.begin() + static_cast<ptrdiff_t>(y) * image.width);
  }
  view_.image = image;
  view_.image.stride = image.width;
  view_.image.pixels = view_.pixels.data();
  done_any_ = true;
  statistics_.add(view_);
  if (!write_down(failure_)) {
    return Read::kFailed;
  }
  progress_.show(view_);
  show_.add(view_);
  if (view_.index >= count_ / 2 && !saved_mid_) {
    saved_mid_ = true;
    save("overlay_mid.png");
  }
  return Read::kDone;
}

/// A disk that is full ends the run at once: its files are whole up to the frame before.
bool Run::write_down(std::string& error) {
  pf_pose_t truth{};
  const bool has_truth = source_.truth(truth);
  const pf_pose_t* true_pose = has_truth ? &truth : nullptr;
  const bool window = relative_.add(session_.slam(), view_, true_pose);
  if (!outputs_.write(view_, source_, window ? &relative_.window() : nullptr, error)) {
    return false;
  }
  return !recorder_.failed(error) && !imu_.failed(error);
}

/// Puts report.json and map.ply in the place of those of a minute ago. false: failure_ says why they could not be written.
bool Run::refresh_report() {
  if (done_any_ && show_.has_film_failed() && !told_film_failed_) {
    told_film_failed_ = true;
    progress_.end();
    note("ffmpeg failed, and " + outputs_.path("overlay.mp4") + " ends here; is the disk full?");
  }
  if (!done_any_ || static_cast<double>(steady_ns() - reported_ns_) < 1e9 * options_.report_every_s) {
    return true;
  }
  const std::string report =
      statistics_.to_json(session_, options_, source_.info(), relative_, source_.report(), "", kRunning);
  const bool written = outputs_.write_state(view_, {}, report, failure_);
  reported_ns_ = steady_ns();
  return written;
}

/// --delay: what tracking would take on a slower processor.
void Run::track_slowly(int64_t begin_ns) const {
  const auto until_ns = begin_ns + static_cast<int64_t>(1e6 * options_.delay_ms);
  while (options_.delay_ms > 0.0 && steady_ns() < until_ns && g_interrupted == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void Run::tell_notices() {
  for (std::string line; source_.take_notice(line) || imu_.take_notice(line);) {
    progress_.end();
    note(line);
  }
}

void Run::save(const std::string& name) {
  std::string error;
  if (!outputs_.claim(name, error)) {
    note(error);
  } else if (!show_.save(view_, outputs_.path(name))) {
    note(outputs_.path(name) + ": could not be written");
  }
}

void Run::handle_keys() {
  do {
    switch (show_.poll(paused_ ? 50 : 0)) {
      case Key::kPause:
        paused_ = !paused_;
        break;
      case Key::kReset: {
        std::string error;
        if (!session_.reset(error)) {
          note(error);
        }
        statistics_.add_reset();
        break;
      }
      case Key::kSave:
        save("overlay_" + std::to_string(view_.index) + ".png");
        break;
      case Key::kQuit:
        quit_ = true;
        break;
      case Key::kClick:
        point_at_pointer(&Run::point_at);
        break;
      case Key::kAnchor:
        point_at_pointer(&Run::anchor_at);
        break;
      case Key::kNone:
        break;
    }
  } while (paused_ && !quit_ && g_interrupted == 0);
}

void Run::point_at_pointer(void (Run::*act)(const double pixel[2])) {
  double pixel[2];
  if (done_any_ && show_.clicked_pixel(pixel)) {
    (this->*act)(pixel);
    show_.redraw(view_);
  }
}

/// What a line about a pixel begins with. false: the pixel is outside of the picture, and the line has been told.
bool Run::begin_line_on(const double pixel[2], std::string& line) {
  progress_.end();
  append(line, "pixel %.1f, %.1f of frame %lld: ", pixel[0], pixel[1], static_cast<long long>(view_.index));
  const pf_camera_t& camera = session_.config().camera;
  if (!(pixel[0] >= -0.5 && pixel[1] >= -0.5 && pixel[0] < camera.width - 0.5 && pixel[1] < camera.height - 0.5)) {
    append(line, "lies outside of the picture of %d x %d pixels", camera.width, camera.height);
    note(line);
    return false;
  }
  return true;
}

/// An anchor on the plane that is there. It stays in the pictures, and in the map.
void Run::anchor_at(const double pixel[2]) {
  std::string line;
  if (!begin_line_on(pixel, line)) {
    return;
  }
  set_anchor(session_.slam(), pixel, session_.is_metric(), line);
  view_.anchors = read_anchors(session_.slam());
  note(line);
}

/// Which plane is there, where, and how sure that is. The last few stay in the pictures.
void Run::point_at(const double pixel[2]) {
  constexpr size_t kShown = 12;
  Hit hit;
  std::string line;
  if (!begin_line_on(pixel, line)) {
    return;
  }
  if (!cast_ray(session_.slam(), view_.index, view_.pose, pixel, hit)) {
    note(line + "no plane is there");
    return;
  }
  append(line, "%s, at %.4g %.4g %.4g", describe(hit, session_.is_metric()).c_str(), hit.at.p_W[0], hit.at.p_W[1],
         hit.at.p_W[2]);
  note(line);
  if (view_.hits.size() == kShown) {
    view_.hits.erase(view_.hits.begin());
  }
  view_.hits.push_back(hit);
}

std::string Run::why_nothing_was_tracked() const {
  const std::string frames = std::to_string(statistics_.frames());
  if (statistics_.frames() == 0 && statistics_.unreadable() > 0) {
    return "none of the images can be used; " + statistics_.unreadable_line();
  }
  if (statistics_.unusable() == statistics_.frames()) {
    return "none of the " + frames + " frames has usable content (black, white or blurred out); look at the images";
  }
  if (statistics_.frames() > 1 && statistics_.duplicates() == statistics_.frames() - 1) {
    return "all " + frames + " frames are the same picture; is the camera frozen?";
  }
  if (session_.target() != nullptr) {
    return "the target was not found in any of the " + frames + " frames; check " + session_.start() +
           " and that the first frames show it";
  }
  return "none of the " + frames + " frames was tracked; the camera has to move sideways past something with texture";
}

/// The last words on a source without a calibration: what was found, and where it was written.
void Run::tell_focal() {
  if (guess_ == nullptr) {
    return;
  }
  double sigma_px = -1.0;
  const pf_camera_t camera = found_camera(session_.slam(), *guess_, sigma_px);
  if (sigma_px < 0.0) {
    return;
  }
  std::printf("%s\n", describe_focal(camera, sigma_px).c_str());
  char message[PF_SEQUENCE_MESSAGE] = "";
  std::string error;
  const std::string path = outputs_.path("calib_found.yaml");
  if (!outputs_.claim("calib_found.yaml", error)) {
    note(error);
  } else if (pf_write_calibration(path.c_str(), PF_CALIBRATION_PLAIN, &camera, 0.0, message) != 0) {
    note(message);
  } else {
    std::printf("the camera as it was found: %s, for --calib\n", path.c_str());
  }
}

int Run::finish() {
  progress_.end();
  tell_notices();
  if (statistics_.unreadable() > 0) {
    note(statistics_.unreadable_line());
  }
  const std::string live = source_.finish();
  std::string not_recorded;
  if (recorder_.is_open() && !recorder_.close(&not_recorded) && failure_.empty()) {
    failure_ = not_recorded;
  }
  if (!imu_.finish(not_recorded) && failure_.empty()) {
    failure_ = not_recorded;
  }
  // A camera has no end: to interrupt it is how such a run ends.
  if (g_interrupted != 0 && failure_.empty() && !(source_.info().endless && options_.frames <= 0)) {
    failure_ =
        "interrupted after " + std::to_string(statistics_.frames()) + " of " + std::to_string(count_) + " frames";
  }
  if (done_any_) {
    save("overlay_last.png");
    if (!saved_mid_) {
      save("overlay_mid.png");
    }
  }
  for (const auto& [option, taps] : {std::pair("--tap", &options_.taps), std::pair("--anchor", &options_.anchors)}) {
    for (const Options::Tap& tap : *taps) {
      if (!done_any_ || tap.frame > view_.index) {
        note(std::string(option) + ": the run ended before frame " + std::to_string(tap.frame) +
             "; its first frame is 0");
      }
    }
  }
  if (options_.relative > 0 && relative_.windows() == 0) {
    note("--relative " + std::to_string(options_.relative) + ": no motion over so many frames was tracked");
  }
  const bool filming = show_.is_filming();
  if (!show_.close_film() && !told_film_failed_) {
    note("ffmpeg failed; " + outputs_.path("overlay.mp4") + " is not complete");
  }
  if (statistics_.tracked() == 0 && failure_.empty()) {
    failure_ = why_nothing_was_tracked();
  } else if (failure_.empty() && statistics_.frames() > 1 && statistics_.duplicates() == statistics_.frames() - 1) {
    failure_ = why_nothing_was_tracked();
  }
  const std::string lost = failure_.empty() ? statistics_.lost_line() : "";
  int64_t turn_ns = 0, images = 0;
  if (source_.turn(turn_ns, images)) {
    statistics_.set_turn(turn_ns, images);
  }
  std::string error, advice;
  const std::string imu = imu_.report(session_.slam(), advice);
  const std::vector<Rejection> rejections = find_rejections();
  const std::string rejected = summary_of(rejections);
  const std::string report = statistics_.to_json(session_, options_, source_.info(), relative_, live, imu, failure_);
  const std::vector<double> in_map = sigmas_in_map(session_.slam(), view_.features);
  if (!outputs_.write_state(view_, in_map, report, error)) {
    return fail(failure_.empty() ? error : failure_);
  }
  if (!failure_.empty()) {
    tell_rejections(rejections);
    return fail(failure_ + (rejected.empty() ? "" : " (" + rejected + ")"));
  }
  if (!advice.empty()) {
    std::printf("%s\n", advice.c_str());
  }
  std::printf("%s\nwritten to %s%s\n", statistics_.summary(session_).c_str(), options_.out.c_str(),
              filming ? " (overlay.mp4 is the film)" : "");
  tell_focal();
  std::fflush(stdout);
  std::string saved;
  if (!options_.save_map.empty() &&
      !MapFile::save(session_.slam(), options_.map_kind, options_.save_map, saved, error)) {
    return fail(error);
  }
  note(saved);
  tell_rejections(rejections);
  return lost.empty() ? kExitDone : fail(lost + (rejected.empty() ? "" : " (" + rejected + ")"));
}

std::vector<Rejection> Run::find_rejections() const {
  std::vector<Rejection> rejections;
  if (done_any_) {
    imu_.add_rejections(session_.slam(), rejections);
    session_.plan().add_rejections(session_.slam(), rejections);
    if (guess_ == nullptr) {
      add_rejected_calibration(session_.slam(), session_.config().camera, rejections);
    }
  }
  return rejections;
}

/// The last lines that the user sees.
void Run::tell_rejections(const std::vector<Rejection>& rejections) {
  for (const Rejection& rejection : rejections) {
    note(rejection.line);
  }
}

/// The folder of "DIR/left_*.png"; another path as it is.
std::string without_pattern(const std::string& path) {
  const size_t slash = path.find_last_of('/');
  const size_t star = path.find_last_of('*');
  if (star == std::string::npos || (slash != std::string::npos && star < slash)) {
    return path;
  }
  return slash == std::string::npos ? "." : path.substr(0, slash);
}

/// No file that is read may be one that an earlier run left in the folders that are written, and that goes.
bool spares_inputs(const Options& options, std::string& error) {
  std::vector<std::string> inputs = {options.calibration, options.second_pose, options.walls,
                                     options.imu_noise,   options.imu_mount,   options.map};
  for (const std::string* text : {&options.source, &options.start, &options.imu}) {
    const std::string kind = text->substr(0, text->find(':'));
    for (const char* reads : {"images", "euroc", "tum", "video", "target", "pose", "csv"}) {
      if (kind == reads && kind.size() < text->size()) inputs.push_back(without_pattern(text->substr(kind.size() + 1)));
    }
  }
  for (const auto& [option, folder] : {std::pair("--out", options.out), std::pair("--record", options.record)}) {
    for (const std::string& input : inputs) {
      char message[PF_SEQUENCE_MESSAGE] = "";
      if (!folder.empty() && !input.empty() &&
          pf_check_output_input(folder.c_str(), option, input.c_str(), message) != 0) {
        error = message;
        return false;
      }
    }
  }
  return true;
}

}  // namespace

int run(const Options& options) {
  // ffmpeg may end early: writing to it must then fail, not end this program.
  std::signal(SIGPIPE, SIG_IGN);
  // A file that may not grow any more is an error to tell of.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGHUP, on_interrupt);
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  std::string error;
  if (!spares_inputs(options, error)) {
    return fail(error, kExitUsage);
  }
  FocalGuess guess;
  Options chosen = options;
  const bool guesses = is_uncalibrated(options);
  if (guesses) {
    if (!search_focal(
            options, [] { return g_interrupted != 0; }, guess, error)) {
      return fail(error);
    }
    note(describe(guess));
    chosen.guess = guess.camera;
  }
  const std::unique_ptr<Source> source = open_source(chosen, error);
  if (source == nullptr) {
    return fail(error, is_command_line_wrong(options) ? kExitUsage : kExitRun);
  }
  return Run(chosen, *source, guesses ? &guess : nullptr).go();
}

}  // namespace pf::capture
