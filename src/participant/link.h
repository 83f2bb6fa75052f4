// A participant's socket to the time master, and the bell by which a thread of roscpp wakes the
// thread that reads from it.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_LINK_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_LINK_H

#include <string>
#include <string_view>

#include "lockstep/wire/wire.h"

namespace move_base_abstract::lockstep::internal {

/**
 * @brief An event from one thread that wakes a poll in another. Several rings before silence()
 * count as one.
 */
class Bell {
 public:
  Bell();
  ~Bell();
  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;

  void ring();
  void silence();
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/** @brief A blocking connection that sends and receives bytes. */
class Link {
 public:
  enum class Event { kBytes, kBell, kNothing, kClosed };

  Link() = default;
  ~Link() { close(); }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /**
   * @brief Connect to @p address, "host:port"; on the time master's own computer by a Unix socket.
   * @return whether the connection was accepted.
   * @throws Error if @p address is not valid.
   */
  bool connect(const std::string& address);
  bool isOpen() const { return socket_ >= 0; }
  /** @brief From now on, tell the peer when a signal tells this process to end. */
  void announceStopSignals();

  /** @return false if the peer has gone. */
  bool send(std::string_view bytes);

  /** @brief Wait for at most @p timeout_ms of wall time. Append the received bytes to @p frames. */
  Event wait(const Bell& bell, int timeout_ms, wire::FrameBuffer* frames);

  /**
   * @brief Tell the peer that no more bytes come, wait for at most @p patience_ms of wall time
   * until it has read all, and close.
   */
  void finish(int patience_ms);
  void close();

 private:
  bool connectLocally(const std::string& address);

  int socket_ = -1;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_LINK_H
