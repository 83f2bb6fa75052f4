#include "node.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/param.h>
#include <ros/time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <vector>

#include "allocations.h"
#include "delivery.h"
#include "exchange.h"
#include "launcher.h"
#include "parameters.h"
#include "recorder.h"
#include "roscpp_shim/machine/real.h"

namespace move_base_abstract::shim {
namespace {

using Lock = std::lock_guard<PlainMutex>;
using lockstep::internal::readPresence;

constexpr std::int64_t kPatience = 1'000'000'000;  // steady ns

const char* const kMixed =
    "memory that was given back by threads without an order was used again: the addresses of what "
    "the program allocates may differ from run to run";

std::int64_t steadyNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Node& node() {
  static Node* const instance = new Node;  // threads use it until the process has gone
  return *instance;
}

bool takesPart() { return turn().isActive(); }

bool isManaged(const std::string& topic) {
  return takesPart() && !node().membership().isExcluded(topic);
}

Node::Node() {
  const char* const sleep = told().sleep;
  sleeps_simulated_ = sleep != nullptr && std::string(sleep) == "simulated";
}

bool Node::isWanted() {
  std::string mode;
  return told().looks_on == nullptr && ros::param::get(lockstep::internal::kModeParameter, mode) &&
         mode == lockstep::internal::kLockstepMode;
}

// ---- joining and leaving ---------------------------------------------------------------------

bool Node::join() {
  const char* const rank = told().rank;
  try {
    membership_.present(
        readPresence(rank == nullptr ? std::nullopt : std::optional<int>(std::atoi(rank))));
    if (!membership_.connect()) {
      return false;
    }
    membership_.join();
    if (told().strict != nullptr) {
      membership_.append(wire::Note{wire::NoteKind::kStrict, "the launcher's option"});
    }
  } catch (const lockstep::internal::NotLockstep&) {
    return false;  // the mode was changed meanwhile
  } catch (const lockstep::internal::Error& error) {
    ROS_FATAL("%s", error.what());
    std::fflush(nullptr);
    std::_Exit(1);  // no destructors, because roscpp's threads still run
  }
  return membership_.isActive();
}

void Node::leave(const std::string& reason) {
  // If another thread reads from the connection, that thread closes it.
  const bool is_own = turn().holds();
  const Inside inside;
  if (!membership_.leave(reason, !is_own)) {
    return;
  }
  endTurns();
  membership_.ring();
  if (is_own) {
    membership_.finish();
  }
}

void Node::endTurns() {
  turn().end();
  for (std::size_t kind = 0; kind < kTimerKinds; ++kind) {
    if (has_timers_[kind] && timers_[kind].release) {
      timers_[kind].release();
    }
  }
}

void Node::onEnd() {
  endTurns();
  if (ros::ok()) {
    ros::requestShutdown();
  }
}

// ---- rounds ----------------------------------------------------------------------------------

/** @return the calling thread's place; before there are turns, none. */
Place* Node::place() {
  static Place none;
  return Turn::self() == nullptr ? &none : &Turn::self()->place;
}

bool Node::beginLook() {
  look_.lock();
  return turn().acts();
}

bool Node::takeGrant() {
  {
    const Lock lock(look_);
    if (!membership_.isOffered()) {
      return false;
    }
    turn().act();
  }
  return exchange();
}

bool Node::exchange() {
  const Inside inside;
  const bool has_grant =
      membership_.exchange(membership_.hasTurn() ? wish() : lockstep::internal::Wish());
  // The grant brought nothing, and was for nothing else.
  if (has_grant && awaits_rest_ && membership_.isPlainGrant()) {
    rest_round_ = round();
  }
  return has_grant;
}

/** @return the content of a report besides its actions. */
lockstep::internal::Wish Node::wish() {
  lockstep::internal::Wish wish;
  wish.next = turn().nextWake();
  for (std::size_t kind = 0; kind < kTimerKinds; ++kind) {
    wish.next = has_timers_[kind] ? std::min(wish.next, timers_[kind].next()) : wish.next;
  }
  if (areAddressesMixed()) {
    label(kMixed);
  }
  const OpenWaits threads = turn().openWaits();
  wish.open = static_cast<std::uint32_t>(open_.size() + threads.owed.size());
  wish.idle = static_cast<std::uint32_t>(threads.work.size());
  wish.waits = wish.next == kNever ? waits(threads) : "";
  const bool is_resting = turn().isResting();
  if (is_resting) {
    append(wire::Rest{});
  }
  awaits_rest_ = is_resting && wish.next > now();
  if (onlyRecords() && wish.next > now() && wish.next != kNever) {
    append(wire::Background{});  // it looks for new topics; if no other node acts, there are none
  }
  keepUnread();
  parameters().reported();
  if (SharedChannel* const channel = membership_.channel()) {
    turn().direct(wish.next, &channel->directions());
  }
  return wish;
}

/** @brief Give a thread that looks again with any grant the grants that it would have if no
 * messages were kept. */
void Node::keepUnread() {
  const Nanoseconds first = keepsUnread() ? turn().firstLook() : kNever;
  if (first != kNever) {
    append(wire::KeepUntil{first});
  }
}

std::string Node::waits(const OpenWaits& threads) const {
  std::vector<std::string> all(open_.begin(), open_.end());
  all.insert(all.end(), threads.owed.begin(), threads.owed.end());
  all.insert(all.end(), threads.work.begin(), threads.work.end());
  std::string text;
  for (const std::string& what : all) {
    text += (text.empty() ? membership_.name() + " waits for " : ", ") + what;
  }
  return text;
}

bool Node::hasInput() {
  if (const char* const what = turn().guest()) {
    if (*what != '\0') {
      label(std::string("a thread that takes no turns has woken one that waited for ") + what);
    }
    return true;
  }
  const Lock lock(mutex_);
  return std::any_of(outside_.begin(), outside_.end(),
                     [](const Input& input) { return input.is_urgent; });
}

bool Node::waitsOn() {
  if (!ros::ok() || ros::isShuttingDown()) {
    leave("ROS was shut down");
    return true;
  }
  // This needs no grant: a caller may hold up time until it has its answer, and input that is not
  // urgent must not wait for ever.
  return !enterOutside(true);
}

void Node::setTime(Nanoseconds now) {
  static auto* const set_now = real<void(const ros::Time&)>("ros::Time::setNow");
  set_now(ros::Time().fromNSec(static_cast<std::uint64_t>(now)));
}

void Node::handle(const wire::Publisher& item) { shim::handle(item); }
void Node::handle(const wire::NoPublisher& item) { shim::handle(item); }
void Node::handle(const wire::Subscriber& item) { shim::handle(item); }
void Node::handle(const wire::NoSubscriber& item) { shim::handle(item); }
void Node::handle(const wire::Deliver& item) { shim::handle(item); }
void Node::handle(const wire::CallIn& item) { shim::handle(item); }
void Node::onMember(const std::string& name) { dropConnectionsTo(name); }

void Node::onGranted() {
  store();
  enterOutside(false);
  for (std::size_t kind = 0; kind < kTimerKinds; ++kind) {
    if (has_timers_[kind]) {
      timers_[kind].fire();
    }
  }
}

// ---- from outside ----------------------------------------------------------------------------

void Node::fromOutside(Input input) {
  {
    const Lock lock(mutex_);
    if (outside_since_ == 0) {
      outside_since_ = steadyNow();
    }
    outside_.push_back(std::move(input));
  }
  ring();
}

bool Node::enterOutside(bool only_if_late) {
  std::deque<Input> inputs;
  {
    const Lock lock(mutex_);
    if (only_if_late && (outside_since_ == 0 || steadyNow() - outside_since_ < kPatience)) {
      return false;
    }
    inputs.swap(outside_);
    outside_since_ = 0;
  }
  for (Input& input : inputs) {
    if (!input.label.empty()) {
      label(input.label);
    }
    input.enter();
  }
  return true;
}

void Node::removeOutside(const ros::CallbackQueue* queue, std::uint64_t owner) {
  const Lock lock(mutex_);
  outside_.erase(std::remove_if(outside_.begin(), outside_.end(),
                                [queue, owner](const Input& input) {
                                  return input.queue == queue && input.owner == owner;
                                }),
                 outside_.end());
}

void Node::setTimers(TimerKind kind, SimulatedTimers timers) {
  timers_[kind] = std::move(timers);
  has_timers_[kind] = true;
}

}  // namespace move_base_abstract::shim
