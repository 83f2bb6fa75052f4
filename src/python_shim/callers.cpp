// No ROS.
#include "callers.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <link.h>
#include <stdio.h>
#include <string.h>

#include <atomic>
#include <cstdint>

#include "libc/devices.h"

namespace move_base_abstract::native {
namespace {

/** The kinds of files in memory. */
enum Kind : int { kUnknown, kPythons, kLibrary, kPool, kWrapper };

/** @brief A file in memory. It is never unloaded, since Python does not unload modules in C. */
struct Object {
  std::uintptr_t begin;
  std::uintptr_t end;
  Kind kind;
};

constexpr int kMost = 2048;
Object objects[kMost];
std::atomic<int> count{0};  // number of objects that are written
std::atomic<int> taken{0};  // number of places of the table that are taken

Kind kindOf(const char* path) {
  const char* const slash = strrchr(path, '/');
  const char* const name = slash == nullptr ? path : slash + 1;
  // The program, which is Python; libc and its parts; Python's modules in C; libraries that only
  // these need.
  const bool is_pythons =
      *path == '\0' || strstr(path, "/lib-dynload/") != nullptr ||
      shim::beginsWith(
          name, {"libpython", "linux-vdso", "ld-", "libc.so", "libc-2", "libpthread", "libdl.so",
                 "libdl-2", "librt.so", "librt-2", "libm.so", "libm-2", "libresolv", "libnss_",
                 "libnsl", "libutil", "libanl", "libgcc_s", "libmove_base_abstract_python"}) ||
      shim::beginsWith(name, {"libexpat.so", "libssl.so", "libcrypto.so", "libsqlite3.so",
                              "libz.so", "liblzma.so", "libbz2.so", "libreadline.so", "libedit.so",
                              "libncurses", "libtinfo", "libpanel", "libgdbm", "libdb-", "libtcl",
                              "libtk", "libcrypt.so", "libmpdec", "libtirpc"});
  if (is_pythons) {
    return kPythons;
  }
  if (shim::beginsWith(name, {"libstdc++", "libc++", "libboost_"})) {
    return kWrapper;
  }
  return shim::beginsWith(name, {"libgomp", "libtbb", "libomp", "libiomp"}) ||
                 strstr(name, "blas") != nullptr
             ? kPool
             : kLibrary;
}

struct Search {
  std::uintptr_t address;
  Object found;
};

/** @return whether the object is the one in which the address lies. */
int lookAt(dl_phdr_info* info, std::size_t, void* given) {
  auto* const search = static_cast<Search*>(given);
  std::uintptr_t begin = UINTPTR_MAX;
  std::uintptr_t end = 0;
  for (int k = 0; k < info->dlpi_phnum; ++k) {
    const auto& part = info->dlpi_phdr[k];
    if (part.p_type == PT_LOAD) {
      const std::uintptr_t from = info->dlpi_addr + part.p_vaddr;
      begin = from < begin ? from : begin;
      end = from + part.p_memsz > end ? from + part.p_memsz : end;
    }
  }
  if (search->address < begin || search->address >= end) {
    return 0;
  }
  search->found = {begin, end, kindOf(info->dlpi_name)};
  return 1;
}

/** @brief Keep an object for all threads. If another thread is doing so, it is looked up again. */
void keep(const Object& found) {
  const int place = taken.load();
  int expected = place;
  if (place >= kMost || count.load() != place ||
      !taken.compare_exchange_strong(expected, place + 1)) {
    return;
  }
  objects[place] = found;
  count.store(place + 1, std::memory_order_release);
}

Kind kindAt(const void* caller) {
  const auto address = reinterpret_cast<std::uintptr_t>(caller);
  const int known = count.load(std::memory_order_acquire);
  for (int k = 0; k < known; ++k) {
    if (address - objects[k].begin < objects[k].end - objects[k].begin) {
      return objects[k].kind;
    }
  }
  Search search{address, {0, 0, kLibrary}};  // for code without a file, compiled at run time
  if (dl_iterate_phdr(&lookAt, &search) != 0) {
    keep(search.found);
  }
  return search.found.kind;
}

}  // namespace

bool isFollowed(const void* caller) { return kindAt(caller) != kPythons; }

bool isWorkerPool(const void* caller) { return kindAt(caller) == kPool; }

const void* beyondWrappers(const void* caller) {
  const auto is_wrapper = [](const void* at) {
    return kindAt(at) == kWrapper || kindAt(at) == kPool;
  };
  if (!is_wrapper(caller)) {
    return caller;
  }
  void* frames[32];
  const int found = backtrace(frames, 32);
  bool is_beyond = false;
  for (int k = 0; k < found; ++k) {
    is_beyond = is_beyond || frames[k] == caller;
    if (is_beyond && !is_wrapper(frames[k])) {
      return frames[k];
    }
  }
  return caller;
}

std::size_t placeOf(const void* address, char* path, std::size_t size) {
  Dl_info info{};
  const bool is_found = dladdr(address, &info) != 0 && info.dli_fname != nullptr;
  snprintf(path, size, "%s", is_found ? info.dli_fname : "");
  return is_found ? static_cast<std::size_t>(static_cast<const char*>(address) -
                                             static_cast<const char*>(info.dli_fbase)) -
                        1
                  : 0;
}

}  // namespace move_base_abstract::native
