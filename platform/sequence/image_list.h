#ifndef PLANEFOLD_PLATFORM_SEQUENCE_IMAGE_LIST_H
#define PLANEFOLD_PLATFORM_SEQUENCE_IMAGE_LIST_H

#include <string>
#include <string_view>
#include <vector>

#include "file.h"

namespace pf::sequence {

/// PNG, JPEG or PGM by its name; hidden files (._x.png, .trashed-1-x.png) are none.
bool is_image_name(const fs::path& name);

/// Image files of a folder in natural order (frame 2 before frame 10).
/// pattern  of their names, with * for any text; "" for all. Throws ReadError where the folder cannot be listed.
std::vector<std::string> list_images(const fs::path& folder, const std::string& pattern = "");

/// "frame-000012.color.PNG" to "frame-#.color.png", and its numbers as "000012 ".
std::string kind_of(const std::string& name, std::string& numbers);

/// The names of one sequence among those of a folder. What is left out (depth beside colour, previews, single files of another name)
/// gets a note each; throws ReadError where it cannot be told which are meant.
std::vector<std::string> one_sequence(const fs::path& folder, const std::vector<std::string>& names,
                                      std::vector<std::string>& notes);

}  // namespace pf::sequence

#endif
