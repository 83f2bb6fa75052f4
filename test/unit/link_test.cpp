#include "roscpp_shim/membership/link.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <future>
#include <memory>
#include <string>
#include <thread>

#include "common/local_address.h"

namespace move_base_abstract::lockstep::internal {
namespace {

constexpr auto kGuard = std::chrono::seconds(30);  // only ends a test that would never end

/** A time master that uses the memory of one participant. */
class Peer {
 public:
  explicit Peer(const std::string& address) : door_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    const LocalAddress local = localAddressOf(address);
    EXPECT_EQ(::bind(door_, local.get(), local.size), 0);
    EXPECT_EQ(::listen(door_, 1), 0);
  }
  ~Peer() {
    ::close(socket_);
    ::close(door_);
  }

  void accept() {
    socket_ = ::accept(door_, nullptr, nullptr);
    std::array<char, 64> offer;
    int file = -1;
    ASSERT_GT(receiveWithFile(socket_, offer.data(), offer.size(), &file), 0);
    channel_ = SharedChannel::use(file);
    ::close(file);
    ASSERT_NE(channel_, nullptr);
  }

  /** Send all over the socket, and tell of it once. */
  void send(const std::string& bytes) {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
    channel_->wake();
  }

 private:
  int door_;
  int socket_ = -1;
  std::unique_ptr<SharedChannel> channel_;
};

Link::Event next(Link* link, Bell* bell, int timeout_ms, wire::FrameBuffer* frames) {
  Place place;
  link->await(*bell, timeout_ms, &place);
  return link->look(*bell, frames);
}

TEST(Link, WhatIsTooLargeForOneLookIsReadWithoutAnotherWakeUp) {
  const std::string address = "link_test:" + std::to_string(::getpid());
  Peer master(address);
  Link link;
  ASSERT_TRUE(link.connect(address));
  ASSERT_TRUE(link.send("offer"));
  master.accept();
  Bell bell;
  wire::FrameBuffer frames;
  EXPECT_EQ(next(&link, &bell, 0, &frames), Link::Event::kNothing);  // it learns of the memory
  std::string frame(150'000, '\0');
  const auto size = static_cast<std::uint32_t>(frame.size() - 4);
  std::memcpy(frame.data(), &size, 4);
  master.send(frame);

  std::promise<void> is_read;
  std::atomic<bool> was_late{false};
  std::thread guard([&] {
    was_late = is_read.get_future().wait_for(kGuard) != std::future_status::ready;
    bell.ring();
  });
  for (int k = 0; k < 3 && !was_late; ++k) {
    EXPECT_EQ(next(&link, &bell, 1'000'000, &frames), Link::Event::kBytes);
  }
  is_read.set_value();
  guard.join();
  EXPECT_FALSE(was_late);
  EXPECT_TRUE(frames.next().has_value());
}

}  // namespace
}  // namespace move_base_abstract::lockstep::internal
