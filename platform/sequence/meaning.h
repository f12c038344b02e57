#ifndef PLANEFOLD_PLATFORM_SEQUENCE_MEANING_H
#define PLANEFOLD_PLATFORM_SEQUENCE_MEANING_H

#include <yaml-cpp/yaml.h>

#include <string>

namespace pf::sequence {

/// What a field that no reader knows may do to the others.
enum class Meaning {
  kNone,     ///< nothing: a name, a date
  kNeutral,  ///< it could change what they mean, and has the value with which it does not: fisheye: 0
  kChanged,  ///< it may change what they mean: another model of the lens, further coefficients, images of another size or orientation
};

Meaning meaning_of(const std::string& key, const YAML::Node& value);

std::string lower_case(std::string text);

}  // namespace pf::sequence

#endif
