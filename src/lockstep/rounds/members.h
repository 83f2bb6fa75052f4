// The members of the rounds: the state of each, the next wake-up, and their order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "lockstep/wire/wire.h"
#include "order.h"
#include "round_clock.h"

namespace move_base_abstract {

/** @brief Whether mail is kept until its receiver is granted for another reason (mail.cpp). */
enum class Keep {
  kNot,     // the mail is a reason for a grant
  kLater,   // hardly a reason: the receiver only stores it
  kUnread,  // no reason before the receiver's wake-up, when it reads its mail
  kStored   // hardly a reason, as the user says
};

/** @brief An item to hand over with a receiver's next grant. */
struct Mail {
  MailOrder order;
  wire::GrantItem item;  // the caller that posts it keeps its texts and bytes alive
  Keep keep = Keep::kNot;
};

/**
 * @brief An item that is handed over with a receiver's next grant, and is hardly a reason for one.
 */
struct LaterMail {
  std::uint64_t round = 0;  // in which it was posted
  MailOrder order;
  std::string bytes;     // the encoded item, since it may stay for many rounds
  Nanoseconds came = 0;  // simulated, for unread mail; 0: it does not matter
};

/** @brief Mail that a member gets at an instant within its window, with a lookahead. */
struct Arrival {
  Nanoseconds at;
  std::string bytes;      // encoded items, in their order
  bool has_news = false;  // a message, call or answer
};

/** @brief The state of a member. */
struct MemberState {
  std::string name;
  std::int32_t rank = 0;
  Nanoseconds next = kNever;    // simulated
  std::uint32_t open = 0;       // threads that wait without a timeout for something owed to them
  std::uint32_t idle = 0;       // threads that wait without a timeout for work
  bool waits_for_work = false;  // declared: nothing that it waits for is owed to it
  bool knocked = false;
  bool present = true;  // false: it has gone, and is removed when the round is over
  bool owes = false;    // it has not sent the report of round `round`
  bool silence_told = false;
  std::uint64_t round = 0;       // of its latest grant
  Nanoseconds granted_wall = 0;  // of its latest grant
  std::uint32_t granted_mail = 0;
  bool granted_due = false;  // whether its wake-up was due at its latest grant
  std::vector<Mail> mail;
  std::vector<LaterMail> later;         // handled before the mail
  std::size_t later_bytes = 0;          // of the unread and stored mail in `later`
  Nanoseconds keep_until = kNever;      // from then on unread mail is a reason for a grant
  bool ready = false;                   // whether it is in the list of ready members
  bool resting = false;                 // whether it is in the list of resting members
  bool background = false;              // whether time does not go on for its wake-up alone
  Nanoseconds played = kNever;          // its next turn that is played
  Nanoseconds after_played = kNever;    // its wake-up after those
  std::optional<Nanoseconds> happened;  // the latest one; nothing: none are played
  // With a lookahead:
  std::deque<Arrival> arrivals;  // not handed over yet, the earliest first
  Nanoseconds latest = 0;        // instant of its latest known turn
  Nanoseconds window_end = 0;    // it may go on by itself before this instant
  Nanoseconds held_until = 0;    // not granted before all members have come to this instant
};

/** @brief The members of a run. */
class RoundMembers {
 public:
  using Map = std::map<MemberId, MemberState>;

  const Map& all() const { return members_; }
  MemberState& at(MemberId id) { return members_.at(id); }
  /** @return the member's state; null if it is not there. */
  MemberState* find(MemberId id) {
    const auto found = members_.find(id);
    return found == members_.end() ? nullptr : &found->second;
  }
  const MemberState* find(MemberId id) const {
    const auto found = members_.find(id);
    return found == members_.end() ? nullptr : &found->second;
  }
  MemberState& add(MemberId id, const std::string& name, std::int32_t rank);
  /**
   * @brief Note that the member will not report any more. Until remove() it still counts as a
   * receiver.
   */
  void gone(MemberId id);
  void remove(MemberId id);
  /** @return those of @p names that are not there, in their order. */
  std::vector<std::string> missing(const std::vector<std::string>& names) const;

  // ---- when members are granted ----
  /** @brief Let members begin later than time: @p lateness gives by how much [ns, simulated]. */
  void setLateness(std::function<Nanoseconds(const MemberState& member)> lateness) {
    lateness_ = std::move(lateness);
  }
  /** @brief Begin at @p now, the start of time. @return the members that are ready. */
  std::vector<MemberId> begin(Nanoseconds now);
  /** @return whether a member has not begun yet. */
  bool isAnyToBegin() const;
  void setNext(MemberId id, MemberState& member, Nanoseconds next);
  /** @return the members that have a wake-up, the earliest first. */
  const std::set<std::pair<Nanoseconds, MemberId>>& due() const { return due_; }
  /** @return the earliest reason for time to go on: an arrival from outside, or a wake-up. */
  Nanoseconds nextTime(Nanoseconds arrival) const;
  void makeReady(MemberId id, MemberState& member);
  /**
   * @return the members that have mail, have knocked or joined, or are due now. Some may have been
   * granted since.
   */
  const std::vector<MemberId>& ready() const { return ready_; }
  /** @brief Drop the members from the ready list that are not ready any more. */
  void dropGranted();
  /** @brief Clear the lists of ready and resting members; the states of the members stay. */
  void forgetLists();
  /**
   * @brief Grant the member again when no member has anything left to do at this instant, unless it
   * is granted before.
   */
  void rest(MemberId id);
  void wakeResting();
  /** @brief Note that the member is granted and owes a report. */
  void expectReport(MemberState& member) {
    ++owing_;
    member.owes = true;
  }
  /**
   * @brief Note that the report of the member's latest grant is in, or will never come. @pre owes
   */
  void settle(MemberState& member) {
    member.owes = false;
    --owing_;
  }
  /** @return the number of members that owe a report. */
  std::size_t owing() const { return owing_; }
  /**
   * @brief Note that the next turn that is played for @p id is at @p next, unless it is to have a
   * turn of its own before.
   */
  void playNext(MemberId id, Nanoseconds next);

  // ---- from the reports of members ----
  /** @brief Note that time does not go on only for the wake-up that @p id has reported. */
  void background(MemberId id) { at(id).background = true; }
  /**
   * @brief Set the number of threads of @p id that wait for work. They are no deadlock while no
   * goal and no call is open.
   */
  void idle(MemberId id, std::uint32_t threads) { at(id).idle = threads; }
  /** @brief Make unread mail of @p id a reason for a grant from @p instant on: KEEP_UNTIL. */
  void keepUntil(MemberId id, Nanoseconds instant) { at(id).keep_until = instant; }
  bool areStuck(bool is_owed) const;

  // ---- the order of members ----
  /**
   * @brief The place of an action of @p id in the stated order. A member that joins or leaves
   * changes the places of others, so do not keep a place from one decision to the next.
   */
  MailOrder order(MemberId id, std::uint32_t sub, std::uint64_t number) const;
  /** @brief Sort members by rank, then by name. */
  void sort(std::vector<MemberId>& ids) const;

 private:
  Map members_;
  std::function<Nanoseconds(const MemberState& member)> lateness_;  // null: none is late
  NamePlaces places_;
  std::set<std::pair<Nanoseconds, MemberId>> due_;
  std::vector<MemberId> ready_;
  std::vector<MemberId> resting_;  // until the end of this instant
  std::size_t owing_ = 0;
};

}  // namespace move_base_abstract
