/// pf-capture: a sequence of images or a simulated scene in, a trajectory, a map, a report and a film out.
///
/// It shows how a program uses planefold: Session is the part that talks to the library, everything else is about reading
/// frames and about showing and writing what comes back.
#include <cstdio>
#include <exception>

#include "camera.h"
#include "imu.h"
#include "options.h"
#include "run.h"

int main(int argc, char** argv) {
  pf::capture::Options options;
  int code = pf::capture::kExitUsage;
  try {
    if (pf::capture::parse_options(argc, argv, options, code) == pf::capture::Parsed::kExit) {
      return code;
    }
    return options.list ? pf::capture::list_imus(pf::capture::list_devices()) : pf::capture::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pf-capture: %s\n", error.what());
  }
  return pf::capture::kExitRun;
}
