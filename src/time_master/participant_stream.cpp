#include "participant_stream.h"

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <utility>

namespace move_base_abstract {

// ---- receiving -------------------------------------------------------------------------------

void ParticipantStream::endOffer(bool is_used) {
  may_offer_ = false;
  const Descriptor offered = std::exchange(offered_, Descriptor());
  if (is_used && offered.get() >= 0) {
    channel_ = SharedChannel::use(offered.get());
  }
}

/** @brief Receive bytes, and the memory that a participant may offer with them. */
ssize_t ParticipantStream::receiveFirst(std::vector<char>* buffer) {
  int file = -1;
  const ssize_t size = receiveWithFile(socket_.get(), buffer->data(), buffer->size(), &file);
  Descriptor offered(file);
  if (offered.get() >= 0) {
    offered_ = std::move(offered);
  }
  return size;
}

ParticipantStream::Received ParticipantStream::receive(
    std::vector<char>* buffer, const std::function<void(std::string_view)>& pass) {
  const auto place = channel_ ? channel_->place() : std::nullopt;
  if (place && *place <= received_) {
    received_ = merge(channel_.get(), received_, {}, pass);
    return Received::kAll;
  }
  const ssize_t size =
      may_offer_ ? receiveFirst(buffer) : ::recv(socket_.get(), buffer->data(), buffer->size(), 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) {
    // What a piece comes after is in the socket before the piece is there.
    return place && errno == EAGAIN ? Received::kGone : Received::kAll;
  }
  if (size <= 0) {
    return Received::kGone;
  }
  received_ =
      merge(channel_.get(), received_, {buffer->data(), static_cast<std::size_t>(size)}, pass);
  return static_cast<std::size_t>(size) < buffer->size() ? Received::kAll : Received::kMore;
}

bool ParticipantStream::await(int event, int patience_ms) {
  if (channel_) {
    Place place;
    channel_->wait(patience_ms, &place);
    channel_->takeNews();
    if (channel_->hasPiece()) {
      return true;
    }
    patience_ms = 0;
  }
  std::array<pollfd, 2> polled{{{socket_.get(), POLLIN, 0}, {event, POLLIN, 0}}};
  return ::poll(polled.data(), polled.size(), patience_ms) > 0 && polled[0].revents != 0;
}

void ParticipantStream::setAsleep(bool is_asleep) {
  if (channel_) {
    channel_->setAsleep(is_asleep);
  }
}

// ---- sending ---------------------------------------------------------------------------------

void ParticipantStream::send(std::string bytes, bool is_last, std::optional<std::uint32_t> topic) {
  if (channel_ && unsent_.empty() && !is_last && channel_->put(bytes, queued_, topic)) {
    return;
  }
  queued_ += bytes.size();
  if (unsent_.empty()) {
    unsent_ = std::move(bytes);
  } else {
    unsent_ += bytes;
  }
  sendMore();
}

/** @brief Send what the socket takes. An error is left to receive(), which sees it too. */
void ParticipantStream::sendMore() {
  std::size_t sent = 0;
  while (sent < unsent_.size()) {
    const ssize_t size =
        ::send(socket_.get(), unsent_.data() + sent, unsent_.size() - sent, MSG_NOSIGNAL);
    if (size < 0 && errno != EINTR) {
      if (errno != EAGAIN) {
        sent = unsent_.size();  // no one will read it
      }
      break;
    }
    sent += size > 0 ? static_cast<std::size_t>(size) : 0;
  }
  unsent_.erase(0, sent);
  if (channel_) {
    channel_->wake();
  }
}

void ParticipantStream::shutDown() {
  // Not close(): with unread bytes of the other side, the kernel would discard our last ones.
  ::shutdown(socket_.get(), SHUT_WR);
  if (channel_) {
    channel_->wake();
  }
}

}  // namespace move_base_abstract
