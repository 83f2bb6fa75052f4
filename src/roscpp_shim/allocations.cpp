// The program's memory. Allocations of the thread that has the turn come from a heap of their own,
// so that their addresses follow from the order of the turns. All others (of roscpp's threads, of
// this library, of data that roscpp shares with its threads) come from libc's heap, as usual.
#include "allocations.h"

#include <dlfcn.h>
#include <link.h>
#include <malloc.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/auxv.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>

#include "followed.h"
#include "roscpp_shim/machine/ordered_heap.h"
#include "roscpp_shim/machine/real.h"
#include "turn.h"

namespace move_base_abstract::shim {
namespace {

constexpr std::size_t kGrain = 16;

/** @brief libc's own functions, which those below replace. */
struct Behind {
  void* (*malloc)(std::size_t);
  void (*free)(void*);
  void* (*calloc)(std::size_t, std::size_t);
  void* (*realloc)(void*, std::size_t);
  void* (*memalign)(std::size_t, std::size_t);
  std::size_t (*usable)(void*);
};

/** @brief Memory for allocations while those functions are looked up. It is never freed. */
struct Beginning {
  alignas(kGrain) char bytes[std::size_t{1} << 16];
  std::size_t used;

  bool has(const void* address) const { return address >= bytes && address < bytes + sizeof bytes; }
  void* allocate(std::size_t size) {
    void* const address = bytes + used;
    used += (size + kGrain - 1) / kGrain * kGrain;
    if (used > sizeof bytes) {
      abort();
    }
    return address;
  }
  std::size_t sizeFrom(const void* address) const {
    return static_cast<std::size_t>(bytes + used - static_cast<const char*>(address));
  }
};

// All are zero at first, because programs allocate before any constructor has run.
OrderedHeap heap;
Behind functions;
Beginning beginning;
std::atomic<int> looked_up{0};  // 1: under way; 2: done

/** @return libc's own functions; null while they are being looked up. */
const Behind* behind() {
  if (looked_up.load(std::memory_order_acquire) == 2) {
    return &functions;
  }
  int is_new = 0;
  if (!looked_up.compare_exchange_strong(is_new, 1)) {
    return nullptr;  // this thread is looking them up: there is only one thread yet
  }
  functions.malloc = real<void*(std::size_t)>("malloc");
  functions.free = real<void(void*)>("free");
  functions.calloc = real<void*(std::size_t, std::size_t)>("calloc");
  functions.realloc = real<void*(void*, std::size_t)>("realloc");
  functions.memalign = real<void*(std::size_t, std::size_t)>("memalign");
  functions.usable = real<std::size_t(void*)>("malloc_usable_size");
  looked_up.store(2, std::memory_order_release);
  return &functions;
}

/** @brief The code of the dynamic loader. What it allocates belongs to threads and libraries. */
struct Loader {
  std::uintptr_t begin;
  std::uintptr_t end;
};

Loader findLoader() {
  const std::uintptr_t base = ::getauxval(AT_BASE);
  std::uintptr_t end = base;
  if (base != 0) {
    const auto& header = *reinterpret_cast<const ElfW(Ehdr)*>(base);
    const auto* const segments = reinterpret_cast<const ElfW(Phdr)*>(base + header.e_phoff);
    for (unsigned k = 0; k < header.e_phnum; ++k) {
      end = std::max(end, base + segments[k].p_vaddr + segments[k].p_memsz);
    }
  }
  return {base, end};
}

bool isLoader(const void* caller) {
  static const Loader loader = findLoader();
  const auto address = reinterpret_cast<std::uintptr_t>(caller);
  return address >= loader.begin && address < loader.end;
}

/** @return a block of the ordered heap; null if the calling thread does not have the turn. */
void* inOrder(std::size_t size, std::size_t alignment, const void* caller) {
  return isLoader(caller) || !Turn::allocatesInOrder() ? nullptr : heap.allocate(size, alignment);
}

void* allocate(std::size_t size, const void* caller) {
  if (void* const address = inOrder(size, kGrain, caller)) {
    return address;
  }
  const Behind* const libc = behind();
  return libc == nullptr ? beginning.allocate(size) : libc->malloc(size);
}

void* allocateZeros(std::size_t size, const void* caller) {
  if (void* const address = inOrder(size, kGrain, caller)) {
    return address;
  }
  const Behind* const libc = behind();
  return libc == nullptr ? beginning.allocate(size) : libc->calloc(1, size);
}

bool isPowerOfTwo(std::size_t number) { return number != 0 && (number & (number - 1)) == 0; }

void* allocateAligned(std::size_t alignment, std::size_t size, const void* caller) {
  if (isPowerOfTwo(alignment)) {
    if (void* const address = inOrder(size, alignment, caller)) {
      return address;
    }
  }
  const Behind* const libc = behind();
  return libc == nullptr ? nullptr : libc->memalign(alignment, size);
}

void giveBack(void* address) {
  if (heap.has(address)) {
    if (Turn::freesInOrder()) {
      heap.release(address);
    } else {
      heap.setAside(address);
    }
  } else if (address != nullptr && !beginning.has(address)) {
    behind()->free(address);
  }
}

std::size_t usableSize(void* address) {
  if (heap.has(address)) {
    return heap.sizeOf(address);
  }
  return beginning.has(address) ? beginning.sizeFrom(address) : behind()->usable(address);
}

/** @return whether the block is libc's and stays so, so that libc's realloc() may handle it. */
bool isLibcs(const void* address, const void* caller) {
  return !heap.has(address) && !beginning.has(address) &&
         (isLoader(caller) || !Turn::allocatesInOrder());
}

void* reallocate(void* address, std::size_t size, const void* caller) {
  if (isLibcs(address, caller)) {
    const Behind* const libc = behind();
    return libc == nullptr ? beginning.allocate(size) : libc->realloc(address, size);
  }
  if (address != nullptr && size == 0) {
    giveBack(address);
    return nullptr;
  }
  if (heap.has(address) && heap.fits(address, size)) {
    return address;
  }
  void* const moved = allocate(size, caller);
  if (moved != nullptr && address != nullptr) {
    memcpy(moved, address, std::min(size, usableSize(address)));
    giveBack(address);
  }
  return moved;
}

/** Lock the heap around a fork, since the child has one thread only, and would wait for others. */
__attribute__((constructor)) void prepareForForks() {
  ::pthread_atfork([] { heap.lock(); }, [] { heap.unlock(); }, [] { heap.unlock(); });
}

/** @return the file of the function that the program calls by this name. */
const char* fileOfCalled(const char* symbol) {
  Dl_info info{};
  return fileOf(::dlsym(RTLD_DEFAULT, symbol), &info);
}

}  // namespace

std::string whyAddressesDiffer() {
  if (!hasOrderedAddresses()) {
    return "";  // as the environment requests
  }
  for (const char* symbol : {"malloc", "_Znwm"}) {
    const char* const file = fileOfCalled(symbol);
    const bool is_known = strstr(file, "roscpp_shim") != nullptr ||
                          (*symbol == '_' && strstr(file, "malloc") == nullptr);
    if (!is_known) {
      return std::string("the program allocates memory in a way of its own (") + file +
             "): the addresses of what it allocates may differ from run to run";
    }
  }
  if (heap.isRefused()) {
    return "the system does not give the addresses that are the same in each run (a limit of the "
           "address space: ulimit -v): the addresses of what the program allocates may differ";
  }
  return "";
}

bool areAddressesMixed() { return heap.isFull() || heap.isMixed(); }

}  // namespace move_base_abstract::shim

#pragma GCC visibility push(default)
extern "C" {

void* malloc(size_t size) { return shim::allocate(size, MOVE_BASE_ABSTRACT_CALLER); }

void free(void* address) { shim::giveBack(address); }

void* calloc(size_t count, size_t size) {
  size_t bytes = 0;
  if (__builtin_mul_overflow(count, size, &bytes)) {
    errno = ENOMEM;
    return nullptr;
  }
  return shim::allocateZeros(bytes, MOVE_BASE_ABSTRACT_CALLER);
}

void* realloc(void* address, size_t size) {
  return shim::reallocate(address, size, MOVE_BASE_ABSTRACT_CALLER);
}

void* memalign(size_t alignment, size_t size) {
  return shim::allocateAligned(alignment, size, MOVE_BASE_ABSTRACT_CALLER);
}

void* aligned_alloc(size_t alignment, size_t size) {
  return shim::allocateAligned(alignment, size, MOVE_BASE_ABSTRACT_CALLER);
}

int posix_memalign(void** result, size_t alignment, size_t size) {
  if (!shim::isPowerOfTwo(alignment) || alignment % sizeof(void*) != 0) {
    return EINVAL;
  }
  const int error = errno;
  void* const address = shim::allocateAligned(alignment, size, MOVE_BASE_ABSTRACT_CALLER);
  errno = error;
  if (address == nullptr) {
    return ENOMEM;
  }
  *result = address;
  return 0;
}

size_t malloc_usable_size(void* address) {
  return address == nullptr ? 0 : shim::usableSize(address);
}

}  // extern "C"
#pragma GCC visibility pop
