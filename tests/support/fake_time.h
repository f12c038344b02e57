/* A clock and random numbers for tests that play a device: time passes only when the test says so, and a seed gives the same course
 * everywhere. */
#ifndef PLANEFOLD_TESTS_FAKE_TIME_H
#define PLANEFOLD_TESTS_FAKE_TIME_H

#include <stdint.h>

typedef struct fake_random {
  uint64_t state;
} fake_random_t;

/* splitmix64 */
static inline uint64_t fake_random_bits(fake_random_t* random) {
  uint64_t z = (random->state += UINT64_C(0x9e3779b97f4a7c15));
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

/* 0 .. count - 1 */
static inline int fake_random_below(fake_random_t* random, int count) {
  return (int)(fake_random_bits(random) % (uint64_t)count);
}

#define FAKE_MS INT64_C(1000000)
#define FAKE_SECOND INT64_C(1000000000)

#endif
