#ifndef PLANEFOLD_PLATFORM_SEQUENCE_TARGET_H
#define PLANEFOLD_PLATFORM_SEQUENCE_TARGET_H

#include <planefold/planefold.h>

#include <string>

namespace pf::sequence {

/// One of the forms of pf_read_target. Throws ReadError that names the file and the field.
pf_target_t parse_target(const std::string& text, const std::string& file);
pf_target_t read_target(const std::string& path);

/// One line of pf_read_first_pose. Throws ReadError that names the file.
pf_pose_t parse_first_pose(const std::string& text, const std::string& file);
pf_pose_t read_first_pose(const std::string& path);

/// "WxH" in metres.
pf_target_t parse_rectangle(const std::string& text);

}  // namespace pf::sequence

#endif
