#include <planefold_platform/stamps.h>

/* Frames whose time does not grow are dropped for so long; a clock that stands still or was set back is then no longer believed. */
static const int64_t kPatienceNs = 250000000;

pf_stamp_choice_t pf_choose_stamp(pf_stamps_t* stamps, int64_t device_ns, int64_t arrived_ns, int64_t now_ns,
                                  int64_t* t_ns) {
  if (device_ns > stamps->last_t_ns) {
    stamps->stale = 0;
    *t_ns = device_ns;
    return PF_STAMP_DEVICE;
  }
  if (device_ns > 0 && !stamps->stale) {
    if (now_ns - stamps->last_kept_ns < kPatienceNs) {
      return PF_STAMP_DROP;
    }
    stamps->stale = 1;
  }
  if (arrived_ns <= stamps->last_t_ns) {
    return PF_STAMP_DROP;
  }
  *t_ns = arrived_ns;
  return PF_STAMP_ARRIVAL;
}

void pf_keep_stamp(pf_stamps_t* stamps, int64_t t_ns, int64_t now_ns) {
  stamps->last_t_ns = t_ns;
  stamps->last_kept_ns = now_ns;
}

int64_t pf_possible_stamp(int64_t device_ns, int64_t arrived_ns) {
  return device_ns > 0 && device_ns <= arrived_ns + PF_STAMP_AHEAD_NS ? device_ns : 0;
}
