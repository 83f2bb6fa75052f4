// A table from numbers that are not 0, such as addresses, to values. No ROS, and no C++ library.
#pragma once

#include <stdlib.h>

#include <cstddef>
#include <cstdint>

namespace move_base_abstract::native {

/** @return a number whose bits all depend on all bits of @p number (SplitMix64). */
constexpr std::uint64_t mixed(std::uint64_t number) {
  number += 0x9e3779b97f4a7c15;
  number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9;
  number = (number ^ (number >> 27)) * 0x94d049bb133111eb;
  return number ^ (number >> 31);
}

/** @brief A hash table with open addressing. One thread at a time may use it. */
template <typename Value>
class NumberTable {
 public:
  /** @return the place of the value, which holds until the table changes; null: there is none. */
  Value* find(std::uint64_t key) const {
    for (std::size_t at = mixed(key); size_ != 0; ++at) {
      Entry& entry = entries_[at & (size_ - 1)];
      if (entry.key == key) {
        return &entry.value;
      }
      if (entry.key == 0) {
        break;
      }
    }
    return nullptr;
  }

  /** @brief Add a key that is not there. @return the place of its value; null: no memory. */
  Value* add(std::uint64_t key, Value value) {
    if ((count_ + 1) * 2 > size_ && !grow()) {
      return nullptr;
    }
    ++count_;
    return put(key, value);
  }

  void remove(std::uint64_t key) {
    Value* const value = find(key);
    if (value == nullptr) {
      return;
    }
    --count_;
    std::size_t hole = static_cast<std::size_t>(
        reinterpret_cast<Entry*>(reinterpret_cast<char*>(value) - offsetof(Entry, value)) -
        entries_);
    for (std::size_t at = (hole + 1) & (size_ - 1); entries_[at].key != 0;
         at = (at + 1) & (size_ - 1)) {
      const std::size_t home = mixed(entries_[at].key) & (size_ - 1);
      if (((at - home) & (size_ - 1)) >= ((at - hole) & (size_ - 1))) {
        entries_[hole] = entries_[at];  // it may lie there, and would not be found behind a hole
        hole = at;
      }
    }
    entries_[hole] = {};
  }

  std::size_t count() const { return count_; }

 private:
  struct Entry {
    std::uint64_t key;
    Value value;
  };

  Value* put(std::uint64_t key, Value value) {
    std::size_t at = mixed(key) & (size_ - 1);
    while (entries_[at].key != 0) {
      at = (at + 1) & (size_ - 1);
    }
    entries_[at] = {key, value};
    return &entries_[at].value;
  }

  bool grow() {
    const NumberTable old = *this;
    const std::size_t size = size_ == 0 ? 64 : size_ * 2;
    auto* const entries = static_cast<Entry*>(calloc(size, sizeof(Entry)));
    if (entries == nullptr) {
      return false;
    }
    entries_ = entries;
    size_ = size;
    for (std::size_t at = 0; at < old.size_; ++at) {
      if (old.entries_[at].key != 0) {
        put(old.entries_[at].key, old.entries_[at].value);
      }
    }
    free(old.entries_);
    return true;
  }

  Entry* entries_ = nullptr;
  std::size_t size_ = 0;  // a power of two, or 0
  std::size_t count_ = 0;
};

}  // namespace move_base_abstract::native
