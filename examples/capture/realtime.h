#ifndef PLANEFOLD_CAPTURE_REALTIME_H
#define PLANEFOLD_CAPTURE_REALTIME_H

namespace pf::capture {

/// Puts the calling thread on one processor (negative: anywhere) and gives it a real-time priority (0: none).
/// false: the system refused one of the two.
bool place_thread(int processor, int priority);

}  // namespace pf::capture

#endif
