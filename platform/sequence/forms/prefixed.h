#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FORMS_PREFIXED_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FORMS_PREFIXED_H

#include <string>
#include <vector>

#include "form.h"

namespace pf::sequence {

/// Names of the fields of a camera in ORB-SLAM's settings and in OpenVSLAM's, each behind a prefix as Camera.
struct PrefixedNames {
  std::string prefix;  ///< of fx, fy, cx, cy and the coefficients
  std::string width, height, rate, model;
};

/// Coefficients k1, k2, p1, p2, k3 (is_fisheye: k1 to k4, all of them), one a field.
std::vector<std::string> coefficient_names(bool is_fisheye);

/// The keys that read_prefixed reads, with the coefficients that are given.
Fields::Known known_prefixed(const PrefixedNames& names, const std::vector<std::string>& coefficients,
                             const std::vector<std::string>& unused);

/// Reads a camera whose keys have been checked; of images where the file does not say their size.
void read_prefixed(const Fields& fields, const PrefixedNames& names, bool is_fisheye,
                   const std::vector<std::string>& coefficients, const Asked& asked, Calibration& calibration);

}  // namespace pf::sequence

#endif
