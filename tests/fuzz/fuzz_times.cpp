// Tables of images: times.txt, TUM's rgb.txt or EuRoC's data.csv. Whatever the text, frames in order that stay inside of their folder,
// or one line that says what is wrong.
#include <planefold_platform/sequence.h>

#include <cstring>
#include <string>

#include "bytes.h"
#include "text_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const TextFile times("times.txt"), rgb("rgb.txt"), csv("data.csv");
  static const TextFile calibrations[3] = {times.beside("calib.yaml"), rgb.beside("calib.yaml"),
                                           csv.beside("sensor.yaml")};
  static const std::string sources[3] = {"images:" + times.folder(), "tum:" + rgb.folder(), "euroc:" + csv.folder()};
  static const TextFile* const tables[3] = {&times, &rgb, &csv};
  Bytes bytes(data, size);
  const size_t which = bytes.take<uint8_t>() % 3;
  if (size == 0) return 0;
  static const char calibration[] = "width: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 32\ncy: 24\ndistortion_model: none\n";
  calibrations[which].write(reinterpret_cast<const uint8_t*>(calibration), sizeof(calibration) - 1);
  tables[which]->write(data + 1, size - 1);

  pf_sequence_t* sequence = nullptr;
  char message[PF_SEQUENCE_MESSAGE] = "";
  if (pf_open_sequence(sources[which].c_str(), calibrations[which].path(), &sequence, message) != 0) {
    require(sequence == nullptr && message[0] != '\0' && std::strchr(message, '\n') == nullptr,
            "a refusal is one line");
    return 0;
  }
  pf_sequence_info_t info;
  pf_get_sequence_info(sequence, &info);
  require(info.count > 0 && info.first_t_ns <= info.last_t_ns, "a sequence has frames, in order");
  for (int64_t i = 0; i < info.count; ++i) {
    const char* path = pf_get_sequence_frame_path(sequence, i);
    require(std::strncmp(path, info.folder, std::strlen(info.folder)) == 0 && std::strstr(path, "/../") == nullptr,
            "an image is inside of the folder");
  }
  pf_image_t image;
  require(pf_read_sequence_frame(sequence, 0, &image, message) != 0 && message[0] != '\0', "there is no such image");
  pf_close_sequence(sequence);
  return 0;
}
