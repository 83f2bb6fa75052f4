#include "membership.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/param.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <variant>

#include "thread_stack.h"

namespace move_base_abstract::lockstep::internal {
namespace {

using Lock = std::lock_guard<Program>;

constexpr int kPollMilliseconds = 100;  // wall; how soon an end of ROS is noticed
const char* const kClosed = "the time master has closed the connection";
const char* const kReplaced = "another node of its name has taken its place";

/** @return the same as gettid(), without a system call for each grant. */
int ownThread() {
  thread_local const int thread = static_cast<int>(::syscall(SYS_gettid));
  return thread;
}

/** @return whether the grant has no items for the program. */
bool isEmpty(const wire::Grant& grant) {
  return std::all_of(grant.items.begin(), grant.items.end(),
                     [](const auto& item) { return std::holds_alternative<wire::Changed>(item); });
}

}  // namespace

std::string Reply::why() const {
  switch (status) {
    case wire::CallStatus::kNoServer:
      return "no participant offers it";
    case wire::CallStatus::kServerGone:
      return "its server has gone";
    default:
      return bytes;
  }
}

// ---- joining and leaving ---------------------------------------------------------------------

void Membership::join() {
  delay_.prepare(name());
  const std::string hello = helloOf(presence_);
  state_ = State::kJoining;
  if (!link_.send(hello)) {
    end(kClosed);
    return;
  }
  link_.announceStopSignals();
  if (!ros::param::param("/use_sim_time", false)) {
    ROS_WARN("lockstep: %s takes part, but /use_sim_time is not true", name().c_str());
  }
  awaitGrant();
}

bool Membership::leave(const std::string& reason, bool is_asked_to) {
  if (isActive() && isReplaced()) {
    fail(name(), kReplaced);
  }
  const Lock lock(program_);
  if (state_ == State::kNew || isOver()) {
    return false;
  }
  if (is_asked_to) {
    link_.send(wire::encode(wire::ParticipantFrame(wire::Stopping{reason})));
  }
  if (state_ == State::kTurn) {
    wire::Report head;
    head.round = round_;
    head.leaving = true;
    link_.send(wire::encodeReport(head, items_));
  } else {
    link_.send(wire::encode(wire::ParticipantFrame(wire::Leave{reason})));
  }
  state_ = State::kOver;  // after all is sent, as the reading thread closes the connection then
  return true;
}

void Membership::end(const std::string& reason, bool as_wished) {
  {
    const Lock lock(program_);
    if (isOver()) {
      return;
    }
    state_ = State::kOver;
  }
  link_.close();
  if (as_wished && ros::ok()) {
    ROS_INFO("lockstep: the run is over for %s: %s", name().c_str(), reason.c_str());
  } else {
    const bool is_told_to_end = awaitsOwnSignal();  // the time master may end before this process
    if (isReplaced()) {
      fail(name(), kReplaced);
    } else if (!is_told_to_end) {
      fail(name(), reason);
    }
  }
  program_.onEnd();
}

// ---- rounds ----------------------------------------------------------------------------------

bool Membership::exchange(const Wish& wish) {
  is_awaited_ = true;
  if (hasTurn()) {
    if (walk(wish)) {
      return true;
    }
    report(wish);
  }
  return awaitGrant();
}

/** @brief Begin the next turn of the window, if there is one. @return whether it has begun. */
bool Membership::walk(const Wish& wish) {
  if (must_report_ || is_background_ || program_.hasInput()) {
    return false;
  }
  const Nanoseconds next = window_.next(wish.next, now_);
  if (next == kNever) {
    return false;
  }
  {
    const Lock lock(program_);
    if (isOver()) {
      return false;
    }
    if (next != told_at_) {
      told_at_ = next;
      wire::append(items_, wire::At{next});
    }
  }
  beginTurn({}, next, next == now_ ? microstep_ + 1 : 0);
  return true;
}

void Membership::report(const Wish& wish) {
  delay_.wait();
  wire::Report head;
  head.round = round_;
  head.next_ns = std::min(wish.next, window_.firstArrival());
  head.open = wish.open;
  bool is_sent = true;
  {
    const Lock lock(program_);
    if (isOver()) {
      return;
    }
    if (wish.waits != told_) {
      told_ = wish.waits;
      wire::append(items_, wire::Note{wire::NoteKind::kWaitsFor, told_});
    }
    if (wish.idle > 0) {
      wire::append(items_, wire::Idle{wish.idle});
    }
    if (is_background_ && window_.firstArrival() == kNever) {
      wire::append(items_, wire::Background{});
    }
    must_report_ = is_background_ = false;
    is_sent = link_.sendAwaited(wire::encodeReport(head, items_));
    items_.clear();
    state_ = State::kReported;
  }
  if (!is_sent) {
    end(kClosed);
  }
}

bool Membership::awaitGrant() {
  bool is_ours = true;
  for (bool goes_on = true; is_ours && goes_on;) {
    if (isWaiting()) {
      knockIfNeeded();
      link_.await(bell_, kPollMilliseconds, program_.place());
    }
    is_ours = program_.beginLook();
    const auto event = is_ours && isWaiting() ? link_.look(bell_, &frames_) : Link::Event::kBell;
    if (event == Link::Event::kBytes) {
      readFrames();
    } else if (event == Link::Event::kClosed) {
      end(kClosed);
    } else if (event == Link::Event::kNothing) {
      is_awaited_ = program_.waitsOn();
    } else if (is_ours) {
      bell_.silence();
    }
    goes_on = isWaiting() && is_awaited_;
    program_.endLook();
  }
  if (is_ours && isOver()) {
    finish();
  }
  return is_ours;
}

void Membership::knockIfNeeded() {
  const bool has_input = program_.hasInput();
  const Lock lock(program_);
  if (has_input && !has_knocked_ && state_ == State::kReported) {
    has_knocked_ = true;
    link_.send(wire::encode(wire::ParticipantFrame(wire::Knock{})));
  }
}

void Membership::readFrames() {
  try {
    for (auto frame = frames_.next(); frame && !isOver(); frame = frames_.next()) {
      wire::MasterFrame decoded = wire::decodeFromMaster(*frame);
      std::visit([this](auto& one) { handle(one); }, decoded);
    }
  } catch (const wire::MalformedFrame& error) {
    ROS_ERROR("lockstep: %s got a bad frame from the time master: %s", name().c_str(),
              error.what());
    end("the time master sent a bad frame");
  }
}

void Membership::handle(const wire::Welcome& frame) {
  const Lock lock(program_);
  members_[frame.own_id] = {presence_.name, presence_.uri};
  names_.insert(presence_.name);
  excluded_.insert(frame.excluded_topics.begin(), frame.excluded_topics.end());
  constexpr Nanoseconds kMillisecond = kNanosecondsPerSecond / 1000;
  leave_limit_ms_ = static_cast<int>(
      std::min<Nanoseconds>(frame.leave_limit_ns / kMillisecond, std::numeric_limits<int>::max()));
  silence_.begin(
      frame.busy_limit_ns, [this] { return grantedRound(); },
      [this](std::uint64_t round) { tellBusy(round); });
}

/** @return the round that is being worked on; 0: none. Any thread may call this. */
std::uint64_t Membership::grantedRound() {
  const Lock lock(program_);
  return state_ == State::kTurn ? round_ : 0;
}

std::string Membership::describe(int thread) { return describeBriefly(thread); }

void Membership::tellBusy(std::uint64_t round) {
  const int thread = program_.busyThread();
  const std::string where = describeThread(thread == 0 ? reader_.load() : thread);
  const Lock lock(program_);
  if (state_ == State::kTurn && round_ == round) {
    link_.send(wire::encode(wire::ParticipantFrame(wire::Busy{round, where})));
  }
}

void Membership::handle(const wire::Member& frame) {
  const std::string name(frame.name);
  {
    const Lock lock(program_);
    members_[frame.id] = {name, std::string(frame.node_uri)};
    names_.insert(name);
    gone_.erase(name);
  }
  program_.onMember(name);
}

void Membership::handle(const wire::Gone& frame) {
  const Lock lock(program_);
  const auto found = members_.find(frame.id);
  if (found != members_.end()) {
    names_.erase(names_.find(found->second.name));
    if (names_.count(found->second.name) == 0) {
      gone_.insert(found->second.name);
    }
    members_.erase(found);
  }
}

void Membership::handle(wire::Grant& grant) {
  const bool has_window = window_.take(&grant);
  {
    const Lock lock(program_);
    if (isOver()) {
      return;  // another thread has left
    }
    round_ = grant.round;
    told_at_ = grant.time_ns;
  }
  const bool is_repeated = has_window && grant.time_ns == now_;
  beginTurn(grant, grant.time_ns, is_repeated ? microstep_ + 1 : grant.microstep);
  delay_.begin();
}

/** @brief Begin a turn with the mail that was kept for @p now and the items of @p grant. */
void Membership::beginTurn(const wire::Grant& grant, Nanoseconds now, std::uint32_t microstep) {
  const std::string kept = window_.arrived(now);
  const auto first =
      kept.empty() ? wire::Grant() : std::get<wire::Grant>(wire::decodeFromMaster(kept));
  {
    const Lock lock(program_);
    now_ = came_ = now;
    microstep_ = microstep;
    ++turns_;
    is_plain_ = first.items.empty() && isEmpty(grant) && !has_knocked_;
    has_knocked_ = false;
    reader_ = ownThread();
    state_ = State::kTurn;
  }
  program_.setTime(now_);
  for (const auto* items : {&first.items, &grant.items}) {
    for (const wire::GrantItem& item : *items) {
      std::visit([this](const auto& decoded) { take(decoded); }, item);
    }
  }
  program_.onGranted();
}

void Membership::handle(const wire::End& frame) { end(std::string(frame.reason), frame.as_wished); }

// ---- the next report ---------------------------------------------------------------------

void Membership::append(const wire::ReportItem& item) {
  const Lock lock(program_);
  if (isOver()) {
    return;
  }
  if (std::holds_alternative<wire::Background>(item)) {
    is_background_ = true;  // in the next report, whichever that is
    return;
  }
  must_report_ = must_report_ || std::holds_alternative<wire::Rest>(item) ||
                 std::holds_alternative<wire::Parameter>(item);
  wire::append(items_, item);
}

void Membership::label(const std::string& reason) {
  const Lock lock(program_);
  if (!isOver() && labels_.insert(reason).second) {
    wire::append(items_, wire::Note{wire::NoteKind::kNotRepeatable, reason});
  }
}

// ---- calls -----------------------------------------------------------------------------------

std::uint32_t Membership::call(const std::string& service, std::string_view request) {
  append(wire::Call{++calls_made_, 0, service, request});
  return calls_made_;
}

void Membership::take(const wire::Answer& item) {
  answers_[item.number] = {item.status, std::string(item.bytes)};
}

void Membership::watch(const std::string& service) {
  found_.erase(service);
  append(wire::Watch{service});
}

void Membership::take(const wire::Found& item) { found_.insert(std::string(item.service)); }

// ---- the members -----------------------------------------------------------------------------

bool Membership::isMember(const std::string& name) {
  const Lock lock(program_);
  return names_.count(name) > 0;
}

std::set<std::string> Membership::present() {
  const Lock lock(program_);
  return {names_.begin(), names_.end()};
}

std::set<std::string> Membership::gone() {
  const Lock lock(program_);
  return gone_;
}

bool Membership::isMemberAt(const std::string& uri) {
  const Lock lock(program_);
  return std::any_of(members_.begin(), members_.end(),
                     [&uri](const auto& member) { return member.second.uri == uri; });
}

Membership::Other Membership::memberOf(std::uint32_t number) {
  const Lock lock(program_);
  const auto found = members_.find(number);
  return found == members_.end() ? Other() : found->second;
}

}  // namespace move_base_abstract::lockstep::internal
