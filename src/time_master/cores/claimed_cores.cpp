#include "claimed_cores.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <string>

namespace move_base_abstract {
namespace {

constexpr double kFewestTicks = 5.0;  // fewer do not tell how busy a core is
constexpr int kAvoided = 5;           // tenths of the time that a core counts as busier

/**
 * @return a claim that keeps other runs off a core until it is closed; none if another run has the
 * core.
 */
Descriptor claimCore(int core) {
  Descriptor claim(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = "move_base_abstract/core/" + std::to_string(core);
  std::copy(name.begin(), name.end(), address.sun_path + 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return bind(claim.get(), reinterpret_cast<const sockaddr*>(&address), size) == 0
             ? std::move(claim)
             : Descriptor();
}

}  // namespace

bool ClaimedCores::areIn(const cpu_set_t& cores) const {
  return std::all_of(numbers_.begin(), numbers_.end(),
                     [&cores](int core) { return CPU_ISSET(core, &cores) != 0; });
}

bool ClaimedCores::choose(const cpu_set_t& allowed, std::size_t fewest, std::size_t most,
                          bool is_wished) {
  const std::vector<std::pair<int, int>> order = byWork(allowed);
  for (auto entry = order.begin(); entry != order.end() && numbers_.size() < most; ++entry) {
    Descriptor claim = claimCore(entry->second);
    if (claim.get() >= 0) {
      numbers_.push_back(entry->second);
      claims_.push_back(std::move(claim));
    }
  }
  if (numbers_.size() < fewest) {
    numbers_.clear();
    claims_.clear();
    for (std::size_t k = 0; is_wished && order.size() >= fewest && k < fewest; ++k) {
      numbers_.push_back(order[k].second);
    }
  }
  std::sort(numbers_.begin(), numbers_.end());
  return !numbers_.empty();
}

void ClaimedCores::leave() {
  if (!numbers_.empty()) {
    avoided_ = std::exchange(numbers_, {});
    claims_.clear();
  }
}

/** @return how busy each of @p cores is, in tenths of the time, and its number; the idlest first.
 */
std::vector<std::pair<int, int>> ClaimedCores::byWork(const cpu_set_t& cores) {
  std::map<int, Work> work = takeWork();
  std::vector<std::pair<int, int>> order;
  for (int core = 0; core < CPU_SETSIZE; ++core) {
    if (CPU_ISSET(core, &cores) != 0) {
      const Work& done = work[core];
      const double busy = done.all < kFewestTicks ? 0.0 : 1.0 - done.idle / done.all;
      const bool is_avoided = std::count(avoided_.begin(), avoided_.end(), core) > 0;
      order.emplace_back(static_cast<int>(std::lround(10.0 * busy)) + (is_avoided ? kAvoided : 0),
                         core);
    }
  }
  std::sort(order.begin(), order.end());
  return order;
}

/** @return the work of each core since the last call, or since the computer was started. */
std::map<int, ClaimedCores::Work> ClaimedCores::takeWork() {
  std::ifstream file("/proc/stat");
  std::map<int, Work> latest;
  for (std::string line; std::getline(file, line) && line.rfind("cpu", 0) == 0;) {
    std::istringstream fields(line.substr(3));
    int core = -1;
    if (line[3] == ' ' || !(fields >> core)) {
      continue;
    }
    double ticks = 0.0;
    for (int k = 0; k < 8 && fields >> ticks; ++k) {  // user nice system idle iowait irq ... steal
      latest[core].idle += k == 3 || k == 4 ? ticks : 0.0;
      latest[core].all += ticks;
    }
  }
  std::map<int, Work> since = latest;
  for (auto& [core, work] : since) {
    work.idle -= work_[core].idle;
    work.all -= work_[core].all;
  }
  work_ = std::move(latest);
  return since;
}

}  // namespace move_base_abstract
