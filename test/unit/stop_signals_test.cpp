// A signal that ends a process: the time master hears of it first, whatever is being sent.
#include "roscpp_shim/membership/stop_signals.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <functional>
#include <string>

#include "lockstep/wire/wire.h"

namespace move_base_abstract::lockstep::internal {
namespace {

struct Ended {
  int status;        // as of waitpid
  std::string sent;  // all that came over its connection
};

/** @brief Have a process that takes part by the end of a connection do something; see it end. */
Ended endOf(const std::function<void(int socket)>& act) {
  std::array<int, 2> sockets{};
  EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(sockets[0]);
    for (const int number : {SIGINT, SIGTERM}) {
      ::signal(number, SIG_DFL);  // a shell has its background jobs ignore one
    }
    announceStopSignals(sockets[1]);
    act(sockets[1]);
    ::_exit(99);  // it was not ended
  }
  ::close(sockets[1]);
  Ended ended{0, {}};
  std::array<char, 256> chunk{};
  for (ssize_t got = 1; got > 0;) {
    got = ::recv(sockets[0], chunk.data(), chunk.size(), 0);
    ended.sent.append(chunk.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  }
  ::close(sockets[0]);
  EXPECT_EQ(::waitpid(child, &ended.status, 0), child);
  return ended;
}

std::string stopping() {
  return wire::encode(wire::ParticipantFrame(wire::Stopping{"a signal has told it to end"}));
}

void expectEndedBy(const Ended& ended, int number) {
  ASSERT_TRUE(WIFSIGNALED(ended.status)) << ended.status;
  EXPECT_EQ(WTERMSIG(ended.status), number);
}

TEST(StopSignals, tellTheTimeMasterBeforeTheProcessEnds) {
  for (const int number : {SIGINT, SIGTERM}) {
    const Ended ended = endOf([number](int /*socket*/) { ::raise(number); });
    expectEndedBy(ended, number);
    EXPECT_EQ(ended.sent, stopping());
  }
}

TEST(StopSignals, comeAfterTheFrameThatIsBeingSent) {
  const Ended ended = endOf([](int socket) {
    const Sending sending;
    EXPECT_EQ(::send(socket, "half of a ", 10, 0), 10);
    ::raise(SIGTERM);
    EXPECT_EQ(::send(socket, "frame", 5, 0), 5);
  });
  expectEndedBy(ended, SIGTERM);
  EXPECT_EQ(ended.sent, "half of a frame" + stopping());
}

TEST(StopSignals, endTheProcessWhereTheSenderLeavesSignalsToOthers) {
  const Ended ended = endOf([](int socket) {
    const Sending sending;
    ::raise(SIGTERM);
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
    EXPECT_EQ(::send(socket, "frame", 5, 0), 5);
  });
  expectEndedBy(ended, SIGTERM);
  EXPECT_EQ(ended.sent, "frame" + stopping());
}

TEST(StopSignals, endAProcessAtOnceWhenTheyComeAgain) {
  const Ended ended = endOf([](int /*socket*/) {
    const Sending sending;  // that never gets through
    ::raise(SIGTERM);
    ::raise(SIGTERM);
  });
  expectEndedBy(ended, SIGTERM);
  EXPECT_EQ(ended.sent, "");
}

}  // namespace
}  // namespace move_base_abstract::lockstep::internal
