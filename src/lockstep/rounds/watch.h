// Who of the granted is silent: a report takes long by the wall clock.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_WATCH_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_WATCH_H

#include <vector>

#include "clock/scaled_clock.h"
#include "members.h"

namespace move_base_abstract {

/** @brief Watches over the members of the latest round. Instants are wall ones [ns]. */
class RoundWatch {
 public:
  /** @param limit of a report [ns]; 0: there is none. */
  RoundWatch(RoundMembers& members, Nanoseconds limit) : members_(members), limit_(limit) {}

  /** @brief A round begins. @return the list for those who are granted, in their order. */
  std::vector<MemberId>& begin(Nanoseconds wall);
  const std::vector<MemberId>& granted() const { return granted_; }
  /** @return when to look, or kNever. */
  Nanoseconds nextLook() const { return next_look_; }
  /** @return those that are silent, once for each silence. */
  std::vector<MemberId> look(Nanoseconds wall);
  /** @return whether a report has been missing for more than a second. */
  bool isLong(Nanoseconds wall) const;

 private:
  RoundMembers& members_;
  const Nanoseconds limit_;
  std::vector<MemberId> granted_;
  Nanoseconds next_look_ = kNever;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_WATCH_H
