#include "link.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>

#include "common/local_address.h"
#include "stop_signals.h"

namespace move_base_abstract::lockstep::internal {

Bell::Bell() : descriptor_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (descriptor_ < 0) {
    throw Error(std::string("lockstep: no eventfd: ") + std::strerror(errno));
  }
}

Bell::~Bell() { ::close(descriptor_); }

void Bell::ring() {
  const std::uint64_t one = 1;
  // It fails only if the counter is full, and then the bell rings already.
  [[maybe_unused]] const ssize_t written = ::write(descriptor_, &one, sizeof(one));
  if (SharedChannel* const channel = channel_) {
    channel->wakeSelf();
  }
}

void Bell::silence() {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(descriptor_, &count, sizeof(count));
}

bool Link::connect(const std::string& address) {
  const auto colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == address.size()) {
    throw Error("lockstep: parameter /time_master/lockstep_address must be 'host:port', got '" +
                address + "'");
  }
  if (connectLocally(address)) {
    return true;
  }
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.substr(0, colon).c_str(), address.substr(colon + 1).c_str(), &hints,
                    &found) != 0) {
    return false;
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
  for (const addrinfo* at = found; at != nullptr; at = at->ai_next) {
    socket_ = ::socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC, at->ai_protocol);
    if (socket_ >= 0 && ::connect(socket_, at->ai_addr, at->ai_addrlen) == 0) {
      const int on = 1;
      ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
      return true;
    }
    close();
  }
  return false;
}

/** @return whether the time master is on this computer and has accepted a Unix connection. */
bool Link::connectLocally(const std::string& address) {
  const LocalAddress local = localAddressOf(address);
  socket_ = local.size > 0 ? ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0) : -1;
  if (socket_ >= 0 && ::connect(socket_, local.get(), local.size) == 0) {
    channel_ = SharedChannel::make(&offered_file_).release();
    signals_before_ = stopSignalBytes();
    return true;
  }
  close();
  return false;
}

void Link::announceStopSignals() { internal::announceStopSignals(socket_); }

/** @brief Send the first of @p bytes together with the shared memory. */
void Link::offerSharedMemory(std::string_view* bytes) {
  const ssize_t sent = sendWithFile(socket_, *bytes, offered_file_);
  if (sent > 0) {
    bytes->remove_prefix(static_cast<std::size_t>(sent));
    sent_ += static_cast<std::uint64_t>(sent);
  }
  ::close(offered_file_);
  offered_file_ = -1;
}

bool Link::send(std::string_view bytes) {
  const Sending sending;
  if (offered_file_ >= 0) {
    offerSharedMemory(&bytes);
  }
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
      sent_ += static_cast<std::uint64_t>(sent);
    } else if (errno != EINTR) {
      return false;
    }
  }
  if (is_shared_) {
    channel_->wake();  // the time master may wait for a report, and not look at its sockets
  }
  return true;
}

bool Link::sendAwaited(std::string_view bytes) {
  return (is_shared_ && channel_->put(bytes, sent_ + stopSignalBytes() - signals_before_)) ||
         send(bytes);
}

void Link::await(Bell& bell, int timeout_ms, Place* place) {
  if (!is_shared_ && channel_ != nullptr && channel_->isUsed()) {
    bell.ringFor(channel_);
    channel_->setAsleep(false);
    channel_->wakeSelf();  // the bell may have rung before
    is_shared_ = true;
  }
  if (!is_shared_) {
    poll(bell, timeout_ms);
  } else if (!has_more_) {
    channel_->wait(timeout_ms, place);
  }
}

Link::Event Link::look(const Bell& bell, wire::FrameBuffer* frames) {
  if (!is_shared_) {
    return takeFromSocket(frames);
  }
  // One wake-up tells of all that is in the socket. The last look may have left a rest there.
  const bool has_news = channel_->takeNews();
  if (!std::exchange(has_more_, false) && !has_news && takePiece(frames)) {
    return Event::kBytes;
  }
  poll(bell, 0);
  const Event event = takeFromSocket(frames);
  return event == Event::kNothing && takePiece(frames) ? Event::kBytes : event;
}

/** @brief Take the piece of the shared memory, after what was sent before it over the socket. */
bool Link::takePiece(wire::FrameBuffer* frames) {
  while (const auto place = channel_->place()) {
    if (*place <= received_) {
      received_ = merge(channel_, received_, {},
                        [frames](std::string_view bytes) { frames->append(bytes); });
      return true;
    }
    if (receive(static_cast<std::size_t>(*place - received_), frames) == Event::kClosed) {
      return false;
    }
  }
  return false;
}

void Link::poll(const Bell& bell, int timeout_ms) {
  polled_ = {{{socket_, POLLIN, 0}, {bell.descriptor(), POLLIN, 0}}};
  ::poll(polled_.data(), polled_.size(), timeout_ms);
}

/** @brief Take what the latest poll() has found. */
Link::Event Link::takeFromSocket(wire::FrameBuffer* frames) {
  // The socket comes first: it brings the news of members, which decide what the bell means.
  if (polled_[0].revents != 0) {
    return receive(1 << 16, frames);
  }
  return polled_[1].revents != 0 ? Event::kBell : Event::kNothing;
}

/** @brief Receive at most @p most bytes, and append them to @p frames. */
Link::Event Link::receive(std::size_t most, wire::FrameBuffer* frames) {
  std::array<char, 1 << 16> chunk;
  const ssize_t got = ::recv(socket_, chunk.data(), std::min(most, chunk.size()), 0);
  if (got > 0) {
    has_more_ = static_cast<std::size_t>(got) == chunk.size();
    received_ = merge(channel_, received_, {chunk.data(), static_cast<std::size_t>(got)},
                      [frames](std::string_view bytes) { frames->append(bytes); });
    return Event::kBytes;
  }
  return got < 0 && errno == EINTR ? Event::kNothing : Event::kClosed;
}

void Link::finish(int patience_ms) {
  if (!isOpen()) {
    return;
  }
  // Closing a socket with unread bytes resets the connection, and the last report would be lost.
  ::shutdown(socket_, SHUT_WR);
  std::array<char, 4096> rest;
  pollfd polled{socket_, POLLIN, 0};
  while (::poll(&polled, 1, patience_ms) > 0 && ::recv(socket_, rest.data(), rest.size(), 0) > 0) {
  }
  close();
}

void Link::close() {
  if (socket_ >= 0) {
    forgetStopSignals(socket_);
    ::close(socket_);
    socket_ = -1;
  }
  if (offered_file_ >= 0) {
    ::close(offered_file_);
    offered_file_ = -1;
  }
}

}  // namespace move_base_abstract::lockstep::internal
