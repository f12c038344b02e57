/* device_io.h on Linux: run_session SESSION RESULT */
#include <stdio.h>

#include "device_io.h"

static FILE *session, *result;

int device_open_files(int argc, char** argv) {
  if (argc != 3) return -1;
  session = fopen(argv[1], "rb");
  result = fopen(argv[2], "wb");
  return session != NULL && result != NULL ? 0 : -1;
}

int device_read(void* bytes, size_t size) { return fread(bytes, size, 1, session) == 1 ? 0 : -1; }
int device_write(const void* bytes, size_t size) { return fwrite(bytes, size, 1, result) == 1 ? 0 : -1; }

void device_close_files(void) {
  fclose(session);
  fclose(result);
}

void device_print(const char* text) { fputs(text, stdout); }
size_t device_stack_used(void) { return 0; }
