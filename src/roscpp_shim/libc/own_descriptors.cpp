#include "own_descriptors.h"

#include <sys/epoll.h>
#include <unistd.h>

#include <array>
#include <map>
#include <mutex>
#include <string>

#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/turn.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;

constexpr int kStandardDescriptors = 3;  // their other ends belong to other processes

struct Sets {
  PlainMutex mutex;
  std::map<int, std::map<int, WaitedFor>> members;
};

Sets& sets() {
  static Sets* const instance = new Sets;
  return *instance;
}

/** @return the kernel's name of @p descriptor, for example "anon_inode:[timerfd]". */
std::string nameOf(int descriptor) {
  std::array<char, 64> name{};
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t size = ::readlink(path.c_str(), name.data(), name.size());
  return size > 0 ? std::string(name.data(), static_cast<std::size_t>(size)) : "";
}

/** @brief Forget the members of an older, closed set that had the same number. @return @p set. */
int emptySet(int set) {
  const Inside inside;
  const Lock lock(sets().mutex);
  sets().members.erase(set);
  return set;
}

}  // namespace

void WaitedFor::add(const WaitedFor& other) {
  is_own = is_own && other.is_own;
  has_timer = has_timer || other.has_timer;
}

WaitedFor lookAt(int descriptor) {
  if (descriptor < 0) {
    return {};  // poll() ignores it
  }
  const Inside inside;
  const std::string name = nameOf(descriptor);
  if (name == "anon_inode:[eventpoll]") {
    return membersOf(descriptor);
  }
  const bool is_timer = name == "anon_inode:[timerfd]";
  const bool is_pipe = descriptor >= kStandardDescriptors && name.rfind("pipe:", 0) == 0;
  return {is_timer || is_pipe || name == "anon_inode:[eventfd]", is_timer};
}

WaitedFor membersOf(int set) {
  const Inside inside;
  const Lock lock(sets().mutex);
  WaitedFor all;
  for (const auto& [descriptor, what] : sets().members[set]) {
    all.add(what);
  }
  return all;
}

}  // namespace move_base_abstract::shim

namespace shim = move_base_abstract::shim;

#pragma GCC visibility push(default)
extern "C" {

int epoll_ctl(int set, int operation, int descriptor, epoll_event* event) noexcept {
  static auto* const function = shim::real(&::epoll_ctl, "epoll_ctl");
  const int result = function(set, operation, descriptor, event);
  if (result != 0 || shim::Turn::startsInternal() || operation == EPOLL_CTL_MOD) {
    return result;
  }
  const shim::WaitedFor what = shim::lookAt(descriptor);
  const shim::Inside inside;
  const shim::Lock lock(shim::sets().mutex);
  if (operation == EPOLL_CTL_ADD) {
    shim::sets().members[set][descriptor] = what;
  } else {
    shim::sets().members[set].erase(descriptor);
  }
  return result;
}

int epoll_create(int size) noexcept {
  static auto* const function = shim::real(&::epoll_create, "epoll_create");
  return shim::emptySet(function(size));
}

int epoll_create1(int flags) noexcept {
  static auto* const function = shim::real(&::epoll_create1, "epoll_create1");
  return shim::emptySet(function(flags));
}

}  // extern "C"
#pragma GCC visibility pop
