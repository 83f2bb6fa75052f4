#include "fit.h"

#include <gnu/libc-version.h>
#include <link.h>
#include <pthread.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "libc/glibc_fields.h"
#include "real.h"

static_assert(sizeof(void*) == 8,
              "the symbols in replaced.def are those of 64-bit machines (x86-64, aarch64)");

namespace move_base_abstract::shim {
namespace {

/** The version of the roscpp headers with which this library was built; it uses private members. */
constexpr const char* kBuiltWith = MOVE_BASE_ABSTRACT_ROSCPP_VERSION;
constexpr std::array<int, 2> kOldestGlibc{2, 30};  // pthread_cond_clockwait
constexpr int kOldestRoscpp = 15;                  // of 1.x
constexpr int kNewestRoscpp = 17;

/** @return the first two numbers of a version; 0 for a missing number. */
std::array<int, 2> numbersOf(const std::string& version) {
  std::array<int, 2> numbers{0, 0};
  std::sscanf(version.c_str(), "%d.%d", &numbers[0], &numbers[1]);
  return numbers;
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) {
    all += (all.empty() ? "" : ", ") + name;
  }
  return all;
}

int addLibrary(dl_phdr_info* info, std::size_t, void* paths) {
  if (std::string(info->dlpi_name).find("/libroscpp.so") != std::string::npos) {
    static_cast<std::vector<std::string>*>(paths)->emplace_back(info->dlpi_name);
  }
  return 0;
}

bool hasOwners() {
  pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  const bool was_free = ownerOf(mutex) == 0;
  pthread_mutex_lock(&mutex);
  const bool is_own = ownerOf(mutex) == static_cast<int>(::syscall(SYS_gettid));
  pthread_mutex_unlock(&mutex);
  return was_free && is_own && ownerOf(mutex) == 0;
}

bool hasClocks() {
  bool is_right = true;
  for (const clockid_t clock : {CLOCK_REALTIME, CLOCK_MONOTONIC}) {
    pthread_condattr_t attributes;
    pthread_cond_t condition;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, clock);
    pthread_cond_init(&condition, &attributes);
    is_right = is_right && clockOf(condition) == clock;
    pthread_cond_destroy(&condition);
    pthread_condattr_destroy(&attributes);
  }
  return is_right;
}

}  // namespace

std::string versionOf(const std::string& path, const std::string& package) {
  std::array<char, PATH_MAX> resolved{};
  const std::string file =
      ::realpath(path.c_str(), resolved.data()) == nullptr ? path : resolved.data();
  const auto suffix = file.rfind(".so.");
  if (suffix != std::string::npos && numbersOf(file.substr(suffix + 4))[0] > 0 &&
      file.find('.', suffix + 4) != std::string::npos) {
    return file.substr(suffix + 4);  // libroscpp.so.1.15.15
  }
  std::ifstream manifest(file.substr(0, file.rfind('/')) + "/../share/" + package + "/package.xml");
  for (std::string line; std::getline(manifest, line);) {
    const auto begin = line.find("<version>");
    if (begin != std::string::npos) {
      const std::string rest = line.substr(begin + 9);
      return rest.substr(0, rest.find('<'));
    }
  }
  return "";
}

Surroundings lookAround() {
  Surroundings found;
  found.glibc = gnu_get_libc_version();
  ::dl_iterate_phdr(&addLibrary, &found.roscpp);
  if (!found.roscpp.empty()) {
    found.roscpp_version = versionOf(found.roscpp.front(), "roscpp");
  }
  for (const Replaced& one : kReplaced) {
    const std::string library = one.library;
    // These are not in every program.
    const bool is_optional = library == "libstdc++" || library == "tf2" || library == "libuuid";
    const bool is_newer =
        is_optional || (library == "libc" && numbersOf(found.glibc) < numbersOf(one.since));
    if (findReal(one.symbol) == nullptr && !is_newer) {
      found.missing.emplace_back(std::string(one.name) + " (" + one.library + ")");
    }
  }
  found.has_owners = hasOwners();
  found.has_clocks = hasClocks();
  return found;
}

std::string fitting() {
  std::ostringstream text;
  text << "roscpp 1." << numbersOf(kBuiltWith)[1] << " (built with " << kBuiltWith << ") and glibc "
       << kOldestGlibc[0] << '.' << kOldestGlibc[1] << " or newer, 64 bits";
  return text.str();
}

std::string misfit(const Surroundings& found) {
  const std::string fits = "; this library fits " + fitting();
  if (numbersOf(found.glibc) < kOldestGlibc) {
    return "the program's glibc is " + found.glibc + fits;
  }
  if (found.roscpp.size() > 1) {
    return "the program has another roscpp than this library was built for: " +
           joined(found.roscpp) + fits;
  }
  const auto version = numbersOf(found.roscpp_version);
  const auto built = numbersOf(kBuiltWith);
  if (!found.roscpp_version.empty() &&
      (version != built || version[1] < kOldestRoscpp || version[1] > kNewestRoscpp)) {
    return "the program's roscpp is " + found.roscpp_version + fits +
           ": build the package anew with the program's roscpp, from 1.15 to 1.17";
  }
  if (!found.missing.empty()) {
    return "the program's libraries have no " + joined(found.missing) + fits;
  }
  if (!found.has_owners) {
    return "the locks of glibc " + found.glibc + " do not name their holder" + fits;
  }
  if (!found.has_clocks) {
    return "the conditions of glibc " + found.glibc + " do not name their clock" + fits;
  }
  return "";
}

}  // namespace move_base_abstract::shim
