// Mail under way, which arrives at a later instant. No ROS, no sockets.
#pragma once

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

/** @brief A message, call or answer under way, with all data that is needed when it arrives. */
struct Held {
  Passage::Kind kind;
  MemberId sender;
  MemberId receiver;
  std::uint64_t number;                      // of the action, among all those of its sender
  std::string_view name;                     // of the topic or service; a text that is never freed
  std::string_view type;                     // of a message; a text that is never freed
  std::string sender_name;                   // the sender may have gone when this arrives
  std::shared_ptr<const std::string> bytes;  // that `item` points into
  wire::GrantItem item;
  std::uint64_t ticket = 0;  // see Carried
};

/**
 * @brief The mail under way, by the instant of its arrival, then in the order in which it was sent.
 */
class HeldMail {
 public:
  void add(Nanoseconds due, Held held);
  /** @return the instant of the next arrival, or kNever. */
  Nanoseconds nextDue() const { return mail_.empty() ? kNever : mail_.begin()->first.first; }
  /** @return the mail that arrives up to and including @p now, in order, and stop holding it. */
  std::vector<Held> take(Nanoseconds now);
  /**
   * @return the mail that waits with this ticket, and stop holding it; nothing if it was dropped.
   */
  std::optional<Held> takeWaiting(std::uint64_t ticket);
  /** @return the mail for which @p is_meant is true, in order, and stop holding it. */
  std::vector<Held> drop(const std::function<bool(const Held&)>& is_meant);
  /** @return whether mail is under way to a member other than @p id. */
  bool hasForOthers(MemberId id) const;
  bool empty() const { return mail_.empty(); }

 private:
  std::map<std::pair<Nanoseconds, std::uint64_t>, Held> mail_;              // by instant and count
  std::map<std::uint64_t, std::pair<Nanoseconds, std::uint64_t>> waiting_;  // by ticket
  std::uint64_t count_ = 0;
};

/** @brief The carriers, one after the other, and their mail under way. */
class Carriage {
 public:
  using Now = std::function<Nanoseconds()>;

  /**
   * @param lookahead the least time that everything takes [ns, simulated]; 0: there are no windows.
   */
  explicit Carriage(Now now, Nanoseconds lookahead = 0)
      : now_(std::move(now)), lookahead_(lookahead) {}
  void add(std::unique_ptr<Carrier> carrier) { carriers_.push_back(std::move(carrier)); }

  /** @return the outcome of all carriers together. `passage.from` is not read. */
  Carried carry(Passage passage) const;
  /** @return whether mail that is due at @p due arrives later than other mail that is sent now. */
  bool isLater(Nanoseconds due) const { return due > addSaturated(now_(), lookahead_); }
  /** @return the instant at which to call arrive(), or kNever. */
  Nanoseconds nextArrival() const {
    const Nanoseconds due = held.nextDue();
    return due == kNever ? kNever : due - lookahead_;
  }
  /**
   * @return the held mail that arrives together with mail that is sent now, in order. Its bytes are
   * kept until forgetArrived().
   */
  std::vector<Held> arrive();
  void forgetArrived() { arrived_.clear(); }

  HeldMail held;

 private:
  Now now_;
  const Nanoseconds lookahead_;
  std::vector<std::unique_ptr<Carrier>> carriers_;
  std::vector<std::shared_ptr<const std::string>> arrived_;  // posted mail points into them
};

}  // namespace move_base_abstract
