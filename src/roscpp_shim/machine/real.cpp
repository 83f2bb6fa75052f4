#include "real.h"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string>
#include <vector>

namespace move_base_abstract::shim {
namespace {

/** @return the symbol in a library that a plug-in has loaded, which dlsym() alone does not find. */
void* findLoaded(const char* symbol) {
  std::vector<std::string> paths;
  const auto look = [](dl_phdr_info* info, std::size_t, void* found) {
    for (const char* name : {"/libtf2.so", "/libuuid.so"}) {
      if (std::strstr(info->dlpi_name, name) != nullptr) {
        static_cast<std::vector<std::string>*>(found)->emplace_back(info->dlpi_name);
      }
    }
    return 0;
  };
  ::dl_iterate_phdr(look, &paths);
  for (const std::string& path : paths) {
    void* const library = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_NOLOAD);
    void* const result = library == nullptr ? nullptr : ::dlsym(library, symbol);
    if (result != nullptr) {
      return result;
    }
  }
  return nullptr;
}

}  // namespace

void* findReal(const char* symbol) {
  void* const found = findNext(symbol);
  return found == nullptr ? findLoaded(symbol) : found;
}

void* realOrAbort(const char* name) {
  const std::size_t length = std::strlen(name);
  const auto* const row =
      std::find_if(std::begin(kReplaced), std::end(kReplaced), [&](const Replaced& one) {
        const bool begins = std::strncmp(one.name, name, length) == 0;
        return (begins && (one.name[length] == '(' || one.name[length] == '\0')) ||
               std::strcmp(one.symbol, name) == 0;
      });
  const bool is_listed = row != std::end(kReplaced);
  void* const found = is_listed ? findReal(row->symbol) : nullptr;
  if (found == nullptr) {
    std::fprintf(stderr, "lockstep: %s %s\n",
                 is_listed ? "this program's libraries have no" : "replaced.def does not list",
                 is_listed ? row->symbol : name);
    std::abort();
  }
  return found;
}

}  // namespace move_base_abstract::shim
