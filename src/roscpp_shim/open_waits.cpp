// What the program's threads wait for without a time-out.
#include <algorithm>
#include <mutex>
#include <vector>

#include "turn.h"

namespace move_base_abstract::shim {
namespace {

/**
 * @return whether a waiting thread is owed what it waits for. A thread in a callback is in the
 * middle of its work. A thread that waits for the end of another one is owed what that one is owed.
 * In a circle of such waits no thread can end.
 */
bool isOwed(const Task& task) {
  std::vector<const Task*> seen;
  for (const Task* at = &task; at != nullptr; at = at->is_waiting ? at->wait.end_of : nullptr) {
    if (std::find(seen.begin(), seen.end(), at) != seen.end() ||
        (at->is_waiting && (at->wait.is_owed || at->in_callbacks > 0))) {
      return true;
    }
    seen.push_back(at);
  }
  return false;
}

}  // namespace

OpenWaits Turn::openWaits() {
  const std::lock_guard<PlainMutex> lock(mutex_);
  OpenWaits waits;
  for (const Task* task : waiting_) {
    if (task->wait.what != nullptr && task->wait.until == kNever) {
      (isOwed(*task) ? waits.owed : waits.work).emplace_back(task->wait.what);
    }
  }
  return waits;
}

}  // namespace move_base_abstract::shim
