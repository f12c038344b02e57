#ifndef PLANEFOLD_PLATFORM_SEQUENCE_REFUSE_H
#define PLANEFOLD_PLATFORM_SEQUENCE_REFUSE_H

#include <stdexcept>
#include <string>

namespace pf::sequence {

/// What a file did wrong, as the one line that the user will read. Thrown inside of this room only; the C functions of
/// sequence.h turn it into a message.
class ReadError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One image that cannot be used while others may: missing, empty, damaged.
class ImageError : public ReadError {
 public:
  using ReadError::ReadError;
};

/// The calibration of a folder, which is not that of its images or not to be read.
class CalibrationError : public ReadError {
 public:
  using ReadError::ReadError;
};

[[noreturn]] inline void refuse(const std::string& line) { throw ReadError(line); }

}  // namespace pf::sequence

#endif
