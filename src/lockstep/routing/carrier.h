// Who says how long a message is under way, and whether it arrives. No ROS, no sockets.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUTING_CARRIER_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUTING_CARRIER_H

#include <cstddef>
#include <string_view>

#include "clock/scaled_clock.h"
#include "lockstep/rounds/order.h"

namespace move_base_abstract {

/** @brief A message, call or response that has found a receiver. Its texts are good for the call.
 */
struct Passage {
  enum class Kind { kMessage, kCall, kResponse };
  Kind kind;
  MemberId sender;
  MemberId receiver;
  std::string_view sender_name;  // of the nodes
  std::string_view receiver_name;
  std::string_view name;  // of the topic or service
  std::string_view type;  // of a message
  std::size_t size;       // bytes, serialized
  bool is_latched;        // of a message: its publisher latches
  Nanoseconds from = 0;   // simulated; when it sets out
};

/** @brief What becomes of it. */
struct Carried {
  /** Simulated; not before Passage::from, which is at once. Of what is lost: when that is noticed,
   * by the caller of a service; nobody notices that a message is lost. */
  Nanoseconds due;
  std::string_view lost = {};  // why it does not arrive; '' if it does. A text that stays
};

/**
 * @brief Asked once for each passage, in the order in which messages are sent.
 *
 * The instants of one link (sender, receiver, topic; a service's calls, its responses) must never
 * go back: what was sent before must not arrive after what is sent later. What sets out from
 * another carrier does so at instants that do not go back either.
 */
class Carrier {
 public:
  virtual ~Carrier() = default;
  virtual Carried carry(const Passage& passage) = 0;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUTING_CARRIER_H
