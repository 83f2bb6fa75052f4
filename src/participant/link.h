// A participant's socket to the time master, and the bell by which roscpp's thread wakes its
// reader.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_LINK_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_LINK_H

#include <string>
#include <string_view>

#include "lockstep/wire/wire.h"

namespace move_base_abstract::lockstep::internal {

/** @brief Rings in one thread, is heard in a poll of another; any number of rings is one. */
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

/** @brief A blocking TCP connection: bytes out, bytes in. */
class Link {
 public:
  enum class Event { kBytes, kBell, kNothing, kClosed };

  Link() = default;
  ~Link() { close(); }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /**
   * @brief Connect to @p address, "host:port"; on the time master's own computer by a Unix socket.
   * @return whether somebody listens there. @throws Error if it is no address.
   */
  bool connect(const std::string& address);
  bool isOpen() const { return socket_ >= 0; }
  /** @brief From now on a signal that tells the process to end is told to the peer. */
  void announceStopSignals();

  /** @return false if there is nobody to take it. */
  bool send(std::string_view bytes);

  /** @brief Wait for at most @p timeout_ms of wall time; what comes is appended to @p frames. */
  Event wait(const Bell& bell, int timeout_ms, wire::FrameBuffer* frames);

  /** @brief Tell the peer that nothing more comes, wait until it has read all, for at most
   * @p patience_ms of wall time, and close. */
  void finish(int patience_ms);
  void close();

 private:
  bool connectLocally(const std::string& address);

  int socket_ = -1;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_LINK_H
