#pragma once

#include <cstdint>

/// Common to tables whose entries are used or free: capacity(), the number of entries, and used(i), whether one is used.

namespace pf {

/// The entries of a table that are used, by ascending index:
///
///   for (const int i : used_entries(table)) ...
///
/// Each entry is tested when the loop reaches it, so that the loop may remove and add entries.
template <typename Table>
class UsedEntries {
 public:
  class Iterator {
   public:
    Iterator(const Table& table, int i) : table_(table), i_(i) { pass_free(); }
    int operator*() const { return i_; }
    Iterator& operator++() {
      ++i_;
      pass_free();
      return *this;
    }
    bool operator!=(const Iterator& other) const { return i_ != other.i_; }

   private:
    void pass_free() {
      while (i_ < table_.capacity() && !table_.used(i_)) ++i_;
    }
    const Table& table_;
    int i_;
  };

  explicit UsedEntries(const Table& table) : table_(table) {}
  Iterator begin() const { return {table_, 0}; }
  Iterator end() const { return {table_, table_.capacity()}; }

 private:
  const Table& table_;
};

template <typename Table>
UsedEntries<Table> used_entries(const Table& table) {
  return UsedEntries<Table>(table);
}

/// The entry that has an id, or -1. No entry has 0.
template <typename Table>
int entry_with_id(const Table& table, std::uint32_t id) {
  if (id != 0)
    for (const int i : used_entries(table))
      if (table[i].id == id) return i;
  return -1;
}

/// f(entry) for the used entries of a table, by ascending id.
template <typename Table, typename F>
void for_each_by_id(const Table& table, F&& f) {
  for (std::uint32_t last = 0;;) {
    int next = -1;
    for (const int i : used_entries(table))
      if (table[i].id > last && (next < 0 || table[i].id < table[next].id)) next = i;
    if (next < 0) return;
    last = table[next].id;
    f(next);
  }
}

}  // namespace pf
