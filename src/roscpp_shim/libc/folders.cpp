// Folders are listed by name. The file system's own order depends on its history.
#include <dirent.h>
#include <string.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <vector>

#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

struct Listing {
  std::vector<dirent> entries;
  std::size_t next = 0;
};

/** @brief The folders that the program has opened, and has asked for an entry of. */
struct Listings {
  PlainMutex mutex;
  std::map<DIR*, Listing> all;
};

Listings& listings() {
  static auto* const instance = new Listings;
  return *instance;
}

using Lock = std::lock_guard<PlainMutex>;

/** @return the next entry; null at the end, or if the folder cannot be read. */
dirent* nextOf(DIR* folder) {
  static auto* const read = real<dirent*(DIR*)>("readdir");
  const bool is_seen = sees() != Sees::kMachine;
  const Inside inside;
  const Lock lock(listings().mutex);
  auto at = listings().all.find(folder);
  if (at == listings().all.end()) {
    if (!is_seen) {
      return read(folder);
    }
    at = listings().all.emplace(folder, Listing()).first;
    auto& entries = at->second.entries;
    while (const dirent* const one = read(folder)) {
      entries.push_back(*one);
    }
    std::sort(entries.begin(), entries.end(), [](const dirent& one, const dirent& other) {
      return strcmp(one.d_name, other.d_name) < 0;
    });
  }
  Listing& listing = at->second;
  return listing.next == listing.entries.size() ? nullptr : &listing.entries[listing.next++];
}

/** @brief Call it before the folder is closed or read anew. */
void forget(DIR* folder) {
  const Inside inside;
  const Lock lock(listings().mutex);
  listings().all.erase(folder);
}

/** @return where the folder is read next, which may be set; null: it is not listed by name. */
std::size_t* placeIn(DIR* folder) {
  const Inside inside;
  const Lock lock(listings().mutex);
  const auto at = listings().all.find(folder);
  return at == listings().all.end() ? nullptr : &at->second.next;
}

}  // namespace
}  // namespace move_base_abstract::shim

namespace shim = move_base_abstract::shim;

#pragma GCC visibility push(default)
extern "C" {

dirent* readdir(DIR* folder) { return shim::nextOf(folder); }
asm(".globl readdir64\n.set readdir64, readdir");  // an entry is the same here

int closedir(DIR* folder) {
  static auto* const function = shim::real<int(DIR*)>("closedir");
  shim::forget(folder);
  return function(folder);
}

void rewinddir(DIR* folder) {
  static auto* const function = shim::real<void(DIR*)>("rewinddir");
  shim::forget(folder);
  function(folder);
}

long telldir(DIR* folder) {
  static auto* const function = shim::real<long(DIR*)>("telldir");
  const std::size_t* const place = shim::placeIn(folder);
  return place == nullptr ? function(folder) : static_cast<long>(*place);
}

void seekdir(DIR* folder, long to) {
  static auto* const function = shim::real<void(DIR*, long)>("seekdir");
  std::size_t* const place = shim::placeIn(folder);
  if (place == nullptr) {
    function(folder, to);
  } else {
    *place = static_cast<std::size_t>(to);
  }
}

}  // extern "C"
#pragma GCC visibility pop
