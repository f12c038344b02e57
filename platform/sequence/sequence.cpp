/// The C functions of sequence.h: they check, call, and turn what was thrown into a message.
#include <planefold_platform/sequence.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "calibration.h"
#include "decode.h"
#include "film.h"
#include "folder.h"
#include "frame_gaps.h"
#include "imu.h"
#include "imu_model.h"
#include "levels.h"
#include "mask.h"
#include "refuse.h"
#include "target.h"
#include "yaml_fields.h"

struct pf_sequence {
  pf::sequence::Folder folder;
  std::string root, calibration_path, truth_path, imu_path, mask_path;
  std::string warning;  ///< all notes, one a line
  std::vector<unsigned char> bytes;
  pf_decoded_t image{};
  std::string first_name;  ///< of the first image that was decoded, "" before
  int32_t first_channels = 0, first_bits = 0;
  pf::sequence::Levels levels;
  bool most_have_size = false;               ///< a single image of another size is left out
  std::unique_ptr<pf::sequence::Film> film;  ///< null: a folder of images

  pf_sequence() = default;
  pf_sequence(const pf_sequence&) = delete;
  pf_sequence& operator=(const pf_sequence&) = delete;
  ~pf_sequence() { pf_decode_free(&image); }
};

namespace {

using pf::sequence::refuse;

constexpr size_t kMaxImageBytes = size_t{64} << 20;

void put(char message[PF_SEQUENCE_MESSAGE], const char* text) {
  if (message != nullptr) {
    std::snprintf(message, PF_SEQUENCE_MESSAGE, "%s", text);
  }
}

/// Notes below each other: as many whole lines as fit, and how many more there are.
void put_notes(char message[PF_SEQUENCE_MESSAGE], const std::vector<std::string>& notes) {
  constexpr size_t kRoomForRest = 40;
  std::string lines;
  for (size_t i = 0; i < notes.size(); ++i) {
    const std::string line = (lines.empty() ? "" : "\n") + notes[i];
    if (lines.size() + line.size() + kRoomForRest >= PF_SEQUENCE_MESSAGE) {
      lines += (lines.empty() ? "" : "\n") + std::to_string(notes.size() - i) + " more notes do not fit here";
      break;
    }
    lines += line;
  }
  put(message, lines.c_str());
}

std::string or_empty(const char* text) { return text != nullptr ? text : ""; }

/// Runs a function that may throw; nothing passes the C boundary.
template <typename Function>
int guarded(char message[PF_SEQUENCE_MESSAGE], const Function& function) {
  try {
    put(message, "");
    function();
    return 0;
  } catch (const std::bad_alloc&) {
    put(message, "not enough memory to read this");
  } catch (const pf::sequence::ImageError& error) {
    put(message, error.what());
    return PF_SEQUENCE_UNUSABLE_IMAGE;
  } catch (const pf::sequence::CalibrationError& error) {
    put(message, error.what());
    return PF_SEQUENCE_WRONG_CALIBRATION;
  } catch (const std::exception& error) {
    put(message, error.what());
  } catch (...) {
    put(message, "unknown failure while reading");
  }
  return -1;
}

/// The pixels of a frame, in sequence.image.
void decode(pf_sequence& sequence, const pf::sequence::Frame& frame) {
  try {
    pf::sequence::read_bytes(frame.path, kMaxImageBytes, "image", sequence.bytes);
  } catch (const pf::sequence::ReadError& error) {
    throw pf::sequence::ImageError(error.what());
  }
  char why[PF_DECODE_WHY] = "";
  if (pf_decode_image(sequence.bytes.data(), sequence.bytes.size(), &sequence.image, why) != 0) {
    throw pf::sequence::ImageError(frame.path.string() + ": " + why + "; replace or remove this image");
  }
}

std::string type_name(int32_t channels, int32_t bits) {
  return std::string(channels == 1 ? "grey" : "colour") + " of " + std::to_string(bits) + " bits";
}

/// Images of another type belong to another sequence: depth beside colour, say.
void require_type(pf_sequence& sequence, const pf::sequence::Frame& frame) {
  const pf_decoded_t& image = sequence.image;
  if (sequence.first_name.empty()) {
    sequence.first_name = frame.path.filename().string();
    sequence.first_channels = image.channels;
    sequence.first_bits = image.bits;
  }
  if (image.channels != sequence.first_channels || image.bits != sequence.first_bits) {
    refuse(frame.path.string() + ": is " + type_name(image.channels, image.bits) + ", but " + sequence.first_name +
           " is " + type_name(sequence.first_channels, sequence.first_bits) +
           "; use images of one kind (times.txt can name them)");
  }
}

/// Size of the first image that can be used.
pf::sequence::ImageSize size_of_images(pf_sequence& sequence) {
  if (sequence.film != nullptr) {
    return sequence.film->size();
  }
  std::string first_error;
  for (const pf::sequence::Frame& frame : sequence.folder.frames) {
    try {
      decode(sequence, frame);
      first_error.clear();
      break;
    } catch (const pf::sequence::ImageError& error) {
      first_error = first_error.empty() ? error.what() : first_error;
    }
  }
  if (!first_error.empty()) {
    refuse(first_error);
  }
  return {sequence.image.width, sequence.image.height};
}

/// What the file of an image says that its user may not know; empty: nothing.
std::string doubt_of(const pf_decoded_t& image, const std::string& name) {
  if (image.orientation > 1) {
    return name + ": says by EXIF that it is shown rotated or mirrored (orientation " +
           std::to_string(image.orientation) +
           "); pixels are taken as stored, so the calibration must be of images as stored";
  }
  return "";
}

bool has_size_of(const pf_decoded_t& image, const pf_camera_t& camera) {
  return image.width == camera.width && image.height == camera.height;
}

/// Looks at a few images over the sequence: which numbers are black and white, and whether most have the camera's size. What cannot be
/// read is told when it is its turn.
void look_at_some(pf_sequence& sequence, std::vector<std::string>& notes) {
  constexpr size_t kLooks = 5;
  if (sequence.film != nullptr) {
    return;
  }
  const std::vector<pf::sequence::Frame>& frames = sequence.folder.frames;
  std::vector<uint32_t> histogram(pf::sequence::kNumbersOf16Bits, 0);
  sequence.image.histogram = histogram.data();
  size_t seen = 0, of_size = 0, before = frames.size();
  for (size_t look = 0; look < kLooks; ++look) {
    const size_t at = look * (frames.size() - 1) / (kLooks - 1);
    if (at == before) {
      continue;
    }
    before = at;
    try {
      decode(sequence, frames[at]);
    } catch (const pf::sequence::ImageError&) {
      continue;
    }
    if (seen == 0) {
      notes.push_back(doubt_of(sequence.image, frames[at].path.string()));
    }
    ++seen;
    of_size += has_size_of(sequence.image, sequence.folder.calibration.camera) ? 1 : 0;
  }
  sequence.image.histogram = nullptr;
  sequence.most_have_size = 2 * of_size > seen && seen > 2;
  sequence.levels = pf::sequence::levels_of(histogram, frames.front().path.string());
  sequence.image.black = sequence.levels.black;
  sequence.image.white = sequence.levels.white;
  notes.push_back(sequence.levels.note);
}

/// Of data of fewer bits than 16, a number beyond what the first images had: white moves up.
void follow_white(pf_sequence& sequence, const pf::sequence::Frame& frame) {
  if (!sequence.levels.stretched && sequence.image.white > 0 && sequence.image.brightest > sequence.image.white) {
    sequence.image.white = pf::sequence::white_for(sequence.image.brightest);
    decode(sequence, frame);
  }
}

/// Refuses an image of another size than the calibration's.
void require_size(const pf_sequence& sequence, const pf::sequence::Frame& frame, int32_t width, int32_t height) {
  const pf_camera_t& camera = sequence.folder.calibration.camera;
  if (width == camera.width && height == camera.height) {
    return;
  }
  const bool calibrated = !sequence.calibration_path.empty();
  refuse(frame.path.string() + ": is " + std::to_string(width) + " x " + std::to_string(height) + " pixels, but the " +
         (calibrated ? "calibration " + sequence.calibration_path : "first image") + " is for " +
         std::to_string(camera.width) + " x " + std::to_string(camera.height) +
         (calibrated ? "; use the calibration of these images" : "; use images of one size"));
}

/// A frame of a film. Throws ReadError; false: it ended before, and message says where.
bool read_film_frame(pf_sequence& sequence, int64_t index, pf_image_t& image, char message[PF_SEQUENCE_MESSAGE]) {
  const unsigned char* pixels = nullptr;
  int64_t t_ns = 0;
  if (!sequence.film->read(index, pixels, t_ns)) {
    put(message, sequence.film->how_it_ended().c_str());
    return false;
  }
  const pf::sequence::ImageSize size = sequence.film->size();
  require_size(sequence, sequence.folder.frames.front(), size.width, size.height);
  image = pf_image_t{pixels, size.width, size.height, size.width, t_ns};
  return true;
}

/// A camera of which only the size is known, and the form of its pixels.
pf_camera_t uncalibrated_camera(pf::sequence::ImageSize size, const pf::sequence::Folder& folder) {
  const bool rotated = folder.is_film && size.width == folder.film_size.height && size.width != size.height;
  pf_camera_t camera{};
  camera.model = PF_CAMERA_PINHOLE;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = camera.width;
  camera.fy = rotated ? camera.fx / folder.pixel_aspect : camera.fx * folder.pixel_aspect;
  camera.cx = 0.5 * (camera.width - 1);
  camera.cy = 0.5 * (camera.height - 1);
  return camera;
}

/// A first pose whose rotation is not known within a quarter of a turn: its sigma is hardly in radians.
std::string doubt_of_angles(const pf_target_t& target, const std::string& path) {
  constexpr double kMost = 0.5, kDegree = 3.14159265358979323846 / 180.0;
  const double sigma = target.kind == PF_TARGET_POINTS ? std::sqrt(target.first_pose.covariance[0]) : 0.0;
  if (sigma <= kMost) {
    return "";
  }
  char text[200];
  std::snprintf(
      text, sizeof(text),
      ": sigma_rotation of %.4g is in radians, and so %.3g degrees; were degrees meant, write sigma_rotation: %.4g",
      sigma, sigma / kDegree, sigma * kDegree);
  return path + text;
}

void require(const void* pointer, const char* name) {
  if (pointer == nullptr) {
    refuse(std::string(name) + " is null");
  }
}

}  // namespace

int pf_open_sequence(const char* source, const char* calibration, pf_sequence_t** sequence,
                     char message[PF_SEQUENCE_MESSAGE]) {
  return pf_open_sequence_of(source, calibration, nullptr, sequence, message);
}

int pf_open_sequence_of(const char* source, const char* calibration, const char* camera, pf_sequence_t** sequence,
                        char message[PF_SEQUENCE_MESSAGE]) {
  return guarded(message, [&] {
    require(source, "source");
    require(sequence, "sequence");
    *sequence = nullptr;
    auto opened = std::make_unique<pf_sequence>();
    pf::sequence::Folder& folder = opened->folder;
    folder = pf::sequence::open_folder(source, or_empty(calibration), or_empty(camera));
    opened->root = folder.root.string();
    opened->calibration_path = folder.calibration_path.string();
    opened->truth_path = folder.truth_path.string();
    opened->imu_path = folder.imu_path.string();
    if (!folder.is_film) {
      opened->mask_path = pf::sequence::find_mask(folder.frames.front().path, folder.root).string();
    }
    if (folder.is_film) {
      opened->film = std::make_unique<pf::sequence::Film>(folder.root);
    }
    if (or_empty(calibration) == PF_SEQUENCE_UNCALIBRATED) {
      folder.calibration.camera = uncalibrated_camera(size_of_images(*opened), folder);
    } else if (folder.calibration.camera.width == 0) {
      folder.asked.images = size_of_images(*opened);
      pf::sequence::read_calibration_of(folder);
    }
    std::vector<std::string> notes = folder.notes;
    notes.insert(notes.end(), folder.calibration.notes.begin(), folder.calibration.notes.end());
    const std::string gap = pf::sequence::longest_gap(folder.frames);
    notes.push_back(gap.empty() ? "" : opened->root + ": " + gap);
    look_at_some(*opened, notes);
    for (const std::string& line : notes) {
      opened->warning += (opened->warning.empty() || line.empty() ? "" : "\n") + line;
    }
    *sequence = opened.release();
  });
}

void pf_close_sequence(pf_sequence_t* sequence) { delete sequence; }

void pf_get_sequence_info(const pf_sequence_t* sequence, pf_sequence_info_t* info) {
  if (sequence == nullptr || info == nullptr) {
    return;
  }
  const pf::sequence::Folder& folder = sequence->folder;
  info->camera = folder.calibration.camera;
  info->count = static_cast<int64_t>(folder.frames.size());
  info->first_t_ns = folder.frames.front().t_ns;
  info->last_t_ns = folder.frames.back().t_ns;
  info->rate_hz = folder.is_film ? folder.film_rate_hz : folder.calibration.rate_hz;
  if (!(info->rate_hz > 0.0)) {
    const double seconds = 1e-9 * static_cast<double>(info->last_t_ns - info->first_t_ns);
    info->rate_hz = seconds > 0.0 ? static_cast<double>(info->count - 1) / seconds : 30.0;
  }
  info->in_order = folder.is_film ? 1 : 0;
  info->folder = sequence->root.c_str();
  info->calibration_path = sequence->calibration_path.c_str();
  info->calibration_form = folder.calibration.form;
  info->camera_name = folder.calibration.camera_name.c_str();
  info->truth_path = sequence->truth_path.c_str();
  info->imu_path = sequence->imu_path.c_str();
  info->mask_path = sequence->mask_path.c_str();
  info->warning = sequence->warning.c_str();
}

int pf_read_mask(const char* path, int32_t width, int32_t height, uint8_t* pixels, char message[PF_SEQUENCE_MESSAGE]) {
  return guarded(message, [&] {
    require(path, "path");
    require(pixels, "pixels");
    const std::vector<uint8_t> mask = pf::sequence::read_mask(path, width, height);
    std::copy(mask.begin(), mask.end(), pixels);
  });
}

int pf_read_sequence_frame(pf_sequence_t* sequence, int64_t index, pf_image_t* image,
                           char message[PF_SEQUENCE_MESSAGE]) {
  bool ended = false;
  const int result = guarded(message, [&] {
    require(sequence, "sequence");
    require(image, "image");
    const pf::sequence::Folder& folder = sequence->folder;
    if (index < 0 || index >= static_cast<int64_t>(folder.frames.size())) {
      refuse(sequence->root + ": frame " + std::to_string(index) + " is not one of its " +
             std::to_string(folder.frames.size()));
    }
    if (sequence->film != nullptr) {
      ended = !read_film_frame(*sequence, index, *image, message);
      return;
    }
    const pf::sequence::Frame& frame = folder.frames[static_cast<size_t>(index)];
    decode(*sequence, frame);
    const pf_decoded_t& decoded = sequence->image;
    const pf_camera_t& camera = folder.calibration.camera;
    if (!has_size_of(decoded, camera) && sequence->most_have_size) {
      throw pf::sequence::ImageError(frame.path.string() + ": is " + std::to_string(decoded.width) + " x " +
                                     std::to_string(decoded.height) + " pixels among images of " +
                                     std::to_string(camera.width) + " x " + std::to_string(camera.height));
    }
    require_type(*sequence, frame);
    follow_white(*sequence, frame);
    require_size(*sequence, frame, decoded.width, decoded.height);
    *image = pf_image_t{decoded.pixels, decoded.width, decoded.height, decoded.width, frame.t_ns};
  });
  return ended ? PF_SEQUENCE_END : result;
}

const char* pf_get_sequence_frame_path(const pf_sequence_t* sequence, int64_t index) {
  if (sequence == nullptr || index < 0 || index >= static_cast<int64_t>(sequence->folder.frames.size())) {
    return "";
  }
  return sequence->folder.frames[static_cast<size_t>(index)].path.c_str();
}

int pf_parse_calibration(const char* text, size_t size, const char* name, pf_camera_t* camera, double* rate_hz,
                         char message[PF_SEQUENCE_MESSAGE]) {
  return pf_parse_calibration_of(text, size, name, nullptr, camera, rate_hz, message);
}

int pf_parse_calibration_of(const char* text, size_t size, const char* name, const char* which, pf_camera_t* camera,
                            double* rate_hz, char message[PF_SEQUENCE_MESSAGE]) {
  return guarded(message, [&] {
    require(text, "text");
    require(camera, "camera");
    const std::string file = name != nullptr ? name : "calibration";
    pf::sequence::Asked asked;
    asked.camera = or_empty(which);
    const auto calibration = pf::sequence::parse_calibration(std::string(text, size), file, asked);
    pf::sequence::require_image_size(calibration, file);
    *camera = calibration.camera;
    if (rate_hz != nullptr) {
      *rate_hz = calibration.rate_hz;
    }
    put_notes(message, calibration.notes);
  });
}

int pf_read_calibration(const char* path, pf_camera_t* camera, double* rate_hz, char message[PF_SEQUENCE_MESSAGE]) {
  return pf_read_calibration_of(path, nullptr, camera, rate_hz, message);
}

int pf_read_calibration_of(const char* path, const char* which, pf_camera_t* camera, double* rate_hz,
                           char message[PF_SEQUENCE_MESSAGE]) {
  std::string text;
  const int done = guarded(message, [&] {
    require(path, "path");
    text = pf::sequence::read_text(path, pf::sequence::kMaxYamlBytes, "calibration");
  });
  return done != 0 ? done : pf_parse_calibration_of(text.data(), text.size(), path, which, camera, rate_hz, message);
}

int pf_read_target(const char* path, pf_target_t* target, char message[PF_SEQUENCE_MESSAGE]) {
  return guarded(message, [&] {
    require(path, "path");
    require(target, "target");
    *target = pf::sequence::read_target(path);
    put(message, doubt_of_angles(*target, path).c_str());
  });
}

int pf_read_first_pose(const char* path, pf_pose_t* pose, char message[PF_SEQUENCE_MESSAGE]) {
  return guarded(message, [&] {
    require(path, "path");
    require(pose, "pose");
    *pose = pf::sequence::read_first_pose(path);
  });
}

int pf_parse_rectangle(const char* text, pf_target_t* target, char message[PF_SEQUENCE_MESSAGE]) {
  return guarded(message, [&] {
    require(text, "text");
    require(target, "target");
    *target = pf::sequence::parse_rectangle(text);
  });
}

/// Hands the samples that a function reads over to the caller, with its note as message.
template <typename Read>
static int give_samples(pf_imu_sample_t** samples, size_t* count, char* message, const Read& read) {
  return guarded(message, [&] {
    require(samples, "samples");
    require(count, "count");
    *samples = nullptr;
    *count = 0;
    std::string note;
    const std::vector<pf_imu_sample_t> all = read(note);
    auto copy = std::make_unique<pf_imu_sample_t[]>(all.size());
    std::copy(all.begin(), all.end(), copy.get());
    *count = all.size();
    *samples = copy.release();
    put(message, note.c_str());
  });
}

int pf_parse_imu(const char* text, size_t size, const char* name, pf_imu_sample_t** samples, size_t* count,
                 char message[PF_SEQUENCE_MESSAGE]) {
  return give_samples(samples, count, message, [&](std::string& note) {
    require(text, "text");
    return pf::sequence::parse_imu(std::string_view(text, size), name != nullptr ? name : "text", note);
  });
}

int pf_read_imu(const char* path, pf_imu_sample_t** samples, size_t* count, char message[PF_SEQUENCE_MESSAGE]) {
  return give_samples(samples, count, message, [&](std::string& note) {
    require(path, "path");
    return pf::sequence::read_imu(path, note);
  });
}

int pf_parse_imu_noise(const char* text, size_t size, const char* name, pf_imu_model_t* imu,
                       char message[PF_SEQUENCE_MESSAGE]) {
  return guarded(message, [&] {
    require(text, "text");
    require(imu, "imu");
    pf_imu_model_t read = *imu;
    std::vector<std::string> notes;
    pf::sequence::parse_imu_noise(std::string(text, size), name != nullptr ? name : "text", &read, notes);
    *imu = read;
    put_notes(message, notes);
  });
}

int pf_parse_imu_mount(const char* text, size_t size, const char* name, pf_imu_model_t* imu,
                       char message[PF_SEQUENCE_MESSAGE]) {
  return pf_parse_imu_mount_of(text, size, name, nullptr, imu, message);
}

int pf_parse_imu_mount_of(const char* text, size_t size, const char* name, const char* camera, pf_imu_model_t* imu,
                          char message[PF_SEQUENCE_MESSAGE]) {
  return guarded(message, [&] {
    require(text, "text");
    require(imu, "imu");
    pf_imu_model_t read = *imu;
    std::vector<std::string> notes;
    pf::sequence::parse_imu_mount(std::string(text, size), name != nullptr ? name : "text", or_empty(camera), &read,
                                  notes);
    *imu = read;
    put_notes(message, notes);
  });
}

/// The text of a file that one of the functions above parses. 0: text is filled.
static int read_imu_text(const char* path, const char* what, std::string& text, char* message) {
  return guarded(message, [&] {
    require(path, "path");
    text = pf::sequence::read_text(path, pf::sequence::kMaxImuModelBytes, what);
  });
}

int pf_read_imu_noise(const char* path, pf_imu_model_t* imu, char message[PF_SEQUENCE_MESSAGE]) {
  std::string text;
  const int done = read_imu_text(path, "inertial noise", text, message);
  return done != 0 ? done : pf_parse_imu_noise(text.data(), text.size(), path, imu, message);
}

int pf_read_imu_mount(const char* path, pf_imu_model_t* imu, char message[PF_SEQUENCE_MESSAGE]) {
  return pf_read_imu_mount_of(path, nullptr, imu, message);
}

int pf_read_imu_mount_of(const char* path, const char* camera, pf_imu_model_t* imu, char message[PF_SEQUENCE_MESSAGE]) {
  std::string text;
  const int done = read_imu_text(path, "inertial mounting", text, message);
  return done != 0 ? done : pf_parse_imu_mount_of(text.data(), text.size(), path, camera, imu, message);
}

void pf_free_imu(pf_imu_sample_t* samples) { delete[] samples; }
