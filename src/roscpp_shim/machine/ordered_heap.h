// A heap whose addresses follow only from the order of the calls and the sizes of the blocks.
// No ROS, and no libc heap below it.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace move_base_abstract::shim {

/**
 * @brief Blocks of fixed size classes in a region of the address space that begins at the same
 * address in each run.
 *
 * The heap lies in static memory that is zero at first, because programs allocate before any
 * constructor has run. It is safe to use from any thread. Addresses are the same in each run if the
 * calls of allocate() and release() come in the same order. Blocks that are freed at a moment of
 * the wall clock are given to setAside(). They are not handed out again, unless there are too many
 * of them (see isMixed()).
 */
class OrderedHeap {
 public:
  static constexpr std::uintptr_t kBase = std::uintptr_t{1} << 44;
  static constexpr std::size_t kRoom = std::size_t{1} << 37;   // of addresses, not of memory
  static constexpr std::size_t kChunk = std::size_t{1} << 16;  // also the largest alignment
  static constexpr std::size_t kMostAside = std::size_t{64} << 20;

  /**
   * @param alignment a power of two.
   * @return a block of zeros, so that what a program reads without having written it is the same
   * in each run; null: no room, or an alignment above kChunk.
   */
  void* allocate(std::size_t size, std::size_t alignment);
  /** @brief Free a block; the next allocation of its size class gets it. */
  void release(void* address);
  /** @brief Free a block that must not be handed out in order again. */
  void setAside(void* address);

  bool has(const void* address) const {
    return reinterpret_cast<std::uintptr_t>(address) - kBase < kRoom;
  }
  /** @return the size of the block at @p address [bytes]. Ends the process if there is no block. */
  std::size_t sizeOf(const void* address) const;
  /** @return whether the block at @p address can hold @p size bytes without moving. */
  bool fits(const void* address, std::size_t size) const;

  /** @return whether the system refuses the region of addresses: the heap is then always full. */
  bool isRefused() const { return state_ == State::kRefused; }
  /** @return whether the heap has ever run out of room. */
  bool isFull() const { return is_full_; }
  /** @return whether blocks that were set aside have been handed out again. */
  bool isMixed() const { return is_mixed_; }

  /** @brief Keep other threads out of the heap, around fork(). */
  void lock();
  void unlock() { lock_.clear(std::memory_order_release); }

 private:
  static constexpr unsigned kExact = 32;  // classes of 16, 32, ... 512 bytes
  static constexpr unsigned kExactTop = 9;
  static constexpr unsigned kClasses = kExact + 4 * (36 - kExactTop);

  enum class State { kNew, kReady, kRefused };
  struct Free {
    Free* next;
    bool is_discarded;  // its memory was given back to the system, except for this page
  };
  struct Class {
    Free* free = nullptr;
    Free* aside = nullptr;
    std::size_t next = 0;  // offset from kBase of the unused rest of the latest chunk
    std::size_t end = 0;   // offset from kBase of its end
  };

  static unsigned classFor(std::size_t size);
  static std::size_t bytesOf(unsigned index);
  void reserve();
  bool open(std::size_t bytes);
  void* carve(unsigned index);
  void put(void* address, Free** list, std::size_t bytes);
  void takeBack();

  std::atomic_flag lock_ = ATOMIC_FLAG_INIT;
  State state_ = State::kNew;
  std::atomic<bool> is_full_{false};
  std::atomic<bool> is_mixed_{false};
  std::size_t top_ = 0;    // offset from kBase of the next chunk
  std::size_t open_ = 0;   // offset from kBase up to which memory may be used
  std::size_t kept_ = 0;   // bytes of large free blocks that still have their memory
  std::size_t aside_ = 0;  // bytes of blocks that were set aside
  std::array<Class, kClasses> classes_{};
  std::array<std::uint8_t, kRoom / kChunk> class_of_{};  // for each chunk its class + 1; 0: none
};

}  // namespace move_base_abstract::shim
