#include "core_binding.h"

#include <dirent.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>

#include "time_master/whole_file.h"

namespace move_base_abstract {
namespace {

constexpr int kDeepestChild = 16;

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

/** @return the time for which @p process has worked, on all cores together [ns]. */
Nanoseconds workOf(pid_t process) {
  clockid_t clock = 0;
  timespec time{};
  return clock_getcpuclockid(process, &clock) == 0 && clock_gettime(clock, &time) == 0
             ? time.tv_sec * kNanosecondsPerSecond + time.tv_nsec
             : 0;
}

bool isOnly(int core, const cpu_set_t& cores) {
  return core >= 0 && CPU_COUNT(&cores) == 1 && CPU_ISSET(core, &cores) != 0;
}

bool setCores(pid_t thread, const cpu_set_t& cores) {
  return sched_setaffinity(thread, sizeof(cores), &cores) == 0;
}

}  // namespace

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
  added.worked = workOf(process);
  added.is_left_alone = !own || added.began.empty() || process == getpid();
  if (own) {
    added.own = *own;
  }
  for (const pid_t thread : threadsOf(process)) {
    if (const auto cores = coresOf(thread)) {
      added.threads[thread] = *cores;
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
  if (own_thread_id_ == 0 || own_thread_.is_left_alone) {
    return false;
  }
  const cpu_set_t common = allowed();
  return CPU_COUNT(&common) >= (layout_ == CoreLayout::kApart ? 2 : 1) &&
         std::any_of(processes_.begin(), processes_.end(), [](const auto& entry) {
           return !entry.second.is_left_alone && CPU_COUNT(&entry.second.own) > 1;
         });
}

void CoreBinding::bind() {
  if (claimed_.numbers().empty() || !claimed_.areIn(allowed())) {
    release();
    const std::size_t most = layout_ == CoreLayout::kTogether ? 1 : processes_.size();
    claimed_.choose(allowed(), std::min<std::size_t>(most, 2), most);
    if (claimed_.numbers().empty()) {
      return;
    }
  }
  share();
  is_bound_ = true;
  if (layout_ == CoreLayout::kTogether) {
    own_thread_.core = claimed_.numbers().front();
    applyTo(own_thread_id_, own_thread_, true);
  }
  for (auto& [id, process] : processes_) {
    apply(id, process, true);
  }
}

/**
 * @brief Share the cores out: from the process that has worked most since the last time, each gets
 * the core with the least work so far. One that is bound already stays where it is.
 */
void CoreBinding::share() {
  std::map<int, Nanoseconds> loads;
  std::vector<std::pair<Nanoseconds, Process*>> order;
  for (const int core : claimed_.numbers()) {
    loads[core] = 0;
  }
  for (auto& [id, process] : processes_) {
    if (process.is_left_alone) {
      continue;
    }
    const Nanoseconds now = workOf(id);
    const Nanoseconds worked = now - process.worked;
    if (is_bound_ && process.core >= 0) {
      loads[process.core] += worked;
    } else {
      order.emplace_back(worked, &process);
      process.worked = now;
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [worked, process] : order) {
    const auto least =
        std::min_element(loads.begin(), loads.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    process->core = least->first;
    least->second += std::max<Nanoseconds>(worked, 1);
  }
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

void CoreBinding::leaveCores() {
  release();
  claimed_.leave();
}

// ---- one process -----------------------------------------------------------------------------

bool CoreBinding::isThere(pid_t id, const Process& process) const {
  return beginOf(id) == process.began;
}

void CoreBinding::apply(pid_t id, Process& process, bool to_one) {
  if (process.is_left_alone || !isThere(id, process)) {
    return;
  }
  std::vector<pid_t> threads = threadsOf(id);
  for (std::size_t known = 0; threads.size() > known; threads = threadsOf(id)) {
    known = threads.size();  // a thread that is made meanwhile has the cores of its maker
    for (const pid_t thread : threads) {
      if (!applyTo(thread, process, to_one)) {
        leaveAlone(id, process);
        return;
      }
    }
  }
}

/** @return false if another program has changed the thread's cores, or they may not be changed. */
bool CoreBinding::applyTo(pid_t id, Process& process, bool to_one) {
  const auto now = coresOf(id);
  if (!now) {
    return true;  // it has just ended
  }
  const bool has_one = isOnly(process.core, *now);
  // A new thread has the cores of the thread that made it.
  const auto entry = process.threads.try_emplace(id, has_one ? process.own : *now).first;
  cpu_set_t wanted = entry->second;
  if (!has_one && CPU_EQUAL(&*now, &wanted) == 0) {
    return false;
  }
  if (to_one && CPU_ISSET(process.core, &wanted) != 0) {
    CPU_ZERO(&wanted);
    CPU_SET(process.core, &wanted);
  }
  return CPU_EQUAL(&*now, &wanted) != 0 || setCores(id, wanted) || !coresOf(id);
}

void CoreBinding::leaveAlone(pid_t id, Process& process) {
  process.is_left_alone = true;
  for (const pid_t thread : threadsOf(id)) {
    const auto now = coresOf(thread);
    const auto found = process.threads.find(thread);
    if (now && found != process.threads.end() && isOnly(process.core, *now)) {
      setCores(thread, found->second);
    }
  }
}

void CoreBinding::freeChildren() {
  if (!is_bound_) {
    return;
  }
  for (const auto& [id, process] : processes_) {
    if (!process.is_left_alone && isThere(id, process)) {
      freeChildrenOf(id, process, 0);
    }
  }
}

void CoreBinding::freeChildrenOf(pid_t parent, const Process& of, int depth) {
  for (const pid_t thread : threadsOf(parent)) {
    std::ifstream children(folderOf(parent) + "/task/" + std::to_string(thread) + "/children");
    for (pid_t child = 0; children >> child;) {
      if (processes_.count(child) > 0) {
        continue;
      }
      for (const pid_t one : threadsOf(child)) {
        const auto now = coresOf(one);
        if (now && isOnly(of.core, *now)) {
          setCores(one, of.own);
        }
      }
      if (depth < kDeepestChild) {
        freeChildrenOf(child, of, depth + 1);
      }
    }
  }
}

}  // namespace move_base_abstract
