// Mail that is under way: it arrives at a later instant. No ROS, no sockets.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUTING_HELD_MAIL_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUTING_HELD_MAIL_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "carrier.h"
#include "clock/scaled_clock.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract {

/** @brief A message, call or answer under way, with all that is needed when it arrives. */
struct Held {
  Passage::Kind kind;
  MemberId sender;
  MemberId receiver;
  std::uint64_t number;                      // of the action, among all those of its sender
  std::string_view name;                     // of the topic or service; kept for good
  std::string_view type;                     // of a message; kept for good
  std::string sender_name;                   // it may have gone when this arrives
  std::shared_ptr<const std::string> bytes;  // that `item` points into
  wire::GrantItem item;
  std::uint64_t ticket = 0;  // of Carried
};

/** @brief What is under way, by the instant at which it arrives, then as it was sent. */
class HeldMail {
 public:
  void add(Nanoseconds due, Held held);
  /** @return the instant of the next arrival, or kNever. */
  Nanoseconds nextDue() const { return mail_.empty() ? kNever : mail_.begin()->first.first; }
  /** @return what arrives until @p now, itself included, in its order; it is not held any more. */
  std::vector<Held> take(Nanoseconds now);
  /** @return what waits with this ticket, which it does not any more; nothing: it has been dropped.
   */
  std::optional<Held> takeWaiting(std::uint64_t ticket);
  /** @return what @p is_meant says, in its order; it is not held any more. */
  std::vector<Held> drop(const std::function<bool(const Held&)>& is_meant);
  /** @return whether anything is under way to anybody but @p id. */
  bool hasForOthers(MemberId id) const;
  bool empty() const { return mail_.empty(); }

 private:
  std::map<std::pair<Nanoseconds, std::uint64_t>, Held> mail_;              // by instant and count
  std::map<std::uint64_t, std::pair<Nanoseconds, std::uint64_t>> waiting_;  // by ticket
  std::uint64_t count_ = 0;
};

/** @brief Those who carry, one after the other, and what they have under way. */
class Carriage {
 public:
  using Now = std::function<Nanoseconds()>;

  /** @param lookahead what everything takes at least [ns, simulated]: windows; 0: there are none.
   */
  explicit Carriage(Now now, Nanoseconds lookahead = 0)
      : now_(std::move(now)), lookahead_(lookahead) {}
  void add(std::unique_ptr<Carrier> carrier) { carriers_.push_back(std::move(carrier)); }
  /** @return whether nobody carries: all arrives at once. */
  bool isNone() const { return carriers_.empty(); }

  /** @return what becomes of it, of all carriers; `from` is not looked at. */
  Carried carry(Passage passage) const;
  /** @return whether what is due then is still under way when all else that is sent now is there.
   */
  bool isLater(Nanoseconds due) const { return due > addSaturated(now_(), lookahead_); }
  /** @return the instant at which to call arrive(), or kNever. */
  Nanoseconds nextArrival() const {
    const Nanoseconds due = held.nextDue();
    return due == kNever ? kNever : due - lookahead_;
  }
  /** @return what arrives with what is sent now, in its order; its bytes live until
   * forgetArrived(). */
  std::vector<Held> arrive();
  void forgetArrived() { arrived_.clear(); }

  HeldMail held;

 private:
  Now now_;
  const Nanoseconds lookahead_;
  std::vector<std::unique_ptr<Carrier>> carriers_;
  std::vector<std::shared_ptr<const std::string>> arrived_;  // mail points into them
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUTING_HELD_MAIL_H
