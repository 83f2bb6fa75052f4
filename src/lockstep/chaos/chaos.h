// Chaos: another legal order of equal events, and delays, as a seed says. No ROS, no sockets.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "decisions.h"
#include "lockstep/rounds/rounds.h"
#include "lockstep/routing/carrier.h"

namespace move_base_abstract::chaos {

/** @brief The names of nodes and topics, for the texts and the draws of decisions. */
struct Names {
  std::function<std::string(MemberId)> node;
  std::function<std::string(MemberId, std::uint32_t)> topic;  // by the member's own number
};

/**
 * @brief Arranges mail and turns that are equal in the stated order.
 *
 * In the mail of one grant, items of one connection (a sender's topic, a client's calls) keep their
 * order, and news of connections stays where it is. In one round, the order of the turns decides
 * whose topics, services and parameters take effect first.
 */
class Order {
 public:
  Order(Decisions& decisions, const LockstepRounds& rounds, Names names)
      : decisions_(decisions), rounds_(rounds), names_(std::move(names)) {}

  /** @param matters says whether the place of a member's turn has an effect. */
  void arrangeTurns(std::vector<MemberId>& ids, const std::function<bool(MemberId)>& matters);
  /**
   * @param mail in the order in which it was posted; on return, in the order in which it is to be
   * handled.
   */
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
