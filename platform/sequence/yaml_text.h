#ifndef PLANEFOLD_PLATFORM_SEQUENCE_YAML_TEXT_H
#define PLANEFOLD_PLATFORM_SEQUENCE_YAML_TEXT_H

#include <string>

namespace pf::sequence {

/// Whether text could nest deeper than kMaxYamlDepth, counted without parsing: brackets, and the blanks or dashes that a line begins with.
/// yaml-cpp recurses once per level, so that this bounds the stack.
bool too_deep(const std::string& text);

/// Text of OpenCV's FileStorage, which begins with %YAML:1.0, as YAML: there "name:2" is a field, and files of ORB-SLAM2 have such.
std::string from_opencv(const std::string& text);

/// For messages: without control characters, and not too long.
std::string one_line(std::string text);

}  // namespace pf::sequence

#endif
