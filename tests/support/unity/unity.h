/* Unity, with names of its own for what a test file defines beside its tests: the files of a folder are linked into one program. */
#ifndef PLANEFOLD_TESTS_UNITY_H
#define PLANEFOLD_TESTS_UNITY_H

#ifdef PLANEFOLD_TEST
#define PLANEFOLD_JOIN_NOW(a, b) a##b
#define PLANEFOLD_JOIN(a, b) PLANEFOLD_JOIN_NOW(a, b)
#define main PLANEFOLD_JOIN(main_, PLANEFOLD_TEST)
#define setUp PLANEFOLD_JOIN(setUp_, PLANEFOLD_TEST)
#define tearDown PLANEFOLD_JOIN(tearDown_, PLANEFOLD_TEST)
#endif

#include_next <unity.h>

#endif
