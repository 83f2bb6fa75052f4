// A participant's socket to the time master, and the bell by which a thread of roscpp wakes the
// thread that reads from it.
#pragma once

#include <poll.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/shared_channel.h"
#include "lockstep/wire/wire.h"

namespace move_base_abstract::lockstep::internal {

/** @brief A node cannot take part. The text names the node or the setting, and what is allowed. */
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

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
  /** @brief Let rings end waits for @p channel, too. It must live as long as this process. */
  void ringFor(SharedChannel* channel) { channel_ = channel; }

 private:
  int descriptor_;
  std::atomic<SharedChannel*> channel_{nullptr};
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
  /** @brief Send what the time master waits for: through the shared memory, if it can be. */
  bool sendAwaited(std::string_view bytes);

  /**
   * @brief Wait until look() may find something, for at most @p timeout_ms of wall time.
   * @param place where the calling thread sleeps, if memory is shared; see SharedChannel::wait().
   */
  void await(Bell& bell, int timeout_ms, Place* place);
  /** @brief Append what has come to @p frames. One thread at a time calls this. */
  Event look(const Bell& bell, wire::FrameBuffer* frames);
  /** @return whether a piece has come through the shared memory. Any thread may call this. */
  bool hasPiece() const { return is_shared_ && channel_->hasPiece(); }
  /** @return the memory that may be shared; null: there is none. */
  SharedChannel* channel() const { return channel_; }

  /**
   * @brief Tell the peer that no more bytes come, wait for at most @p patience_ms of wall time
   * until it has read all, and close.
   */
  void finish(int patience_ms);
  void close();

 private:
  bool connectLocally(const std::string& address);
  void offerSharedMemory(std::string_view* bytes);
  void poll(const Bell& bell, int timeout_ms);
  Event takeFromSocket(wire::FrameBuffer* frames);
  bool takePiece(wire::FrameBuffer* frames);
  Event receive(std::size_t most, wire::FrameBuffer* frames);

  int socket_ = -1;
  // Made with a local connection, and offered with its first bytes. Never freed, as other threads
  // may ring the bell at any time.
  SharedChannel* channel_ = nullptr;
  std::atomic<bool> is_shared_{false};  // the time master uses the channel, too
  int offered_file_ = -1;
  std::uint64_t sent_ = 0;            // bytes over the socket, without STOPPING of a signal
  std::uint64_t signals_before_ = 0;  // bytes of signals over earlier connections
  std::uint64_t received_ = 0;
  bool has_more_ = false;           // there may be more in the socket than the last look has taken
  std::array<pollfd, 2> polled_{};  // the socket and the bell
};

}  // namespace move_base_abstract::lockstep::internal
