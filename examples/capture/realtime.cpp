#include "realtime.h"

#include <pthread.h>
#include <sched.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <sstream>

namespace pf::capture {

std::string processors_there() {
  std::ifstream file("/sys/devices/system/cpu/online");
  std::string list;
  if (std::getline(file, list) && !list.empty()) {
    return list;
  }
  return "0-" + std::to_string(sysconf(_SC_NPROCESSORS_ONLN) - 1);
}

bool names_processor(const std::string& list, int processor) {
  std::istringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    int first = 0, last = 0;
    const int numbers = std::sscanf(part.c_str(), "%d-%d", &first, &last);
    if (numbers >= 1 && first <= processor && processor <= (numbers == 2 ? last : first)) {
      return true;
    }
  }
  return false;
}

bool place_thread(int processor, int priority) {
  bool done = true;
  if (processor >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<size_t>(processor), &set);
    done = pthread_setaffinity_np(pthread_self(), sizeof(set), &set) == 0;
  }
  if (priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = priority;
    done = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0 && done;
  }
  return done;
}

}  // namespace pf::capture
