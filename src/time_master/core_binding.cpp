#include "core_binding.h"

#include <dirent.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <memory>
#include <sstream>

#include "whole_file.h"

namespace move_base_abstract {
namespace {

constexpr int kDeepestChild = 16;
constexpr double kFewestTicks = 5.0;  // fewer do not tell how busy a core is

std::string folderOf(pid_t process) { return "/proc/" + std::to_string(process); }

std::vector<pid_t> threadsOf(pid_t process) {
  std::vector<pid_t> threads;
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir((folderOf(process) + "/task").c_str()),
                                                   &closedir);
  for (const dirent* entry = folder ? readdir(folder.get()) : nullptr; entry != nullptr;
       entry = readdir(folder.get())) {
    if (entry->d_name[0] != '.') {
      threads.push_back(static_cast<pid_t>(std::stol(entry->d_name)));
    }
  }
  return threads;
}

/**
 * @return the time at which the process began, in the kernel's ticks; '' if there is no such
 * process.
 */
std::string beginOf(pid_t process) {
  const std::string line = wholeFile(folderOf(process) + "/stat");
  const std::size_t name_end = line.rfind(')');
  std::istringstream fields(name_end == std::string::npos ? "" : line.substr(name_end + 1));
  std::string field;
  for (int k = 3; k <= 22; ++k) {  // numbers of the fields in proc(5)
    fields >> field;
  }
  return fields ? field : "";
}

std::optional<cpu_set_t> coresOf(pid_t thread) {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  return sched_getaffinity(thread, sizeof(cores), &cores) == 0 ? std::make_optional(cores)
                                                               : std::nullopt;
}

bool setCores(pid_t thread, const cpu_set_t& cores) {
  return sched_setaffinity(thread, sizeof(cores), &cores) == 0;
}

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

CoreBinding::CoreBinding() : one_() { takeWork(); }

void CoreBinding::useThisThread() {
  own_thread_id_ = static_cast<pid_t>(syscall(SYS_gettid));
  const auto own = coresOf(own_thread_id_);
  own_thread_.is_left_alone = !own;
  if (own) {
    own_thread_.own = *own;
  }
}

void CoreBinding::add(pid_t process) {
  freeChildren();  // it may be a child
  Process& added = processes_[process];
  if (++added.uses > 1) {
    return;
  }
  const auto own = coresOf(process);
  added.began = beginOf(process);
  added.is_left_alone = !own || added.began.empty() || process == getpid();
  if (own) {
    added.own = *own;
  }
  for (const pid_t thread : threadsOf(process)) {
    if (const auto cores = coresOf(thread)) {
      added.threads[thread].own = *cores;
    }
  }
}

void CoreBinding::remove(pid_t process) {
  const auto found = processes_.find(process);
  if (found == processes_.end() || --found->second.uses > 0) {
    return;
  }
  apply(process, found->second, false);
  processes_.erase(found);
}

cpu_set_t CoreBinding::allowed() const {
  cpu_set_t cores = own_thread_.own;
  for (const auto& [id, process] : processes_) {
    if (!process.is_left_alone) {
      CPU_AND(&cores, &cores, &process.own);
    }
  }
  return cores;
}

bool CoreBinding::hasChoice() const {
  return own_thread_id_ != 0 && !own_thread_.is_left_alone &&
         std::any_of(processes_.begin(), processes_.end(), [](const auto& entry) {
           return !entry.second.is_left_alone && CPU_COUNT(&entry.second.own) > 1;
         });
}

bool CoreBinding::isOne(const cpu_set_t& cores) const {
  return core_ >= 0 && CPU_EQUAL(&cores, &one_) != 0;
}

bool CoreBinding::bind(bool is_wished) {
  const cpu_set_t cores = allowed();
  if (core_ >= 0 && CPU_ISSET(core_, &cores) == 0) {
    leaveCore();
  }
  if (core_ < 0 && !choose(is_wished)) {
    return false;
  }
  is_bound_ = true;
  applyTo(own_thread_id_, own_thread_, true);
  for (auto& [id, process] : processes_) {
    apply(id, process, true);
  }
  return true;
}

void CoreBinding::release() {
  if (!is_bound_) {
    return;
  }
  freeChildren();
  is_bound_ = false;
  for (auto& [id, process] : processes_) {
    apply(id, process, false);
  }
  applyTo(own_thread_id_, own_thread_, false);
}

void CoreBinding::leaveCore() {
  release();
  if (core_ >= 0) {
    avoided_ = std::exchange(core_, -1);
    claim_ = Descriptor();
  }
}

// ---- one process -----------------------------------------------------------------------------

bool CoreBinding::isThere(pid_t id, const Process& process) const {
  return beginOf(id) == process.began;
}

void CoreBinding::apply(pid_t id, Process& process, bool to_one) {
  if (process.is_left_alone || !isThere(id, process)) {
    return;
  }
  for (const pid_t thread : threadsOf(id)) {
    if (!applyTo(thread, process, to_one)) {
      leaveAlone(id, process);
      return;
    }
  }
}

/** @return false if another program has changed the thread's cores, or they may not be changed. */
bool CoreBinding::applyTo(pid_t id, Process& process, bool to_one) {
  const auto now = coresOf(id);
  if (!now) {
    return true;  // it has just ended
  }
  const auto [entry, is_new] = process.threads.try_emplace(id);
  Thread& thread = entry->second;
  if (is_new) {  // it has the cores of the thread that made it
    thread.is_bound = isOne(*now);
    thread.own = thread.is_bound ? process.own : *now;
  }
  const bool is_own = CPU_EQUAL(&*now, &thread.own) != 0;
  if (!is_own && !(thread.is_bound && isOne(*now))) {
    return false;
  }
  thread.is_bound = to_one && CPU_ISSET(core_, &thread.own) != 0;
  const cpu_set_t& wanted = thread.is_bound ? one_ : thread.own;
  return CPU_EQUAL(&*now, &wanted) != 0 || setCores(id, wanted) || !coresOf(id);
}

void CoreBinding::leaveAlone(pid_t id, Process& process) {
  process.is_left_alone = true;
  for (const pid_t thread : threadsOf(id)) {
    const auto now = coresOf(thread);
    const auto found = process.threads.find(thread);
    const bool is_bound = found != process.threads.end() && found->second.is_bound;
    if (now && is_bound && isOne(*now)) {
      setCores(thread, found->second.own);
    }
  }
}

void CoreBinding::freeChildren() {
  if (!is_bound_) {
    return;
  }
  for (const auto& [id, process] : processes_) {
    if (!process.is_left_alone && isThere(id, process)) {
      freeChildrenOf(id, process.own, 0);
    }
  }
}

void CoreBinding::freeChildrenOf(pid_t parent, const cpu_set_t& own, int depth) {
  for (const pid_t thread : threadsOf(parent)) {
    std::ifstream children(folderOf(parent) + "/task/" + std::to_string(thread) + "/children");
    for (pid_t child = 0; children >> child;) {
      if (processes_.count(child) > 0) {
        continue;
      }
      for (const pid_t one : threadsOf(child)) {
        const auto now = coresOf(one);
        if (now && isOne(*now)) {
          setCores(one, own);
        }
      }
      if (depth < kDeepestChild) {
        freeChildrenOf(child, own, depth + 1);
      }
    }
  }
}

// ---- which core ------------------------------------------------------------------------------

/** @return the work of each core since the last call, or since the computer was started. */
std::map<int, CoreBinding::Work> CoreBinding::takeWork() {
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

/** @brief Choose the core that is idle most of the time and is not another run's. */
bool CoreBinding::choose(bool is_wished) {
  const cpu_set_t cores = allowed();
  std::map<int, Work> work = takeWork();
  std::vector<std::pair<int, int>> order;  // tenths of the time that it worked; core
  for (int core = 0; core < CPU_SETSIZE; ++core) {
    if (CPU_ISSET(core, &cores) != 0) {
      const Work& done = work[core];
      const double busy = done.all < kFewestTicks ? 0.0 : 1.0 - done.idle / done.all;
      order.emplace_back(static_cast<int>(std::lround(10.0 * busy)) + (core == avoided_ ? 5 : 0),
                         core);
    }
  }
  std::sort(order.begin(), order.end());
  for (const auto& [busy, core] : order) {
    claim_ = claimCore(core);
    if (claim_.get() >= 0) {
      core_ = core;
      break;
    }
  }
  if (core_ < 0 && is_wished && !order.empty()) {
    core_ = order.front().second;
  }
  CPU_ZERO(&one_);
  if (core_ >= 0) {
    CPU_SET(core_, &one_);
  }
  return core_ >= 0;
}

}  // namespace move_base_abstract
