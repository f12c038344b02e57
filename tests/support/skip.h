/* Leaving a test program as skipped, with a reason that ./tools/test repeats in its summary. */
#ifndef PLANEFOLD_TESTS_SKIP_H
#define PLANEFOLD_TESTS_SKIP_H

#include <stdio.h>
#include <stdlib.h>

#define SKIP_EXIT_CODE 77

/* SKIP_PROGRAM("PLANEFOLD_DATA is not set"): ends the program; a single line of text. */
#define SKIP_PROGRAM(reason)      \
  do {                            \
    printf("SKIP: %s\n", reason); \
    fflush(stdout);               \
    exit(SKIP_EXIT_CODE);         \
  } while (0)

#endif
