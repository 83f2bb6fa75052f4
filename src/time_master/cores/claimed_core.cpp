#include "claimed_core.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

namespace move_base_abstract {
namespace {

constexpr double kFewestTicks = 5.0;  // fewer do not tell how busy a core is
constexpr int kMostRuns = 64;         // with claims on one core

/**
 * @return a claim that is held until it is closed; none if another run has the same: the first
 * (@p place 0), the second, ... claim on the core.
 */
Descriptor claimCore(int core, int place) {
  Descriptor claim(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = "move_base_abstract/core/" + std::to_string(core) +
                           (place == 0 ? "" : "/" + std::to_string(place));
  std::copy(name.begin(), name.end(), address.sun_path + 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return bind(claim.get(), reinterpret_cast<const sockaddr*>(&address), size) == 0
             ? std::move(claim)
             : Descriptor();
}

}  // namespace

ClaimedCore::ClaimedCore() : ticks_at_start_(ticks()) {}

void ClaimedCore::choose(const cpu_set_t& allowed) {
  leave();
  const std::vector<int> cores = idlestFirst(allowed);
  for (int place = 0; place < kMostRuns; ++place) {
    for (const int core : cores) {
      claim_ = claimCore(core, place);
      if (claim_.get() >= 0) {
        number_ = core;
        is_shared_ = place > 0;
        return;
      }
    }
  }
}

void ClaimedCore::leave() {
  number_ = -1;
  claim_ = Descriptor();
  is_shared_ = false;
}

std::vector<int> ClaimedCore::idlestFirst(const cpu_set_t& cores) const {
  std::vector<std::pair<int, int>> order;  // tenths of the time that it was busy, and its number
  for (const auto& [core, now] : ticks()) {
    if (core < CPU_SETSIZE && CPU_ISSET(core, &cores) != 0) {
      const auto found = ticks_at_start_.find(core);
      const Ticks begin = found == ticks_at_start_.end() ? Ticks() : found->second;
      const double all = now.all - begin.all;
      const double busy = all < kFewestTicks ? 0.0 : 1.0 - (now.idle - begin.idle) / all;
      order.emplace_back(static_cast<int>(std::lround(10.0 * busy)), core);
    }
  }
  std::sort(order.begin(), order.end());
  std::vector<int> numbers;
  for (const auto& entry : order) {
    numbers.push_back(entry.second);
  }
  return numbers;
}

/** @return the time of each core since the computer was started. */
std::map<int, ClaimedCore::Ticks> ClaimedCore::ticks() {
  std::ifstream file("/proc/stat");
  std::map<int, Ticks> found;
  for (std::string line; std::getline(file, line) && line.rfind("cpu", 0) == 0;) {
    std::istringstream fields(line.substr(3));
    int core = -1;
    if (line[3] == ' ' || !(fields >> core)) {
      continue;
    }
    double ticks = 0.0;
    for (int k = 0; k < 8 && fields >> ticks; ++k) {  // user nice system idle iowait irq ... steal
      found[core].idle += k == 3 || k == 4 ? ticks : 0.0;
      found[core].all += ticks;
    }
  }
  return found;
}

}  // namespace move_base_abstract
