// Finds when links come up and go down, to the nanosecond, whether anything is sent or not.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "hosts.h"

namespace move_base_abstract::radio {

/**
 * @brief The links between all known hosts, and when a message may get through.
 *
 * While a host moves, its links are looked at every kLookPeriod. If a link has changed, the instant
 * is found by bisection. A link that comes up and goes down again between two looks is not noticed.
 */
class LinkWatch {
 public:
  struct Change {
    Nanoseconds at;  // simulated
    HostId one, other;
    bool is_up;
  };

  explicit LinkWatch(const Hosts& hosts) : hosts_(hosts) {}

  /** @return whether the link is up, as of the latest look; false if there is no link. */
  bool isUp(HostId one, HostId other) const;
  /** @brief Look at all links of new hosts, as of @p now. */
  void meet(Nanoseconds now);
  /**
   * @brief A host moves in another way from @p now on. @pre advance(now) was called before the
   * change
   */
  void moved(HostId host, Nanoseconds now);
  /** @return the next instant at which a link may change or has to be looked at. */
  Nanoseconds next() const { return due_.empty() ? kNever : due_.begin()->first; }
  /** @brief Find what has changed up to @p now. */
  void advance(Nanoseconds now);
  /** @return the changes since the last call, by instant. */
  std::vector<Change> take();

 private:
  using Pair = std::pair<HostId, HostId>;  // the smaller number first
  struct Link {
    const LinkRule* rule;
    bool is_up = false;
    Nanoseconds due = kNever;
    bool changes = false;  // at `due`; else the search goes on there
  };

  bool upAt(const Pair& pair, const Link& link, Nanoseconds now) const;
  void search(const Pair& pair, Link& link, Nanoseconds from);
  Nanoseconds changeBetween(const Pair& pair, const Link& link, Nanoseconds before,
                            Nanoseconds after) const;
  void setDue(const Pair& pair, Link& link, Nanoseconds due, bool changes);
  void change(const Pair& pair, Link& link, Nanoseconds at);

  const Hosts& hosts_;
  HostId met_ = 0;
  std::map<Pair, Link> links_;
  std::set<std::pair<Nanoseconds, Pair>> due_;
  std::vector<Change> changes_;
};

}  // namespace move_base_abstract::radio
