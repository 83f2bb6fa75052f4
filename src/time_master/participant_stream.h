// The stream of bytes to and from one participant: its socket, and the memory that it shares. No
// ROS.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/shared_channel.h"
#include "descriptor.h"

namespace move_base_abstract {

class ParticipantStream {
 public:
  /** kAll: everything that there was; kMore: there may be more; kGone: the other side has closed.
   */
  enum class Received { kAll, kMore, kGone };

  ParticipantStream() = default;
  explicit ParticipantStream(Descriptor socket) : socket_(std::move(socket)) {}

  const Descriptor& socket() const { return socket_; }
  /**
   * @brief Take no more offers of memory. From now on, use the memory that was offered, if @p
   * is_used and it is good.
   */
  void endOffer(bool is_used);

  // ---- receiving
  /** @brief Call @p pass with what has come. @p buffer is for the bytes of the socket. */
  Received receive(std::vector<char>* buffer, const std::function<void(std::string_view)>& pass);
  /**
   * @brief Wait until something has come, for at most @p patience_ms of wall time.
   * @param event a descriptor that may end the wait when it is readable, if no memory is shared.
   */
  bool await(int event, int patience_ms);
  /** @brief Say whether only the sockets are looked at. */
  void setAsleep(bool is_asleep);
  /** @return whether there is something that no socket tells of. */
  bool hasPiece() const { return channel_ && channel_->hasPiece(); }

  // ---- sending
  /** @brief Send @p bytes, as far as the socket takes them, and keep the rest. For @p topic see
   * SharedChannel::put(). */
  void send(std::string bytes, bool is_last, std::optional<std::uint32_t> topic = {});
  /** @brief Send more of the rest. */
  void sendMore();
  /** @return whether there is a rest. */
  bool awaitsSpace() const { return !unsent_.empty(); }
  /** @brief Tell the other side that no more bytes come. */
  void shutDown();

 private:
  ssize_t receiveFirst(std::vector<char>* buffer);

  Descriptor socket_;
  Descriptor offered_;  // memory, until it is known who has offered it
  std::unique_ptr<SharedChannel> channel_;
  bool may_offer_ = true;
  std::uint64_t received_ = 0;  // bytes of the socket
  std::uint64_t queued_ = 0;    // for the socket, sent or not
  std::string unsent_;
};

}  // namespace move_base_abstract
