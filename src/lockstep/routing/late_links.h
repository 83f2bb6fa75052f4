// Links between participants that are made, and are up later. No ROS, no sockets.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "clock/scaled_clock.h"
#include "lockstep/rounds/order.h"

namespace move_base_abstract {

/** @brief The link of a topic from a publisher to a subscriber. */
struct Link {
  std::uint32_t topic;
  MemberId publisher;
  MemberId subscriber;
  bool operator<(const Link& other) const {
    return std::tie(topic, publisher, subscriber) <
           std::tie(other.topic, other.publisher, other.subscriber);
  }
};

/** @brief A link that is not up yet, and the action that made it. */
struct LateLink {
  Link link;
  MemberId sender;
  std::uint64_t number;
};

/** @brief The links that are not up yet, by the instant at which they are, then as they were made.
 */
class LateLinks {
 public:
  /** @return the instant at which a link that is made now is up [ns, simulated]; 0: at once. */
  using Due = std::function<Nanoseconds(std::string_view publisher, std::string_view subscriber,
                                        std::string_view topic)>;

  void setDue(Due due) { due_ = std::move(due); }
  /** @return the same, for a link that is made now. */
  Nanoseconds dueOf(std::string_view publisher, std::string_view subscriber,
                    std::string_view topic) const {
    return due_ ? due_(publisher, subscriber, topic) : 0;
  }
  void add(Nanoseconds due, const LateLink& late);
  bool has(const Link& link) const { return places_.count(link) > 0; }
  /** @brief Forget a link, which is closed. @return whether it was not up yet. */
  bool forget(const Link& link);
  /** @return the instant at which the next one is up, or kNever. */
  Nanoseconds nextDue() const { return links_.empty() ? kNever : links_.begin()->first.first; }
  /** @return the next one, which is up from now on. @pre there is one */
  LateLink take();

 private:
  using Place = std::pair<Nanoseconds, std::uint64_t>;

  Due due_;
  std::map<Place, LateLink> links_;
  std::map<Link, Place> places_;
  std::uint64_t count_ = 0;
};

}  // namespace move_base_abstract
