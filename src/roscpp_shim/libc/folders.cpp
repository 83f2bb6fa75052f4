// Folders are listed by name. The file system's own order depends on its history.
#include <dirent.h>
#include <string.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

struct Listing {
  std::vector<std::string> entries;  // the bytes of each: the name may be longer than in a dirent
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

const char* nameIn(const std::string& entry) { return entry.data() + offsetof(dirent, d_name); }

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
      entries.emplace_back(reinterpret_cast<const char*>(one), one->d_reclen);
    }
    std::sort(entries.begin(), entries.end(), [](const std::string& one, const std::string& other) {
      return strcmp(nameIn(one), nameIn(other)) < 0;
    });
  }
  Listing& listing = at->second;
  return listing.next < listing.entries.size()
             ? reinterpret_cast<dirent*>(listing.entries[listing.next++].data())
             : nullptr;
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

#pragma GCC visibility push(default)
extern "C" {

dirent* readdir(DIR* folder) { return shim::nextOf(folder); }
asm(".globl readdir64\n.set readdir64, readdir");  // an entry is the same here

using Order = int (*)(const dirent**, const dirent**);

int scandir(const char* folder, dirent*** list, int (*is_chosen)(const dirent*), Order order) {
  static auto* const function = shim::real(&::scandir, "scandir");
  const bool is_by_name = order == nullptr && shim::sees() != shim::Sees::kMachine;
  return function(folder, list, is_chosen, is_by_name ? &alphasort : order);
}
asm(".globl scandir64\n.set scandir64, scandir");

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
