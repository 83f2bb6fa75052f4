// Carriers, which decide how long a message is under way, and whether it arrives. No ROS, no
// sockets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "clock/scaled_clock.h"
#include "lockstep/rounds/order.h"

namespace move_base_abstract {

/**
 * @brief A message, call or response that has a receiver. Its texts are valid during the call of
 * carry().
 */
struct Passage {
  enum class Kind { kMessage, kCall, kResponse };
  Kind kind;
  MemberId sender;
  MemberId receiver;
  std::string_view sender_name;  // the nodes' names
  std::string_view receiver_name;
  std::string_view name;           // of the topic or service
  std::string_view type;           // of a message
  std::size_t size;                // bytes, serialized
  bool is_latched;                 // for a message: whether its publisher latches
  MailOrder order = {};            // of its sending; `sub` is the sender's robot
  std::uint32_t receiver_sub = 0;  // the receiver's robot, if it is a fleet
  Nanoseconds from = 0;            // simulated; when it sets out
};

/** @brief The outcome of a passage. */
struct Carried {
  /**
   * Simulated, not before Passage::from; equal to it means at once. For a lost call or response:
   * when the caller of the service notices that. Nobody notices that a message is lost.
   */
  Nanoseconds due;
  std::string_view lost = {};  // why it is lost, as a static text; '' if it arrives
  /**
   * Not 0: it waits, and `due` is kNever. MessageRouter::decide() gets the outcome later, with this
   * number. The carriers after this one are not asked.
   */
  std::uint64_t ticket = 0;
};

/**
 * @brief Decides on each passage once, in the order in which messages are sent.
 *
 * The instants of one link (sender, receiver, topic; a service's calls, its responses) must never
 * go back: an earlier message must not arrive after a later one. If another carrier comes first,
 * its instants are Passage::from; they do not go back either.
 */
class Carrier {
 public:
  virtual ~Carrier() = default;
  virtual Carried carry(const Passage& passage) = 0;
};

}  // namespace move_base_abstract
