// Another legal order of equal events, and delays, as a seed says. No ROS, no sockets.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_CHAOS_CHAOS_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_CHAOS_CHAOS_H

#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "decisions.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep/routing/carrier.h"

namespace move_base_abstract::chaos {

/** @brief What decisions are said in, and by: names of nodes and topics. */
struct Names {
  std::function<std::string(MemberId)> node;
  std::function<std::string(MemberId, std::uint32_t)> topic;  // by the member's own number
};

/**
 * @brief Arranges what is equal in the stated order.
 *
 * The mail of one grant: what has come over one connection (a sender's topic, a client's calls)
 * keeps its order, and what is told of links stays where it is. The turns of one round: whose
 * topics, services and parameters come about first.
 */
class Order {
 public:
  Order(Decisions& decisions, const LockstepRounds& rounds, Names names)
      : decisions_(decisions), rounds_(rounds), names_(std::move(names)) {}

  /** @param matters whether it counts when the turn of a member comes about. */
  void arrangeTurns(std::vector<MemberId>& ids, const std::function<bool(MemberId)>& matters);
  /** @param mail as it was posted; then as it is to be handled. */
  void arrangeMail(MemberId receiver, std::vector<Mail>& mail);

 private:
  void placeMail(MemberId receiver, std::vector<Mail>& placed, const Mail& mail);
  std::string said(MemberId receiver, const Mail& mail) const;
  std::uint64_t linkOf(MemberId receiver, const Mail& mail) const;

  Decisions& decisions_;
  const LockstepRounds& rounds_;
  Names names_;
  bool are_turns_moved_ = false;  // in this round
};

/** @brief Delays of messages, calls and responses from one node to another, up to a bound. */
class Delays : public Carrier {
 public:
  /** @param most ns, simulated. */
  Delays(Decisions& decisions, Nanoseconds most) : decisions_(decisions), most_(most) {}
  Carried carry(const Passage& passage) override;

 private:
  Decisions& decisions_;
  const Nanoseconds most_;
  std::unordered_map<std::uint64_t, Nanoseconds> last_;  // arrival of each link; never iterated
};

}  // namespace move_base_abstract::chaos

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_CHAOS_CHAOS_H
