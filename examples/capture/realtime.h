#ifndef PLANEFOLD_CAPTURE_REALTIME_H
#define PLANEFOLD_CAPTURE_REALTIME_H

#include <string>

namespace pf::capture {

/// The processors that are running, as the kernel lists them: "0-3", or "0,2-3".
std::string processors_there();
/// Whether such a list has this number.
bool names_processor(const std::string& list, int processor);

/// Puts the calling thread on one processor (negative: anywhere) and gives it a real-time priority (0: none).
/// false: the system refused one of the two.
bool place_thread(int processor, int priority);

}  // namespace pf::capture

#endif
