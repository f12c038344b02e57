#include "tunable.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace pf {
namespace {

constexpr int kMaxRows = 2000, kMaxName = 120;

struct Row {
  char name[kMaxName];
  double value;
};

struct Table {
  Row row[kMaxRows];
  int count = 0;
  bool is_read = false;
};

[[noreturn]] void fail(const char* file, int line, const char* what) {
  std::fprintf(stderr, "planefold: PLANEFOLD_TUNING: %s:%d: %s\n", file, line, what);
  std::exit(2);
}

void read(Table* table) {
  table->is_read = true;
  const char* const file = std::getenv("PLANEFOLD_TUNING");
  if (file == nullptr || *file == '\0') return;
  std::FILE* const in = std::fopen(file, "r");
  if (in == nullptr) fail(file, 0, "cannot be read");
  char text[256];
  for (int line = 1; std::fgets(text, sizeof text, in) != nullptr; ++line) {
    if (text[std::strspn(text, " \t\r\n")] == '\0' || text[0] == '#') continue;
    if (table->count == kMaxRows) fail(file, line, "too many rows");
    Row& row = table->row[table->count];
    char rest;
    if (std::sscanf(text, "%119s %lf %c", row.name, &row.value, &rest) != 2)
      fail(file, line, "a row is the name of a number and its value");
    ++table->count;
  }
  std::fclose(in);
}

}  // namespace

bool tunable_value(const char* name, double* value) {
  static Table table;  // constant-initialised, whichever number asks first
  if (!table.is_read) read(&table);
  for (int i = 0; i < table.count; ++i) {
    if (std::strcmp(table.row[i].name, name) != 0) continue;
    *value = table.row[i].value;
    return true;
  }
  return false;
}

}  // namespace pf
