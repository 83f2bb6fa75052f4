#include "core_binding.h"

#include <dirent.h>
#include <sys/syscall.h>
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

bool CoreBinding::isOnly(const cpu_set_t& cores) const {
  return claimed_.number() >= 0 && CPU_COUNT(&cores) == 1 &&
         CPU_ISSET(claimed_.number(), &cores) != 0;
}

void CoreBinding::bind(bool anew) {
  const bool may_bind = own_thread_id_ != 0 && !own_thread_.is_left_alone &&
                        std::any_of(processes_.begin(), processes_.end(), [](const auto& entry) {
                          return !entry.second.is_left_alone && CPU_COUNT(&entry.second.own) > 1;
                        });
  const cpu_set_t cores = allowed();
  const bool stays = claimed_.number() >= 0 && CPU_ISSET(claimed_.number(), &cores) != 0;
  if (anew || !may_bind || !stays) {
    leaveCore();
  }
  if (may_bind && claimed_.number() < 0) {
    claimed_.choose(cores);
  }
  if (claimed_.number() < 0) {
    return;
  }
  is_bound_ = true;
  applyTo(own_thread_id_, own_thread_, true);
  for (auto& [id, process] : processes_) {
    apply(id, process, true);
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

void CoreBinding::leaveCore() {
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
  const bool has_one = isOnly(*now);
  // A new thread has the cores of the thread that made it.
  const auto entry = process.threads.try_emplace(id, has_one ? process.own : *now).first;
  cpu_set_t wanted = entry->second;
  if (!has_one && CPU_EQUAL(&*now, &wanted) == 0) {
    return false;
  }
  if (to_one && CPU_ISSET(claimed_.number(), &wanted) != 0) {
    CPU_ZERO(&wanted);
    CPU_SET(claimed_.number(), &wanted);
  }
  return CPU_EQUAL(&*now, &wanted) != 0 || setCores(id, wanted) || !coresOf(id);
}

void CoreBinding::leaveAlone(pid_t id, Process& process) {
  process.is_left_alone = true;
  for (const pid_t thread : threadsOf(id)) {
    const auto now = coresOf(thread);
    const auto found = process.threads.find(thread);
    if (now && found != process.threads.end() && isOnly(*now)) {
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
        if (now && isOnly(*now)) {
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
