// Who takes part in rounds: what is known of each, who wakes up next, in which order they come.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_MEMBERS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_MEMBERS_H

#include <cstddef>
#include <cstdint>
#include <deque>
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

/** @brief Whether mail is kept for the next grant that there is anyway (mail.cpp). */
enum class Keep {
  kNot,     // it is a reason for a grant
  kLater,   // hardly one: the receiver only puts it by
  kUnread,  // none before the receiver's wake-up, when it looks at what has come
  kStored   // the user says that it is hardly one
};

/** @brief Something to hand over with a receiver's next grant. */
struct Mail {
  MailOrder order;
  wire::GrantItem item;  // its texts and bytes are kept alive by whoever posted it
  Keep keep = Keep::kNot;
};

/** @brief What is handed over with a receiver's next grant, and is hardly a reason for one. */
struct LaterMail {
  std::uint64_t round = 0;  // in which it was posted
  MailOrder order;
  std::string bytes;     // the item, written out: it may stay for many rounds
  Nanoseconds came = 0;  // simulated, of what is unread; 0: nobody asks
};

/** @brief What a member is handed at an instant of its own, with a lookahead. */
struct Arrival {
  Nanoseconds at;
  std::string bytes;  // items, written out, in their order
};

/** @brief What is known of a member. */
struct MemberState {
  std::string name;
  std::int32_t rank = 0;
  Nanoseconds next = kNever;    // simulated
  std::uint32_t open = 0;       // application threads that wait without end for what is owed
  std::uint32_t idle = 0;       // those that wait without end for work that may come
  bool waits_for_work = false;  // it is declared: what it waits for is not owed to it
  bool knocked = false;
  bool present = true;  // false: it has gone, which counts when the round is over
  bool owes = false;    // the report of round `round`
  bool silence_told = false;
  std::uint64_t round = 0;       // of its latest grant
  Nanoseconds granted_wall = 0;  // of its latest grant
  std::uint32_t granted_mail = 0;
  bool granted_due = false;  // its wake-up was due with its latest grant
  std::vector<Mail> mail;
  std::vector<LaterMail> later;           // ahead of the mail
  std::size_t later_bytes = 0;            // of what is unread or stored in it
  Nanoseconds keep_until = kNever;        // what is unread is a reason for a grant from then on
  bool ready = false;                     // is among those that are ready
  bool resting = false;                   // is among those that rest
  bool background = false;                // its wake-up alone is no reason for time to go on
  std::deque<Nanoseconds> foreseen;       // turns that its latest report told, still to come
  Nanoseconds after_foreseen = kNever;    // its wake-up after these
  std::optional<std::uint32_t> happened;  // of these; nothing if it told none
  // With a lookahead:
  std::deque<Arrival> arrivals;  // that it has not been told, the earliest first
  Nanoseconds latest = 0;        // instant of the latest turn that is known of it
  Nanoseconds window_end = 0;    // it may go on by itself before that
  Nanoseconds held_until = 0;    // not granted before all have come to this
};

/** @brief The members of a run. */
class RoundMembers {
 public:
  using Map = std::map<MemberId, MemberState>;

  const Map& all() const { return members_; }
  MemberState& at(MemberId id) { return members_.at(id); }
  /** @return null for one that is not there. */
  MemberState* find(MemberId id) {
    const auto found = members_.find(id);
    return found == members_.end() ? nullptr : &found->second;
  }
  const MemberState* find(MemberId id) const {
    const auto found = members_.find(id);
    return found == members_.end() ? nullptr : &found->second;
  }
  MemberState& add(MemberId id, const std::string& name, std::int32_t rank);
  /** @brief It will not report any more; until remove() it still counts as a receiver. */
  void gone(MemberId id);
  void remove(MemberId id);
  /** @return of @p names, in their order, those that are not there. */
  std::vector<std::string> missing(const std::vector<std::string>& names) const;

  // ---- when they are granted ----
  void setNext(MemberId id, MemberState& member, Nanoseconds next);
  /** @return those that have a finite wake-up, the earliest first. */
  const std::set<std::pair<Nanoseconds, MemberId>>& due() const { return due_; }
  /** @return the earliest reason for time to go on: an arrival from outside, or a wake-up. */
  Nanoseconds nextTime(Nanoseconds arrival) const;
  void makeReady(MemberId id, MemberState& member);
  /** @return with mail, knocked, joined, or due now; some may have been granted since. */
  const std::vector<MemberId>& ready() const { return ready_; }
  /** @brief Forget of those that are ready whoever is not any more. */
  void dropGranted();
  /** @brief Nobody is ready or rests but as its own state says. */
  void forgetLists();
  /** @brief Grant it again when nobody has anything left to do at this instant, unless something
   * else comes before. */
  void rest(MemberId id);
  void wakeResting();
  /** @brief It is granted: a report of it is to come. */
  void expectReport(MemberState& member) {
    ++owing_;
    member.owes = true;
  }
  /** @brief The report of its latest grant is in, or will never be. @pre owes */
  void settle(MemberState& member) {
    member.owes = false;
    --owing_;
  }
  /** @return how many owe a report. */
  std::size_t owing() const { return owing_; }
  void takeForeseen(MemberId id, MemberState& member);

  // ---- what their reports say ----
  /** @brief Time does not go on for the wake-up alone that @p id has reported. */
  void background(MemberId id) { at(id).background = true; }
  /** @brief So many of its threads wait for work that may come: no deadlock
   * while no goal and no call is open. */
  void idle(MemberId id, std::uint32_t threads) { at(id).idle = threads; }
  /** @brief What @p id has not read is a reason for a grant from @p instant on: KEEP_UNTIL. */
  void keepUntil(MemberId id, Nanoseconds instant) { at(id).keep_until = instant; }
  bool areStuck(bool is_owed) const;

  // ---- their order ----
  /** @brief Where an action of @p id comes. A member that joins or leaves moves the others' places:
   * keep none from one decision to the next. */
  MailOrder order(MemberId id, std::uint32_t sub, std::uint64_t number) const;
  /** @brief Put them into their order: by rank, then name. */
  void sort(std::vector<MemberId>& ids) const;

 private:
  Map members_;
  NamePlaces places_;
  std::set<std::pair<Nanoseconds, MemberId>> due_;
  std::vector<MemberId> ready_;
  std::vector<MemberId> resting_;  // for the end of this instant
  std::size_t owing_ = 0;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_MEMBERS_H
