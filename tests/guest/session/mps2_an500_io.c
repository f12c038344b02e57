/* device_io.h on a Cortex-M7 without an operating system: reset, floating-point unit, painted stack, and files through
 * semihosting, the debugger's own calls, which the emulator answers. */
#include <stdint.h>
#include <string.h>

#include "device_io.h"

enum { SYS_OPEN = 1, SYS_CLOSE = 2, SYS_WRITE0 = 4, SYS_WRITE = 5, SYS_READ = 6, SYS_EXIT_EXTENDED = 0x20 };
enum { OPEN_READ_BINARY = 1, OPEN_WRITE_BINARY = 5 };
enum { STOPPED_APPLICATION_EXIT = 0x20026 };

extern uint32_t data_begin[], data_end[], data_load[], bss_begin[], bss_end[], stack_bottom[], stack_top[];
int main(int argc, char** argv);

static const uint32_t kPaint = 0xA5A5A5A5u;
static intptr_t session, result;

static intptr_t semihost(intptr_t call, const void* arguments) {
  register intptr_t r0 __asm__("r0") = call;
  register const void* r1 __asm__("r1") = arguments;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

static void leave(int code) {
  const uintptr_t arguments[2] = {STOPPED_APPLICATION_EXIT, (uintptr_t)code};
  semihost(SYS_EXIT_EXTENDED, arguments);
  for (;;) {
  }
}

static intptr_t open_file(const char* name, uintptr_t mode) {
  const uintptr_t arguments[3] = {(uintptr_t)name, mode, strlen(name)};
  return semihost(SYS_OPEN, arguments);
}

int device_open_files(int argc, char** argv) {
  (void)argc;
  (void)argv;
  session = open_file("session.bin", OPEN_READ_BINARY);
  result = open_file("result.bin", OPEN_WRITE_BINARY);
  return session != -1 && result != -1 ? 0 : -1;
}

int device_read(void* bytes, size_t size) {
  const uintptr_t arguments[3] = {(uintptr_t)session, (uintptr_t)bytes, size};
  return semihost(SYS_READ, arguments) == 0 ? 0 : -1; /* how many are missing */
}

int device_write(const void* bytes, size_t size) {
  const uintptr_t arguments[3] = {(uintptr_t)result, (uintptr_t)bytes, size};
  return semihost(SYS_WRITE, arguments) == 0 ? 0 : -1;
}

void device_close_files(void) {
  const uintptr_t first[1] = {(uintptr_t)session}, second[1] = {(uintptr_t)result};
  semihost(SYS_CLOSE, first);
  semihost(SYS_CLOSE, second);
}

void device_print(const char* text) { semihost(SYS_WRITE0, text); }

size_t device_stack_used(void) {
  const uint32_t* at = stack_bottom;
  while (at < stack_top && *at == kPaint) ++at;
  return (size_t)((const char*)stack_top - (const char*)at);
}

/* Newlib's maths set errno, and nothing else of its world is there. */
int* __errno(void);
int* __errno(void) {
  static int number;
  return &number;
}

void reset_handler(void);
void reset_handler(void) {
  volatile uint32_t* const cpacr = (volatile uint32_t*)0xE000ED88u;
  uint32_t *to, *paint_end;
  const uint32_t* from = data_load;
  *cpacr |= 0xFu << 20; /* coprocessors 10 and 11: the floating-point unit */
  __asm__ volatile("dsb\n isb");
  for (to = data_begin; to < data_end;) *to++ = *from++;
  for (to = bss_begin; to < bss_end;) *to++ = 0;
  paint_end = (uint32_t*)__builtin_frame_address(0) - 16;
  for (to = stack_bottom; to < paint_end;) *to++ = kPaint;
  leave(main(0, 0));
}

static void fault_handler(void) {
  device_print("fault\n");
  leave(3);
}

__attribute__((section(".vectors"), used)) static const uintptr_t vectors[16] = {
    (uintptr_t)stack_top,     (uintptr_t)reset_handler, (uintptr_t)fault_handler, (uintptr_t)fault_handler,
    (uintptr_t)fault_handler, (uintptr_t)fault_handler, (uintptr_t)fault_handler};
