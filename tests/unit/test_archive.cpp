// Numbers of a context that are read back: what is wrong is never stored, and nothing behind it is what memory held before.
#include <cstring>

#include "base/archive.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

enum class Colour : std::uint8_t { kRed, kGreen, kBlue };

struct Things {
  std::int32_t index, count;
  Colour colour;
  bool on;

  void carry(Archive& archive) {
    archive.within(index, -1, 9);
    archive.counts(count);
    archive.within(colour, 0, static_cast<int>(Colour::kBlue));
    archive.flags(on);
  }
};

/// Reads things into memory that held anything before.
bool read(const std::uint8_t* bytes, std::size_t count, Things* things) {
  std::memset(static_cast<void*>(things), 0x7f, sizeof *things);
  Archive archive = Archive::reading(bytes, count);
  things->carry(archive);
  return archive.is_at_end();
}

std::size_t write(Things things, std::uint8_t* bytes, std::size_t count) {
  Archive archive = Archive::writing(bytes, count);
  things.carry(archive);
  TEST_ASSERT_FALSE(archive.failed());
  return archive.used();
}

void test_things_should_come_back() {
  std::uint8_t bytes[64];
  Things things;
  TEST_ASSERT_TRUE(read(bytes, write({7, 12, Colour::kGreen, true}, bytes, sizeof bytes), &things));
  TEST_ASSERT_EQUAL_INT(7, things.index);
  TEST_ASSERT_EQUAL_INT(12, things.count);
  TEST_ASSERT_TRUE(things.colour == Colour::kGreen && things.on);
}

void test_what_is_not_read_should_be_in_its_domain() {
  std::uint8_t bytes[64];
  const std::size_t count = write({7, 12, Colour::kBlue, true}, bytes, sizeof bytes);
  Things things;
  for (std::size_t cut = 0; cut < count; ++cut) {
    TEST_ASSERT_FALSE(read(bytes, cut, &things));
    TEST_ASSERT_TRUE(things.index >= -1 && things.index <= 9);
    TEST_ASSERT_TRUE(things.count == 0 || things.count == 12);
    TEST_ASSERT_TRUE(things.colour <= Colour::kBlue);
    TEST_ASSERT_FALSE(things.on);
  }
  bytes[0] = 10;
  TEST_ASSERT_FALSE(read(bytes, count, &things));
  TEST_ASSERT_EQUAL_INT(-1, things.index);
  TEST_ASSERT_EQUAL_INT(0, things.count);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_things_should_come_back);
  RUN_TEST(test_what_is_not_read_should_be_in_its_domain);
  return UNITY_END();
}
