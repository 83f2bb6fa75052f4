#include "followed.h"

#include <elf.h>
#include <execinfo.h>
#include <sys/personality.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "allocations.h"
#include "clocks.h"
#include "launcher.h"
#include "node.h"
#include "roscpp_shim/machine/kernel.h"
#include "turn.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;

const char* const kUnknownBefore =
    "the time master was not in lockstep yet when the program was started: the clocks and random "
    "numbers that it saw before ROS began were the machine's";
const char* const kRandomLayout =
    "the system does not let addresses be the same in each run (in a container: docker run "
    "--security-opt seccomp=unconfined; or set MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT=random if nothing "
    "depends on them)";

enum class Following { kUnknown, kYes, kNo };

std::atomic<Following> following{Following::kUnknown};
std::atomic<int> without_turns{0};  // number of the program's threads that take none
thread_local bool t_is_worker __attribute__((tls_model("initial-exec"))) = false;

struct Noticed {
  PlainMutex mutex;
  std::map<std::string, std::string> texts;  // by what was noticed
  std::set<std::pair<wire::NoteKind, std::string>> files;
  std::map<std::string, Nanoseconds> written;  // by the file's path: when
  bool has_joined = false;
};

Noticed& noticed() {
  static Noticed* const instance = new Noticed;
  return *instance;
}

bool isFollowing() {
  if (environ == nullptr) {
    return false;  // libc has not begun
  }
  Following now = following.load(std::memory_order_relaxed);
  if (now == Following::kUnknown) {
    now = told().chance == nullptr ? Following::kNo : Following::kYes;
    following = now;
  }
  return now == Following::kYes;
}

bool isFirstThread() {
  thread_local const bool is_first __attribute__((tls_model("initial-exec"))) =
      askKernel(SYS_gettid) == askKernel(SYS_getpid);
  return is_first;
}

/**
 * @return the code that called the wrappers of the standard library or Boost, if @p caller is in
 * one of them. This is slow: for functions that are called rarely.
 */
const void* beyondWrappers(const void* caller) {
  const auto wrappers = {"/libstdc++.so", "/libboost_"};
  if (!isIn(caller, wrappers)) {
    return caller;
  }
  std::array<void*, 32> frames{};
  const int count = ::backtrace(frames.data(), static_cast<int>(frames.size()));
  const auto end = frames.begin() + count;
  for (auto at = std::find(frames.begin(), end, caller); at != end; ++at) {
    if (!isIn(*at, wrappers)) {
      return *at;
    }
  }
  return caller;
}

/** @return the innermost code of the program's own in the calling thread; if there is none, the
 * innermost that is not this library's. */
const void* programsPlace() {
  std::array<void*, 64> frames{};
  const int count = ::backtrace(frames.data(), static_cast<int>(frames.size()));
  const auto end = frames.begin() + count;
  const auto is_own = [](const void* one) {
    return !isIn(one, {"/libstdc++.so", "/libboost_"}) && isProgramsOwn(one);
  };
  const auto is_others = [](const void* one) { return !isIn(one, {"roscpp_shim"}); };
  const auto own = std::find_if(frames.begin(), end, is_own);
  const auto at = own == end ? std::find_if(frames.begin(), end, is_others) : own;
  return at == end ? nullptr : *at;
}

/** @return the place of code, in the form that addr2line takes. */
std::string placeOf(const void* caller) {
  Dl_info info{};
  const char* const file = fileOf(caller, &info);
  if (*file == '\0') {
    return "code without a file";
  }
  const auto* const head = static_cast<const Elf64_Ehdr*>(info.dli_fbase);
  const auto base = head->e_type == ET_DYN ? reinterpret_cast<std::uintptr_t>(info.dli_fbase) : 0;
  char text[32];
  std::snprintf(text, sizeof text, "+%#lx", reinterpret_cast<std::uintptr_t>(caller) - base - 1);
  return file + std::string(text);
}

}  // namespace

const char* fileOf(const void* address, Dl_info* info) {
  const bool is_found = dladdr(address, info) != 0 && info->dli_fname != nullptr;
  return is_found ? info->dli_fname : "";
}

bool isIn(const void* caller, std::initializer_list<const char*> names) {
  Dl_info info{};
  const char* const file = fileOf(caller, &info);
  for (const char* name : names) {
    if (std::strstr(file, name) != nullptr) {
      return true;
    }
  }
  return false;
}

Sees sees() {
  if (!isFollowing() || Turn::isInside() || Turn::isInternal()) {
    return Sees::kMachine;
  }
  if (turn().isActive()) {
    return turn().holds() ? Sees::kRun : Sees::kStray;
  }
  return Turn::self() != nullptr || isFirstThread() ? Sees::kRun : Sees::kStray;
}

bool ordered() { return turn().holds(); }

bool hasOrderedAddresses() {
  if (!isFollowing()) {
    return false;
  }
  return told().layout == nullptr || std::strcmp(told().layout, "random") != 0;
}

const std::string& seedText() {
  static const auto* const text = new std::string(told().chance == nullptr ? "0" : told().chance);
  return *text;
}

std::int64_t seed() { return std::atoll(seedText().c_str()); }

void beginToFollow() {
  const Inside inside;
  if (!isFollowing()) {
    following = Following::kYes;
    noticed().texts[kUnknownBefore] = kUnknownBefore;
  }
  constexpr unsigned long kAsk = 0xffffffff;
  const bool is_fixed = (::personality(kAsk) & ADDR_NO_RANDOMIZE) != 0 ||
                        std::ifstream("/proc/sys/kernel/randomize_va_space").get() == '0';
  if (!is_fixed && hasOrderedAddresses()) {
    noticed().texts[kRandomLayout] = kRandomLayout;
  }
  if (const std::string why = whyAddressesDiffer(); !why.empty()) {
    noticed().texts[why] = why;
  }
}

void stopFollowing() { following = Following::kNo; }

void tellWhatWasNoticed() {
  const Lock lock(noticed().mutex);
  noticed().has_joined = true;
  for (const auto& one : noticed().texts) {
    node().label(one.second);
  }
  for (const auto& [what, path] : noticed().files) {
    node().append(wire::Note{what, path});
  }
}

void noteFile(const std::string& path, bool reads, bool writes) {
  const Inside inside;
  const Lock lock(noticed().mutex);
  if (writes) {
    noticed().written[path] = seenTime(CLOCK_REALTIME);
  }
  for (const auto what : {wire::NoteKind::kReads, wire::NoteKind::kWrites}) {
    const bool is_so = what == wire::NoteKind::kReads ? reads : writes;
    if (is_so && noticed().files.emplace(what, path).second && noticed().has_joined) {
      node().append(wire::Note{what, path});
    }
  }
}

std::optional<std::int64_t> whenWritten(const std::string& path) {
  const Inside inside;
  const Lock lock(noticed().mutex);
  const auto at = noticed().written.find(path);
  return at == noticed().written.end() ? std::nullopt : std::make_optional(at->second);
}

void tell(const std::string& what, const void* caller) {
  const Inside inside;
  const Lock lock(noticed().mutex);
  const auto [at, is_new] = noticed().texts.emplace(what, "");
  if (!is_new) {
    return;
  }
  const void* const place = caller == nullptr ? programsPlace() : beyondWrappers(caller);
  at->second = what + " (" + placeOf(place) + ")";
  if (noticed().has_joined) {
    node().label(at->second);
  }
}

bool isRoscpps(const void* caller) {
  return isIn(caller, {"/libroscpp.so", "/librosconsole", "/libxmlrpcpp.so"});
}

bool isTimers(const void* caller) {
  Dl_info info{};
  const bool is_found = dladdr(caller, &info) != 0 && info.dli_sname != nullptr;
  return is_found && std::strstr(info.dli_sname, "Timer") != nullptr;
}

bool isWorkerPool(const void* caller) {
  return t_is_worker ||
         isIn(caller, {"libgomp", "libtbb", "libomp", "blas", "libOpenCL", "libcuda"});
}

bool isProgramsOwn(const void* caller) {
  Dl_info info{};
  const char* const file = fileOf(beyondWrappers(caller), &info);
  for (const char* part : {"roscpp_shim", "libtbb"}) {  // TBB looks at its process and its cores
    if (std::strstr(file, part) != nullptr) {
      return false;
    }
  }
  for (const char* folder :
       {"/usr/lib/x86_64", "/usr/lib/aarch64", "/lib/", "/lib64/", "/opt/ros/"}) {
    if (std::strncmp(file, folder, std::strlen(folder)) == 0) {
      return false;
    }
  }
  return true;
}

void becomeWorker() { t_is_worker = true; }

WithoutTurns::WithoutTurns() { ++without_turns; }
WithoutTurns::~WithoutTurns() { --without_turns; }

void tellPassage(const char* call) {
  if (without_turns > 0) {
    tell(std::string(call) +
             " is called again and again while a thread works that takes no turns, of a library or "
             "from before ROS: how often, and so when time goes on, depends on the machine",
         nullptr);
  }
}

}  // namespace move_base_abstract::shim
