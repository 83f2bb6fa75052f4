// Checks by the wall clock whether the thread that has the turn is stuck: whether it waits in a way
// that this library does not see, or computes without end.
#include <pthread.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>

#include "clocks.h"
#include "node.h"
#include "roscpp_shim/machine/kernel.h"
#include "roscpp_shim/machine/real.h"
#include "turn.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;

constexpr auto kWatchPeriod = std::chrono::milliseconds(100);  // wall
constexpr int kStuckPeriods = 3;
constexpr int kAlonePeriods = 50;                    // for the only thread of a program
constexpr double kComputes = 20;                     // s of the processor, at one instant
constexpr Nanoseconds kComputesAgain = kSecond / 2;  // for a thread that has done so before
const char* const kLimitVariable = "MOVE_BASE_ABSTRACT_COMPUTE_LIMIT";

const char* const kWaits =
    "a thread waits for another one in a way that lockstep does not follow: it ";
const char* const kAlone =
    "the program's only thread waits for longer than 5 s for somebody outside, and simulated time "
    "goes on: it ";
const char* const kWoken = "a thread that waits for descriptors was woken from outside of lockstep";
const char* const kSpins =
    "a thread computes at one instant while others wait, longer than "
    "MOVE_BASE_ABSTRACT_COMPUTE_LIMIT says (20 s of the processor's time), as one does that looks "
    "at a variable until another thread changes it; the others go on beside it: it ";

/** @return how long a thread may compute at one instant [ns of the processor]. */
Nanoseconds computeLimit() {
  const char* const text = std::getenv(kLimitVariable);
  const double limit = text == nullptr ? 0 : std::atof(text);
  return static_cast<Nanoseconds>((limit > 0 && limit < 1e9 ? limit : kComputes) * kSecond);
}

/** @return the whole processor time of a thread [ns]; 0: the thread has ended. */
Nanoseconds computedBy(int tid) {
  constexpr int kOfThread = 6;  // the kernel's code for the clock of a thread's processor time
  return machineTime(static_cast<clockid_t>(~static_cast<unsigned>(tid) << 3 | kOfThread));
}

/** @return whether time stands while a thread waits: for a process that the program has started,
 * for its output, or until somebody reads what the program prints. */
bool keepsTime(int tid) {
  std::istringstream call(lineOf(std::to_string(tid), "syscall"));
  long number = -1;
  int descriptor = 0;
  call >> number >> std::hex >> descriptor;
  return number == SYS_wait4 || number == SYS_waitid || waitsForReader() ||
         (number == SYS_read && descriptor > STDERR_FILENO &&
          targetOf(descriptor).rfind("pipe:", 0) == 0);
}

}  // namespace

/** @brief From now on the thread that has the turn runs beside the others. @pre The lock is held.
 */
void Turn::letOthersOn(const std::string& why) {
  node().label(why + Node::Membership::describe(holder_->tid));
  holder_->is_loose = true;
  letAct(waiting_.front());
}

/** @brief Start a thread that only waits, so that somebody can report for the program. */
void Turn::standIn() {
  Task* const task = create([]() -> void* {
                       turn().wait(Wait());
                       return nullptr;
                     }).get();
  std::thread([this, task] {
    becomeInternal();
    pthread_setname_np(pthread_self(), "lockstep_turn");
    run(task);
  }).detach();
}

/** @return a waiting thread whose descriptors are ready; null: none. @pre The lock is held. */
Task* Turn::findWoken() {
  const auto at = std::find_if(waiting_.begin(), waiting_.end(), [](const Task* task) {
    return task->wait.is_on_descriptors && !task->is_signalled && task->wait.is_over();
  });
  return at == waiting_.end() ? nullptr : *at;
}

void Turn::watch() {
  std::uint64_t switches = 0;
  int asleep = 0;
  int awaits = 0;
  bool is_alone = false;
  const Nanoseconds limit = computeLimit();
  Nanoseconds computed = 0;  // processor time of the holder when it got the turn
  while (isActive()) {
    std::this_thread::sleep_for(kWatchPeriod);
    if (asleep >= kAlonePeriods && is_alone) {
      standIn();
    }
    const Lock lock(mutex_);
    is_alone = waiting_.empty();
    const bool is_working = switches == switches_ && holder_ != nullptr && !holder_->is_waiting &&
                            !holder_->is_blocking && !holder_->is_loose;
    awaits = switches == switches_ && findWoken() != nullptr ? awaits + 1 : 0;
    switches = switches_;
    if (awaits >= kStuckPeriods) {
      findWoken()->is_signalled = true;
      node().label(kWoken);
      node().ring();
    }
    if (!is_working) {
      asleep = 0;
      computed = holder_ == nullptr ? 0 : computedBy(holder_->tid);
      continue;
    }
    asleep = stateOf(std::to_string(holder_->tid)) == 'S' ? asleep + 1 : 0;
    if (is_alone) {
      computed = computedBy(holder_->tid);
      asleep = asleep >= kAlonePeriods && keepsTime(holder_->tid) ? 0 : asleep;
    } else if (asleep >= kStuckPeriods && !waitsForReader()) {
      letOthersOn(asleep > kAlonePeriods ? kAlone : kWaits);
    } else if (computedBy(holder_->tid) - computed > (holder_->has_spun ? kComputesAgain : limit)) {
      holder_->has_spun = true;
      letOthersOn(kSpins);
    }
  }
}

}  // namespace move_base_abstract::shim
