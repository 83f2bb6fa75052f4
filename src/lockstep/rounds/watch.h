// Finds silent members: a granted member whose report takes long in wall time.
#pragma once

#include <vector>

#include "clock/scaled_clock.h"
#include "members.h"

namespace move_base_abstract {

/** @brief Watches over the members of the latest round. Instants are wall instants [ns]. */
class RoundWatch {
 public:
  /** @param limit the time that a report may take [ns, wall]; 0: there is no limit. */
  RoundWatch(RoundMembers& members, Nanoseconds limit) : members_(members), limit_(limit) {}

  /** @brief Begin a round. @return the list to fill with the granted members, in their order. */
  std::vector<MemberId>& begin(Nanoseconds wall);
  const std::vector<MemberId>& granted() const { return granted_; }
  /** @return the instant at which to call look(), or kNever. */
  Nanoseconds nextLook() const { return next_look_; }
  /** @return the silent members, once for each silence. */
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
