// The connections of a session: received bytes, which come in pieces, and bytes to be sent. No
// sockets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clock/scaled_clock.h"
#include "lockstep/rounds/order.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract {

/** @brief A connection's number, chosen by the caller and never reused. */
using ConnectionId = std::uint64_t;

/** @brief The bytes that a connection is to be sent. */
struct ConnectionOutput {
  ConnectionId connection;
  std::string bytes;
  bool close;                          // after the bytes are sent; the connection is then forgotten
  std::optional<std::uint32_t> topic;  // see Connections::send()
};

/** @brief A connection, as far as a session knows it. */
struct Connection {
  wire::FrameBuffer buffer;
  MemberId member = 0;  // 0: no HELLO yet
  std::string out;
  bool close = false;
  std::optional<std::uint32_t> topic;
  bool listed = false;  // has something to be sent
};

/**
 * @brief All connections, the bytes to send to each, and the limit of time for a new connection to
 * say HELLO.
 */
class Connections {
 public:
  static constexpr Nanoseconds kHelloLimit = 10 * kNanosecondsPerSecond;  // wall

  /** @param hello_due the wall instant [ns] by which the connection must have said HELLO. */
  void add(ConnectionId id, Nanoseconds hello_due);
  /** @brief Forget a connection that is lost. @return the member that it belonged to; 0: none. */
  MemberId remove(ConnectionId id);
  /** @brief Note that the connection has said HELLO, as @p member. */
  void greeted(ConnectionId id, MemberId member);

  /** @return the connection, unless it is unknown or about to be closed. */
  Connection* open(ConnectionId id);
  /** @return the member that the connection belongs to; 0: none, or the connection is unknown. */
  MemberId memberOf(ConnectionId id) const;
  bool contains(ConnectionId id) const { return connections_.count(id) != 0; }

  /**
   * @param topic for a grant: the participant's number of the topic of its first message; 0: it has
   * no mail. By it a thread of the participant is woken.
   */
  void send(ConnectionId id, std::string_view bytes, std::optional<std::uint32_t> topic = {});
  /** @brief Send END with @p reason, then close the connection. */
  void close(ConnectionId id, const std::string& reason, bool as_wished = false);
  void closeAll(const std::string& reason, bool as_wished);
  /** @return the bytes to send since the last call, one entry per connection. */
  std::vector<ConnectionOutput> flush();

  /** @return the number of connections that have not said HELLO yet. */
  std::size_t strangers() const { return hello_due_.size(); }
  /** @return a connection that should have said HELLO by @p wall [ns]; 0: there is none. */
  ConnectionId silentStranger(Nanoseconds wall) const;
  /**
   * @return the wall instant [ns] by which the next new connection must have said HELLO, or kNever.
   */
  Nanoseconds helloDue() const { return hello_due_.empty() ? kNever : hello_due_.begin()->second; }
  bool hasOutput() const { return !outgoing_.empty(); }

 private:
  std::map<ConnectionId, Connection> connections_;
  std::map<ConnectionId, Nanoseconds> hello_due_;  // wall; in the order of connecting
  std::vector<ConnectionId> outgoing_;
};

}  // namespace move_base_abstract
