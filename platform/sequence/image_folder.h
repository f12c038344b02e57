#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMAGE_FOLDER_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMAGE_FOLDER_H

#include <string>
#include <vector>

#include "file.h"

namespace pf::sequence {

/// The folder that holds the images of a sequence: images/, KITTI's image_0/ or image_2/, the folder itself, or the only one inside that
/// holds images. Throws ReadError where there are several.
/// has_times  a table names images, or counts them
/// notes      get what was chosen where there was a choice
fs::path find_images(const fs::path& root, bool has_times, std::vector<std::string>& notes);

/// Whether several folders inside hold images, themselves or in their data/.
bool has_several_cameras(const fs::path& root);

}  // namespace pf::sequence

#endif
