/* How much stack a call uses, measured at run time: the call runs on a thread whose stack was painted before.
 *
 *   static void call(void *context) { pf_push_frame(context, &image); }
 *   size_t bytes = stack_meter_run(call, slam);
 *   TEST_ASSERT_LESS_OR_EQUAL_size_t(memory.stack_bytes, bytes);
 *
 * The result counts from the frame of the painted thread's own function down to the lowest byte that was written; an
 * array that is reserved and never written to below everything else is not seen. Sanitizers multiply the use of stack:
 * stack_meter_is_meaningful() is 0 there.
 */
#ifndef PLANEFOLD_TESTS_STACK_METER_H
#define PLANEFOLD_TESTS_STACK_METER_H

#include <pthread.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>

#define STACK_METER_BYTES ((size_t)4 << 20)
#define STACK_METER_GUARD_BYTES ((size_t)64 << 10)
#define STACK_METER_PAINT UINT64_C(0xa5c3965ae17d2b48)

typedef void (*stack_meter_call_t)(void* context);

typedef struct stack_meter_job {
  stack_meter_call_t call;
  void* context;
  const char* top;
} stack_meter_job_t;

static inline int stack_meter_is_meaningful(void) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return 0;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
  return 0;
#else
  return 1;
#endif
#else
  return 1;
#endif
}

static void* stack_meter_thread(void* argument) {
  stack_meter_job_t* job = (stack_meter_job_t*)argument;
  job->top = (const char*)__builtin_frame_address(0);
  job->call(job->context);
  return NULL;
}

/* Bytes of stack that call(context) used. A call that needs more than STACK_METER_BYTES ends the program with a fault. */
static inline size_t stack_meter_run(stack_meter_call_t call, void* context) {
  const size_t bytes = STACK_METER_BYTES;
  char* block =
      (char*)mmap(NULL, bytes + STACK_METER_GUARD_BYTES, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  stack_meter_job_t job = {call, context, NULL};
  pthread_attr_t attributes;
  pthread_t thread;
  if (block == MAP_FAILED || mprotect(block, STACK_METER_GUARD_BYTES, PROT_NONE) != 0) {
    perror("stack_meter: mmap");
    exit(1);
  }
  char* stack = block + STACK_METER_GUARD_BYTES;
  uint64_t* words = (uint64_t*)(void*)stack;
  for (size_t i = 0; i < bytes / sizeof(uint64_t); ++i) {
    words[i] = STACK_METER_PAINT;
  }
  if (pthread_attr_init(&attributes) != 0 || pthread_attr_setstack(&attributes, stack, bytes) != 0 ||
      pthread_create(&thread, &attributes, stack_meter_thread, &job) != 0 || pthread_join(thread, NULL) != 0) {
    fprintf(stderr, "stack_meter: the thread could not be run\n");
    exit(1);
  }
  pthread_attr_destroy(&attributes);
  size_t untouched = 0;
  while (untouched < bytes / sizeof(uint64_t) && words[untouched] == STACK_METER_PAINT) {
    ++untouched;
  }
  const char* lowest = stack + untouched * sizeof(uint64_t);
  const size_t used = lowest < job.top ? (size_t)(job.top - lowest) : 0;
  munmap(block, bytes + STACK_METER_GUARD_BYTES);
  return used;
}

#endif
