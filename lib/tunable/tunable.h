#pragma once

#include <type_traits>

/// Tuned numbers of a build with PLANEFOLD_TUNABLE, read from a table when the program starts, so that trying one needs no build. No
/// release has this: it reads a file, and its numbers are no constants to the compiler.

namespace pf {

/// The value that the table gives `name` ("folder.namespace.kName"), into *value. False: it has no such row.
///
/// The table is the file that the environment variable PLANEFOLD_TUNING names: a row for each number, its name and its value. Without the
/// variable every number is what its tuning.h says. A file that cannot be read, or a row that is none, ends the program with a message.
bool tunable_value(const char* name, double* value);

/// The number that the table gives, else the one that the header states, as it is.
template <class T>
T tunable(const char* name, T stated) {
  double value;
  if (!tunable_value(name, &value)) return stated;
  return static_cast<T>(std::is_integral<T>::value ? value + (value < 0 ? -0.5 : 0.5) : value);
}

}  // namespace pf
