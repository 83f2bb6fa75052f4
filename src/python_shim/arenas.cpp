// No ROS.
#include "arenas.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>

#include <cerrno>

#ifndef MAP_FIXED_NOREPLACE
#define MAP_FIXED_NOREPLACE 0x100000
#endif

namespace move_base_abstract::native {

/** @brief Blocks that lie one after the other. */
struct Span {
  static constexpr std::size_t kBlocks = Arenas::kSpan / Arenas::kBlock;

  std::uintptr_t base;
  std::size_t used;      // number of blocks that were opened
  std::size_t resident;  // number of those that have memory
  std::uint64_t has_memory[kBlocks / 64];
};

namespace {

constexpr std::size_t kGrain = 16;
constexpr std::size_t kStep = std::size_t{1} << 20;  // memory is opened in steps of this size
constexpr int kTries = 64;
constexpr std::size_t kShifts = 256;  // number of places at which objects may begin in a block

/** What stands at the beginning of a block. */
struct Head {
  Arena* arena;
  std::uint32_t span;                                   // index of the block's span in the arena
  std::uint32_t live;                                   // number of objects in the block
  std::uint64_t is_live[Arenas::kBlock / kGrain / 64];  // a bit for each place of an object
};

constexpr std::size_t kHead = (sizeof(Head) + kGrain - 1) / kGrain * kGrain;

Head& headOf(std::uintptr_t block) { return *reinterpret_cast<Head*>(block); }

std::uintptr_t blockOf(const void* object) {
  return reinterpret_cast<std::uintptr_t>(object) & ~(Arenas::kBlock - 1);
}

bool isLive(std::uintptr_t block, std::size_t offset) {
  const std::size_t place = offset / kGrain;
  return (headOf(block).is_live[place / 64] >> (place % 64) & 1) != 0;
}

void flip(std::uintptr_t block, std::size_t offset) {
  const std::size_t place = offset / kGrain;
  headOf(block).is_live[place / 64] ^= std::uint64_t{1} << (place % 64);
}

/** @brief Keep addresses, without memory. @return whether they are at @p address. */
bool keep(std::uintptr_t address, std::size_t length, int flags) {
  void* const wished = reinterpret_cast<void*>(address);
  void* const found =
      mmap(wished, length, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | flags, -1, 0);
  if (found != wished && found != MAP_FAILED) {
    munmap(found, length);  // a kernel before 4.17 takes the address as a hint only
  }
  return found == wished;
}

/** @return whether a quarter of the arena's memory, or less, is objects. */
bool isSparse(const Arena& arena) {
  return arena.resident >= Arenas::kMany &&
         arena.live * arena.size * 4 <= arena.resident * Arenas::kBlock;
}

}  // namespace

// ---- arenas and spans ------------------------------------------------------------------------

bool Arenas::reserve(std::uint64_t salt) {
  salt_ = salt;
  return keep(kBase, kRoom, MAP_FIXED_NOREPLACE);
}

Arena* Arenas::open(std::uint64_t name, std::size_t size) {
  auto* const arena = static_cast<Arena*>(malloc(sizeof(Arena)));
  if (arena == nullptr) {
    return nullptr;
  }
  *arena = {};
  arena->size = (size + kGrain - 1) / kGrain * kGrain;
  arena->name = mixed(name + mixed(arena->size));
  // Sets look at the last digits of addresses.
  arena->begin = kHead + (salt_ == 0 ? 0 : mixed(arena->name ^ salt_) % kShifts * kGrain);
  return arena;
}

void Arenas::leave(Arena* arena) {
  arena->is_orphan = true;
  if (arena->live + arena->older == 0) {
    dispose(arena);
  }
}

void Arenas::dispose(Arena* arena) {
  for (std::size_t k = 0; k < arena->n_spans; ++k) {
    keep(arena->spans[k].base, kSpan, MAP_FIXED);
  }
  free(arena->spans);
  free(arena);
}

/** @brief Begin another span. Its place follows from the arena's name, and from how many such
 * spans there are. */
bool Arenas::nextSpan(Arena* arena) {
  const std::uint64_t name = mixed(arena->name + static_cast<std::uint64_t>(arena->epoch)) | 1;
  std::uint64_t* known = spans_of_.find(name);
  known = known == nullptr ? spans_of_.add(name, 0) : known;
  void* const more = realloc(arena->spans, (arena->n_spans + 1) * sizeof(Span));
  if (known == nullptr || more == nullptr) {
    return false;
  }
  arena->spans = static_cast<Span*>(more);
  for (int tries = 0; tries < kTries;
       ++tries) {  // who comes first has the place: all come in turns
    const std::size_t place = mixed(name ^ mixed(salt_ + ++*known)) % (kRoom / kSpan);
    std::uint64_t& bits = taken_[place / 64];
    const std::uint64_t bit = std::uint64_t{1} << (place % 64);
    if ((bits & bit) == 0) {
      bits |= bit;
      arena->spans[arena->n_spans++] = {kBase + place * kSpan, 0, 0, {}};
      return true;
    }
  }
  return false;
}

/** @brief Go on in other spans. What is in the present ones counts no more. */
void Arenas::beginEpoch(Arena* arena, std::int64_t epoch) {
  const std::uintptr_t last = arena->block;
  arena->block = 0;
  if (last != 0 && headOf(last).live == 0) {
    giveBack(arena, last);
  }
  arena->epoch = epoch;
  arena->first = arena->n_spans;
  arena->older += arena->live;
  arena->live = arena->resident = 0;
  arena->is_sweeping = arena->has_strays = false;
}

// ---- blocks ----------------------------------------------------------------------------------

bool Arenas::nextBlock(Arena* arena) {
  const std::uintptr_t last = arena->block;
  if (last != 0 && headOf(last).live == 0) {
    giveBack(arena, last);
  }
  arena->block = 0;
  if (!arena->is_sweeping && isSparse(*arena)) {
    arena->is_sweeping = true;
    arena->swept = arena->first * Span::kBlocks;
  }
  if (arena->is_sweeping && nextSwept(arena)) {
    trouble_ |= arena->has_strays ? kMixed : 0U;
    return true;
  }
  arena->is_sweeping = false;
  if (nextFresh(arena)) {
    return true;
  }
  trouble_ |= kFull;
  return false;
}

/** @brief Go on to the next block with room, to fill it again. */
bool Arenas::nextSwept(Arena* arena) {
  for (; arena->swept < arena->n_spans * Span::kBlocks; ++arena->swept) {
    const Span& span = arena->spans[arena->swept / Span::kBlocks];
    const std::size_t index = arena->swept % Span::kBlocks;
    const std::uintptr_t block = span.base + index * kBlock;
    if ((span.has_memory[index / 64] >> (index % 64) & 1) != 0 &&
        headOf(block).live * arena->size * 4 < 3 * kBlock) {
      arena->block = block;
      arena->offset = arena->begin;
      ++arena->swept;
      return true;
    }
  }
  return false;
}

bool Arenas::nextFresh(Arena* arena) {
  if ((arena->n_spans == arena->first || arena->spans[arena->n_spans - 1].used == Span::kBlocks) &&
      !nextSpan(arena)) {
    return false;
  }
  Span& span = arena->spans[arena->n_spans - 1];
  const std::uintptr_t block = span.base + span.used * kBlock;
  if (block % kStep == 0 &&
      mprotect(reinterpret_cast<void*>(block), kStep, PROT_READ | PROT_WRITE) != 0) {
    return false;
  }
  span.has_memory[span.used / 64] |= std::uint64_t{1} << (span.used % 64);
  ++span.used;
  ++span.resident;
  ++arena->resident;
  headOf(block).arena = arena;
  headOf(block).span = static_cast<std::uint32_t>(arena->n_spans - 1);
  arena->block = block;
  arena->offset = arena->begin;
  return true;
}

/** @brief Give the memory of a block without objects back to the system. */
void Arenas::giveBack(Arena* arena, std::uintptr_t block) {
  Span& span = arena->spans[headOf(block).span];
  const std::size_t index = (block - span.base) / kBlock;
  span.has_memory[index / 64] &= ~(std::uint64_t{1} << (index % 64));
  arena->resident -= headOf(block).span < arena->first ? 0U : 1U;
  if (--span.resident == 0 && span.used == Span::kBlocks) {
    keep(span.base, kSpan, MAP_FIXED);
  } else {
    madvise(reinterpret_cast<void*>(block), kBlock, MADV_DONTNEED);
  }
}

// ---- objects ---------------------------------------------------------------------------------

void* Arenas::allocate(Arena* arena, std::int64_t epoch) {
  if (arena->size > kBlock - arena->begin) {
    return nullptr;
  }
  if (arena->epoch != epoch) {
    beginEpoch(arena, epoch);
  }
  const int error = errno;
  for (;;) {
    const std::uintptr_t block = arena->block;
    std::size_t offset = arena->offset;
    while (block != 0 && offset + arena->size <= kBlock) {
      if (!arena->is_sweeping || !isLive(block, offset)) {
        arena->offset = offset + arena->size;
        flip(block, offset);
        ++headOf(block).live;
        ++arena->live;
        return reinterpret_cast<void*>(block + offset);
      }
      offset += arena->size;
    }
    const bool has_more = nextBlock(arena);
    errno = error;
    if (!has_more) {
      return nullptr;
    }
  }
}

void Arenas::release(void* object, bool is_stray) {
  const std::uintptr_t block = blockOf(object);
  const std::size_t offset = reinterpret_cast<std::uintptr_t>(object) - block;
  if (!isLive(block, offset)) {
    fputs("lockstep: an object was given back twice\n", stderr);
    abort();
  }
  const int error = errno;
  Arena* const arena = headOf(block).arena;
  flip(block, offset);
  const bool is_older = headOf(block).span < arena->first;
  --(is_older ? arena->older : arena->live);
  arena->has_strays |= is_stray && !is_older;
  if (--headOf(block).live == 0 && block != arena->block) {
    giveBack(arena, block);
  }
  if (arena->is_orphan && arena->live + arena->older == 0) {
    dispose(arena);
  }
  errno = error;
}

std::size_t Arenas::sizeOf(const void* object) { return headOf(blockOf(object)).arena->size; }

}  // namespace move_base_abstract::native
