/* The outside world of run_session.c, once for hosted programs and once for a board without an operating system. */
#ifndef PLANEFOLD_TESTS_DEVICE_IO_H
#define PLANEFOLD_TESTS_DEVICE_IO_H

#include <stddef.h>

/* 0, or -1. Two files are open at a time: the session, which is read, and the result, which is written. */
int device_open_files(int argc, char** argv);
int device_read(void* bytes, size_t size);
int device_write(const void* bytes, size_t size);
void device_close_files(void);
void device_print(const char* text);

/* Most of the stack that was used so far [bytes]; 0 where it is not known. */
size_t device_stack_used(void);

#endif
