// Random bytes that follow from a text. Both preloaded libraries use it, so it needs neither ROS
// nor allocations.
#pragma once

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace move_base_abstract::shim {

/** Steele, Lea, Flood: Fast splittable pseudorandom number generators (2014), SplitMix64. */
constexpr std::uint64_t kGamma = 0x9e3779b97f4a7c15;
inline std::uint64_t mixed(std::uint64_t value) {
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9;
  value = (value ^ (value >> 27)) * 0x94d049bb133111eb;
  return value ^ (value >> 31);
}

/** @return a number for @p text (the run's seed, the node's name) and @p purpose (FNV-1a). */
inline std::uint64_t numberFor(const char* text, const char* purpose) {
  std::uint64_t number = 0xcbf29ce484222325;
  for (const char* part : {text, "\n", purpose}) {
    for (const char* letter = part; *letter != '\0'; ++letter) {
      number = (number ^ static_cast<unsigned char>(*letter)) * 0x100000001b3;
    }
  }
  return mixed(number);
}

/** @brief A stream of bytes. Each number in it depends only on the start and its place. Any thread
 * may use it. */
class ByteStream {
 public:
  explicit ByteStream(std::uint64_t start) : start_(start) {}

  void fill(void* buffer, std::size_t size) {
    auto* at = static_cast<char*>(buffer);
    while (size > 0) {
      const std::uint64_t number = mixed(start_ + kGamma * ++count_);
      const std::size_t length = size < sizeof number ? size : sizeof number;
      memcpy(at, &number, length);
      at += length;
      size -= length;
    }
  }

 private:
  std::uint64_t start_;
  std::atomic<std::uint64_t> count_{0};
};

/** @return a descriptor of a file with 1 MiB of such bytes; -1 if there can be none. @param flags
 * those of open(). */
inline int fileOf(ByteStream&& bytes, int flags) {
  constexpr int kParts = 256;
  char part[4096];
  const int file = memfd_create("entropy", (flags & O_CLOEXEC) != 0 ? MFD_CLOEXEC : 0);
  bool is_written = file >= 0;
  for (int k = 0; is_written && k < kParts; ++k) {
    bytes.fill(part, sizeof part);
    is_written = write(file, part, sizeof part) == static_cast<ssize_t>(sizeof part);
  }
  if (is_written && lseek(file, 0, SEEK_SET) == 0) {
    return file;
  }
  if (file >= 0) {
    close(file);
  }
  return -1;
}

}  // namespace move_base_abstract::shim
