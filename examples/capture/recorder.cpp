#include "recorder.h"

#include <planefold_platform/sequence.h>
#include <png.h>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstring>

namespace pf::capture {

namespace {

namespace fs = std::filesystem;

/// 8-bit grey, not compressed. false: errno says why.
bool write_png(const fs::path& path, const uint8_t* pixels, int32_t width, int32_t height) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) {
    return false;
  }
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  bool done = false;
  if (info != nullptr && setjmp(png_jmpbuf(png)) == 0) {
    png_init_io(png, file);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, PNG_COLOR_TYPE_GRAY,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png, 0);
    png_set_filter(png, 0, PNG_FILTER_NONE);
    png_write_info(png, info);
    for (int32_t y = 0; y < height; ++y) {
      png_write_row(png, pixels + static_cast<ptrdiff_t>(y) * width);
    }
    png_write_end(png, info);
    done = true;
  }
  png_destroy_write_struct(&png, &info);
  return std::fclose(file) == 0 && done;
}

}  // namespace

bool Recorder::open(const std::string& folder, const pf_camera_t& camera, double rate_hz, std::string& error) {
  camera_folder_ = fs::path(folder) / "mav0" / "cam0";
  std::error_code failure;
  if (fs::exists(camera_folder_ / "data.csv", failure)) {
    error = folder + ": holds a recording already; choose another --record or remove it";
    return false;
  }
  if (fs::exists(folder, failure) && (!fs::is_directory(folder, failure) || !fs::is_empty(folder, failure))) {
    error = folder + ": is not empty, and a recording needs a folder of its own; choose another --record";
    return false;
  }
  fs::create_directories(camera_folder_ / "data", failure);
  if (!table_.create(camera_folder_ / "data.csv") || !tracked_.create(camera_folder_ / "tracked.csv")) {
    error = folder + ": cannot be written (" + std::strerror(errno) + "); choose another --record";
    return false;
  }
  table_.rows() = "#timestamp [ns],filename\n";
  tracked_.rows() = "#timestamp [ns] of the frames that were tracked\n";
  char message[PF_SEQUENCE_MESSAGE];
  const std::string sensor = (camera_folder_ / "sensor.yaml").string();
  if (pf_write_calibration(sensor.c_str(), PF_CALIBRATION_EUROC, &camera, rate_hz, message) != 0) {
    error = message;
    return false;
  }
  thread_ = std::thread([this] { work(); });
  return true;
}

void Recorder::add(const pf_image_t& image) {
  Picture picture{image.t_ns, image.width, image.height, {}};
  const size_t area = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return waiting_bytes_ < kWaitingBytes; });
    if (!spare_.empty()) {
      picture.pixels.swap(spare_.back());
      spare_.pop_back();
    }
  }
  picture.pixels.resize(area);
  for (int32_t y = 0; y < image.height; ++y) {
    std::copy_n(image.pixels + static_cast<ptrdiff_t>(y) * image.stride, image.width,
                picture.pixels.begin() + static_cast<ptrdiff_t>(y) * image.width);
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_bytes_ += area;
  waiting_.push_back(std::move(picture));
  changed_.notify_all();
}

void Recorder::mark_tracked(int64_t t_ns) {
  std::string error;
  append(tracked_.rows(), "%" PRId64 "\n", t_ns);
  if (!tracked_.write_rows(error)) {
    const std::lock_guard<std::mutex> lock(mutex_);
    failure_ = failure_.empty() ? error : failure_;
  }
}

bool Recorder::failed(std::string& error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  error = failure_.empty() ? error : failure_;
  return !failure_.empty();
}

void Recorder::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return stop_ || !waiting_.empty(); });
    if (waiting_.empty()) {
      return;
    }
    Picture picture = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    write(picture);
    lock.lock();
    waiting_bytes_ -= picture.pixels.size();
    spare_.push_back(std::move(picture.pixels));
    changed_.notify_all();
  }
}

/// The table names a frame only after its file is complete, so that whatever ends the program leaves a readable recording.
void Recorder::write(const Picture& picture) {
  std::string error;
  if (failed(error)) {
    return;
  }
  const std::string name = std::to_string(picture.t_ns) + ".png";
  const fs::path path = camera_folder_ / "data" / name;
  bool written = write_png(path, picture.pixels.data(), picture.width, picture.height);
  if (!written) {
    error = path.string() + ": could not be written (" + std::strerror(errno) + "); is the disk full?";
    std::error_code ignored;
    fs::remove(path, ignored);
  } else {
    append(table_.rows(), "%" PRId64 ",%s\n", picture.t_ns, name.c_str());
    written = table_.write_rows(error);
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  failure_ = written ? failure_ : error;
  frames_ += written ? 1 : 0;
}

bool Recorder::close(std::string* error) {
  if (thread_.joinable()) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stop_ = true;
      changed_.notify_all();
    }
    thread_.join();
  }
  for (TextFile* file : {&table_, &tracked_}) {
    file->write_rows(failure_);
    file->close();
  }
  if (error != nullptr) {
    *error = failure_;
  }
  return failure_.empty();
}

}  // namespace pf::capture
