// Memory for Python's objects whose addresses follow from the order in which they are made. No ROS.
#pragma once

#include <cstddef>
#include <cstdint>

#include "number_table.h"

namespace move_base_abstract::native {

struct Span;

/** @brief The memory of the objects of one type, of one size. */
struct Arena {
  std::uint64_t name = 0;  // a hash of the type's name and the objects' size
  std::size_t size = 0;    // of an object, a multiple of 16 [bytes]
  std::size_t begin = 0;   // offset of the first object in a block
  Arena* other = nullptr;  // for objects of the same type, of another size
  Span* spans = nullptr;   // in the order in which they were opened
  std::size_t n_spans = 0;
  std::uintptr_t block = 0;  // in which the next object lies; 0: none yet
  std::size_t offset = 0;    // of the next object in it
  std::size_t swept = 0;     // number of the next block to be filled again
  std::int64_t epoch = 0;    // the present one; what is below counts for its spans only
  std::size_t first = 0;     // index of its first span
  std::size_t resident = 0;  // number of blocks that have memory
  std::size_t live = 0;      // number of objects
  std::size_t older = 0;     // number of objects of earlier epochs
  bool is_sweeping = false;  // whether blocks are filled again
  bool has_strays = false;   // whether an object was given back at a moment of the wall clock
  bool is_orphan = false;    // whether the type is gone
};

/**
 * @brief Arenas in a region of the address space that begins at the same address in each run.
 *
 * An arena consists of spans, whose places follow from its name. In a span objects lie in the order
 * in which they are made, and an address is not used again, so that it does not matter when an
 * object is given back. The memory of a block of them goes back to the system when all of them are
 * dead. If few objects keep many blocks, these are filled again, in the order of their addresses.
 *
 * One thread at a time may call this: the one that has Python's lock.
 */
class Arenas {
 public:
  static constexpr std::uintptr_t kBase = std::uintptr_t{1} << 44;
  static constexpr std::size_t kRoom = std::size_t{1} << 46;  // of addresses, not of memory
  static constexpr std::size_t kSpan = std::size_t{1} << 26;
  static constexpr std::size_t kBlock = std::size_t{1} << 16;
  static constexpr std::size_t kMany = 64;  // blocks of an arena that are never filled again

  /** What makes addresses differ from run to run; bits of trouble(). */
  enum Trouble : unsigned { kMixed = 1, kFull = 2 };

  /** @brief Reserve the addresses. @p salt: another one puts arenas elsewhere. @return success. */
  bool reserve(std::uint64_t salt);

  /** @return a new arena; null: no memory. @p size: of an object [bytes]. */
  Arena* open(std::uint64_t name, std::size_t size);
  /** @return memory for an object; null: there is none, or objects are too large. In another epoch
   * objects lie in another span, so that it does not matter how many were made before. */
  void* allocate(Arena* arena, std::int64_t epoch);
  /** @brief Give an object back. @p is_stray: at a moment of the wall clock. */
  void release(void* object, bool is_stray);
  /** @brief Note that nobody will allocate in an arena any more. */
  void leave(Arena* arena);

  static bool has(const void* address) {
    return reinterpret_cast<std::uintptr_t>(address) - kBase < kRoom;
  }
  /** @return the size of the object at this address of the region. */
  static std::size_t sizeOf(const void* object);
  unsigned trouble() const { return trouble_; }

 private:
  void beginEpoch(Arena* arena, std::int64_t epoch);
  bool nextBlock(Arena* arena);
  bool nextSwept(Arena* arena);
  bool nextFresh(Arena* arena);
  bool nextSpan(Arena* arena);
  void giveBack(Arena* arena, std::uintptr_t block);
  void dispose(Arena* arena);

  std::uint64_t salt_ = 0;
  unsigned trouble_ = 0;
  NumberTable<std::uint64_t> spans_of_;           // {hash of name and epoch: number of spans}
  std::uint64_t taken_[kRoom / kSpan / 64] = {};  // a bit for each place of a span
};

}  // namespace move_base_abstract::native
