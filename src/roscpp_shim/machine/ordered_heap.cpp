#include "ordered_heap.h"

#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "kernel.h"

#ifndef MAP_FIXED_NOREPLACE
#define MAP_FIXED_NOREPLACE 0x100000
#endif

namespace move_base_abstract::shim {
namespace {

constexpr std::size_t kGrain = 16;
constexpr std::size_t kSmall = std::size_t{8} << 10;  // blocks up to this size share a chunk
constexpr std::size_t kStep = std::size_t{16} << 20;  // memory is opened in steps of this size
constexpr std::size_t kKept = std::size_t{64} << 20;  // bytes of large free blocks that are kept
constexpr int kPatience = 100;                        // looks, before other threads go first

constexpr std::size_t rounded(std::size_t size, std::size_t to) {
  return (size + to - 1) / to * to;
}

void* at(std::size_t offset) { return reinterpret_cast<void*>(OrderedHeap::kBase + offset); }

/** @return the position of the highest bit of a number that is not 0. */
unsigned topOf(std::size_t number) { return 63U - static_cast<unsigned>(__builtin_clzll(number)); }

}  // namespace

// ---- size classes ----------------------------------------------------------------------------

/** Up to 512 bytes: one class for each multiple of 16. Above: four for each power of two. */
unsigned OrderedHeap::classFor(std::size_t size) {
  const std::size_t last = std::max(size, kGrain) - 1;
  if (last < kExact * kGrain) {
    return static_cast<unsigned>(last / kGrain);
  }
  const unsigned top = topOf(last);
  return kExact + (top - kExactTop) * 4 + static_cast<unsigned>(last >> (top - 2) & 3);
}

std::size_t OrderedHeap::bytesOf(unsigned index) {
  if (index < kExact) {
    return kGrain * (index + 1);
  }
  const unsigned top = kExactTop + (index - kExact) / 4;
  return (std::size_t{1} << top) + (((index - kExact) % 4 + std::size_t{1}) << (top - 2));
}

std::size_t OrderedHeap::sizeOf(const void* address) const {
  const auto chunk = (reinterpret_cast<std::uintptr_t>(address) - kBase) / kChunk;
  if (class_of_[chunk] == 0) {
    std::fputs("lockstep: free() or realloc() of what was never allocated\n", stderr);
    std::abort();
  }
  return bytesOf(class_of_[chunk] - 1U);
}

bool OrderedHeap::fits(const void* address, std::size_t size) const {
  return size <= std::size_t{1} << 36 && bytesOf(classFor(size)) == sizeOf(address);
}

// ---- the region ------------------------------------------------------------------------------

void OrderedHeap::reserve() {
  void* const wished = reinterpret_cast<void*>(kBase);
  // The system call itself, because the first call of mmap() allocates memory here.
  const long result =
      askKernel(SYS_mmap, static_cast<long>(kBase), kRoom, PROT_NONE,
                MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED_NOREPLACE, -1, 0);
  void* const found = reinterpret_cast<void*>(result);
  if (found != wished && result > 0) {
    ::munmap(found, kRoom);  // a kernel before 4.17 takes the address as a hint only
  }
  state_ = found == wished ? State::kReady : State::kRefused;
}

/** @brief Open memory for the next chunk. @return whether the next @p bytes may be used. */
bool OrderedHeap::open(std::size_t bytes) {
  if (state_ == State::kNew) {
    reserve();
  }
  if (state_ == State::kRefused || bytes > kRoom - top_) {
    return false;
  }
  if (top_ + bytes > open_) {
    const std::size_t more = std::min(rounded(top_ + bytes - open_, kStep), kRoom - open_);
    const int error = errno;
    const bool is_done = ::mprotect(at(open_), more, PROT_READ | PROT_WRITE) == 0;
    errno = error;
    open_ += is_done ? more : 0;
    return is_done;
  }
  return true;
}

/** @return a block that was never handed out; null: no room. */
void* OrderedHeap::carve(unsigned index) {
  Class& one = classes_[index];
  const std::size_t bytes = bytesOf(index);
  if (one.next + bytes > one.end) {
    const std::size_t length = bytes <= kSmall ? kChunk : rounded(bytes, kChunk);
    if (!open(length)) {
      is_full_ = true;
      return nullptr;
    }
    class_of_[top_ / kChunk] = static_cast<std::uint8_t>(index + 1);
    one.next = top_;
    one.end = top_ + (bytes <= kSmall ? length : bytes);
    top_ += length;
  }
  void* const address = at(one.next);
  one.next += bytes;
  return address;
}

// ---- blocks ----------------------------------------------------------------------------------

void* OrderedHeap::allocate(std::size_t size, std::size_t alignment) {
  if (size > std::size_t{1} << 36 || alignment > kChunk) {
    return nullptr;
  }
  if (alignment > kGrain) {  // blocks whose size is a power of two lie at multiples of it
    const std::size_t least = std::max(size, alignment);
    size = std::size_t{1} << (topOf(least - 1) + 1);
  }
  const unsigned index = classFor(size);
  lock();
  if (classes_[index].free == nullptr && aside_ > kMostAside) {
    takeBack();
  }
  Free* const free = classes_[index].free;
  if (free == nullptr) {
    void* const fresh = carve(index);
    unlock();
    return fresh;
  }
  classes_[index].free = free->next;
  kept_ -= bytesOf(index) >= kChunk && !free->is_discarded ? bytesOf(index) : 0;
  unlock();
  return std::memset(free, 0, free->is_discarded ? sizeof(Free) : bytesOf(index));
}

/** @brief Put a free block on a list; the memory of a large one may go back to the system. */
void OrderedHeap::put(void* address, Free** list, std::size_t bytes) {
  bool is_discarded = false;
  if (bytes >= kChunk && kept_ + bytes > kKept) {
    const int error = errno;
    is_discarded = ::madvise(address, rounded(bytes, kChunk), MADV_DONTNEED) == 0;
    errno = error;
  }
  kept_ += bytes >= kChunk && !is_discarded ? bytes : 0;
  auto* const free = static_cast<Free*>(address);
  *free = {*list, is_discarded};
  *list = free;
}

void OrderedHeap::release(void* address) {
  const std::size_t bytes = sizeOf(address);
  lock();
  put(address, &classes_[classFor(bytes)].free, bytes);
  unlock();
}

void OrderedHeap::setAside(void* address) {
  const std::size_t bytes = sizeOf(address);
  lock();
  put(address, &classes_[classFor(bytes)].aside, bytes);
  aside_ += bytes;
  unlock();
}

void OrderedHeap::takeBack() {
  for (Class& one : classes_) {
    while (Free* const free = one.aside) {
      one.aside = free->next;
      free->next = one.free;
      one.free = free;
    }
  }
  aside_ = 0;
  is_mixed_ = true;
}

void OrderedHeap::lock() {
  for (int looks = 0; lock_.test_and_set(std::memory_order_acquire); ++looks) {
    if (looks >= kPatience) {
      askKernel(SYS_sched_yield);
    }
  }
}

}  // namespace move_base_abstract::shim
