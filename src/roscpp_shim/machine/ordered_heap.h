// A heap whose addresses are a function of the calls alone: of the sizes that were asked for and
// given back, in their order. No ROS, no libc heap below it.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_ORDERED_HEAP_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_ORDERED_HEAP_H

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace move_base_abstract::shim {

/**
 * @brief Blocks of fixed size classes in a region of the address space that begins at the same
 * place in each run.
 *
 * It lies in static memory, zeros at first: memory is asked for before any constructor has run. It
 * is safe to use from any thread; addresses are repeated where those who allocate() and release()
 * do so in the same order. Blocks that are given back at some moment of the wall clock are
 * setAside(): nobody gets them again, unless they have become too many (see isMixed()).
 */
class OrderedHeap {
 public:
  static constexpr std::uintptr_t kBase = std::uintptr_t{1} << 44;
  static constexpr std::size_t kRoom = std::size_t{1} << 37;   // of addresses, not of memory
  static constexpr std::size_t kChunk = std::size_t{1} << 16;  // alignment at most
  static constexpr std::size_t kMostAside = std::size_t{64} << 20;

  /** @brief A block, and whether it holds zeros. */
  struct Block {
    void* address = nullptr;  // null: no room, or an alignment beyond kChunk
    bool is_zero = false;
  };

  /** @param alignment a power of two. */
  Block allocate(std::size_t size, std::size_t alignment);
  /** @brief Give a block back; the next who asks for its size class gets it. */
  void release(void* address);
  /** @brief Give a block back that must not be handed out in order again. */
  void setAside(void* address);

  bool has(const void* address) const {
    return reinterpret_cast<std::uintptr_t>(address) - kBase < kRoom;
  }
  /** @return bytes of the block at @p address. Ends the process if there is none. */
  std::size_t sizeOf(const void* address) const;
  /** @return whether a block at @p address need not move to hold @p size bytes. */
  bool fits(const void* address, std::size_t size) const;

  /** @return whether the system gives no addresses there: the heap is always full then. */
  bool isRefused() const { return state_ == State::kRefused; }
  /** @return whether there was no room some day. */
  bool isFull() const { return is_full_; }
  /** @return whether blocks that were set aside have been handed out again. */
  bool isMixed() const { return is_mixed_; }

  /** @brief Around fork(): no other thread is in the heap. */
  void lock();
  void unlock() { lock_.clear(std::memory_order_release); }

 private:
  static constexpr unsigned kExact = 32;  // classes of 16, 32, ... 512 bytes
  static constexpr unsigned kExactTop = 9;
  static constexpr unsigned kClasses = kExact + 4 * (36 - kExactTop);

  enum class State { kNew, kReady, kRefused };
  struct Free {
    Free* next;
    bool is_discarded;  // its memory was given back to the system, but for this page
  };
  struct Class {
    Free* free = nullptr;
    Free* aside = nullptr;
    std::size_t next = 0;  // what was never handed out, of the latest chunk, from kBase on
    std::size_t end = 0;
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
  std::size_t top_ = 0;    // where the next chunk begins, from kBase on
  std::size_t open_ = 0;   // up to where memory may be used
  std::size_t kept_ = 0;   // bytes of large free blocks that still have their memory
  std::size_t aside_ = 0;  // bytes
  std::array<Class, kClasses> classes_{};
  std::array<std::uint8_t, kRoom / kChunk> class_of_{};  // of a chunk: its class + 1
};

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_MACHINE_ORDERED_HEAP_H
