/* Times of frames and samples: the device's where they can be true, otherwise those of arrival; they grow without end.
 *
 * Where a device's clock stands still, was set back or has jumped, times of arrival take its place until its times lie after the last
 * one that was kept again. A pure rule on numbers, shared by the modules that read devices.
 */
#ifndef PLANEFOLD_PLATFORM_STAMPS_H
#define PLANEFOLD_PLATFORM_STAMPS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All zero at the beginning, and kept when a device is opened anew. */
typedef struct pf_stamps {
  int64_t last_t_ns;    /* the last time that was kept */
  int64_t last_kept_ns; /* when that was */
  int stale;            /* the device's times stopped growing: those of arrival are used */
} pf_stamps_t;

typedef enum pf_stamp_choice {
  PF_STAMP_DROP = -1,   /* no time that grows: the frame or sample has to be dropped */
  PF_STAMP_DEVICE = 0,  /* t_ns is the device's */
  PF_STAMP_ARRIVAL = 1, /* t_ns is that of arrival */
} pf_stamp_choice_t;

/* device_ns  the device's time, of the clock that arrived_ns and now_ns are of; 0 where it has none that can be true
 * t_ns       written unless the choice is PF_STAMP_DROP */
pf_stamp_choice_t pf_choose_stamp(pf_stamps_t* stamps, int64_t device_ns, int64_t arrived_ns, int64_t now_ns,
                                  int64_t* t_ns);

/* The frame or sample of this time was handed on. */
void pf_keep_stamp(pf_stamps_t* stamps, int64_t t_ns, int64_t now_ns);

/* device_ns, or 0 where it cannot be the time of a frame that came at arrived_ns. Drivers stamp a frame with the end of a readout that
 * is still to come, or a little after the clock was read, but not by more than PF_STAMP_AHEAD_NS. */
#define PF_STAMP_AHEAD_NS 100000000
int64_t pf_possible_stamp(int64_t device_ns, int64_t arrived_ns);

#ifdef __cplusplus
}
#endif

#endif
