#include "realtime.h"

#include <pthread.h>
#include <sched.h>

namespace pf::capture {

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
