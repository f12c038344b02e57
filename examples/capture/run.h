#ifndef PLANEFOLD_CAPTURE_RUN_H
#define PLANEFOLD_CAPTURE_RUN_H

#include "options.h"

namespace pf::capture {

/// The whole run; returns the exit code, after one line on stderr where it is not 0.
int run(const Options& options);

}  // namespace pf::capture

#endif
