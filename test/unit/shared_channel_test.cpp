#include "common/shared_channel.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "night.h"
#include "time_master/participant_stream.h"

namespace move_base_abstract::shared_channel_test {
namespace {

constexpr int kLong = 60'000;  // ms; only ends a test that would never end

/** Both ends, as they are after the participant has learnt that its memory is used. */
struct Pair {
  Pair() {
    participant = SharedChannel::make(&file);
    master = SharedChannel::use(file);
    participant->setAsleep(false);
  }
  ~Pair() { ::close(file); }

  int file = -1;
  std::unique_ptr<SharedChannel> participant;
  std::unique_ptr<SharedChannel> master;
};

/** Return the piece, or "none". */
std::string taken(SharedChannel* channel) {
  const auto piece = channel->take(1000);
  return piece ? std::string(piece->bytes) : "none";
}

/** Wait as a thread without a place of its own. Return whether there was a wake-up. */
bool waited(SharedChannel* channel) {
  Place place;
  channel->wait(kLong, &place);
  return channel->takeNews();
}

std::string merged(SharedChannel* channel, std::uint64_t read, std::string_view got) {
  std::string all;
  merge(channel, read, got, [&all](std::string_view bytes) { all += bytes; });
  return all;
}

TEST(SharedChannel, APieceGoesEachWayOnce) {
  Pair ends;
  EXPECT_TRUE(ends.participant->isUsed());
  EXPECT_TRUE(ends.participant->put("report", 7));
  EXPECT_FALSE(ends.master->put("", 0) && ends.participant->put("second", 7));
  EXPECT_EQ(ends.master->place(), 7U);
  EXPECT_FALSE(ends.master->take(6).has_value());
  EXPECT_EQ(taken(ends.master.get()), "report");
  EXPECT_EQ(taken(ends.master.get()), "none");
  EXPECT_EQ(ends.master->place(), std::nullopt);
  EXPECT_TRUE(ends.participant->put("second", 7));
}

TEST(SharedChannel, WhatIsTooLargeOrCannotBeTakenYetGoesOverTheSocket) {
  Pair ends;
  const std::string most(SharedChannel::kMostBytes, 'x');
  EXPECT_FALSE(ends.master->put(most + "x", 0));
  EXPECT_TRUE(ends.master->put(most, 0));
  EXPECT_FALSE(ends.master->put("next", 0));
  EXPECT_EQ(taken(ends.participant.get()), most);
}

TEST(SharedChannel, NothingIsPutForAReaderThatSleeps) {
  Pair ends;
  ends.master->setAsleep(true);
  EXPECT_FALSE(ends.participant->put("report", 0));
  EXPECT_FALSE(ends.master->hasPiece());
  ends.master->setAsleep(false);
  EXPECT_TRUE(ends.participant->put("report", 0));
}

TEST(SharedChannel, AParticipantThatDoesNotKnowYetThatItsMemoryIsUsedGetsNothing) {
  int file = -1;
  const auto participant = SharedChannel::make(&file);
  EXPECT_FALSE(participant->isUsed());
  const auto master = SharedChannel::use(file);
  ::close(file);
  EXPECT_TRUE(participant->isUsed());
  EXPECT_FALSE(master->put("welcome", 0));
}

TEST(SharedChannel, AWakeUpBeforeTheWaitEndsItAndSaysThatThereIsNews) {
  Pair ends;
  ends.master->wake();
  EXPECT_TRUE(waited(ends.participant.get()));
  ends.participant->wakeSelf();
  EXPECT_TRUE(waited(ends.participant.get()));
  EXPECT_TRUE(ends.master->put("grant", 0));
  EXPECT_FALSE(waited(ends.participant.get()));
  ends.master->wake();
  EXPECT_TRUE(waited(ends.participant.get()));  // news, although the piece is still there
}

// ---- which thread of a participant is woken ---------------------------------------------------

/** Return the places whose threads are called by a grant with this topic. */
std::vector<std::uint32_t> called(Pair* ends, std::optional<std::uint32_t> topic) {
  std::vector<std::uint32_t> before, places;
  for (std::uint32_t place = 0; place < SharedChannel::kPlaces; ++place) {
    before.push_back(ends->participant->sleeper(place).calls());
  }
  EXPECT_TRUE(ends->master->put("grant", 0, topic));
  for (std::uint32_t place = 0; place < SharedChannel::kPlaces; ++place) {
    if (ends->participant->sleeper(place).calls() != before[place]) {
      places.push_back(place);
    }
  }
  EXPECT_EQ(taken(ends->participant.get()), "grant");
  return places;
}

TEST(SharedChannel, AGrantWakesTheThreadThatGoesOnOrElseTheOneThatReads) {
  using Places = std::vector<std::uint32_t>;
  Pair ends;
  Directions& to = ends.participant->directions();
  to.queue_of_topic[7] = 3;
  to.thread_of_queue[3] = 5;
  to.thread_at_wake = 9;
  ends.participant->wakeSelf();
  Place reader{2, ends.participant->sleeper(2).calls()};
  ends.participant->wait(kLong, &reader);
  EXPECT_EQ(called(&ends, 7), Places{5});
  EXPECT_EQ(called(&ends, 0), Places{9});
  EXPECT_EQ(called(&ends, 8), Places{2});    // nothing is known of this topic
  EXPECT_EQ(called(&ends, 900), Places{2});  // there is no room for what is known of it
  EXPECT_EQ(called(&ends, std::nullopt), Places{2});
}

TEST(SharedChannel, ACallBeforeTheSleepEndsIt) {
  Pair ends;
  Sleeper& sleeper = ends.participant->sleeper(4);
  const std::uint32_t seen = sleeper.calls();
  sleeper.call();
  sleeper.sleep(seen, -1);
  EXPECT_NE(sleeper.calls(), seen);
}

TEST(SharedChannel, OneWaitsUntilTheOtherPutsAThousandTimes) {
  Pair ends;
  std::thread other([&] {
    for (int k = 0; k < 1000; ++k) {
      while (!ends.participant->hasPiece()) {
        waited(ends.participant.get());
      }
      ends.participant->put(taken(ends.participant.get()) + "!", 0);
    }
  });
  for (int k = 0; k < 1000; ++k) {
    ASSERT_TRUE(ends.master->put(std::to_string(k), 0));
    while (!ends.master->hasPiece()) {
      waited(ends.master.get());
    }
    ASSERT_EQ(taken(ends.master.get()), std::to_string(k) + "!");
  }
  other.join();
}

TEST(SharedChannel, AReaderThatSleepsMissesNoPiece) {
  const int kRuns = times(10'000, 100'000);
  Pair ends;
  std::atomic<int> begun{0}, done{0};
  bool is_put = false;
  std::thread writer([&] {
    for (int run = 1; run <= kRuns; ++run) {
      while (begun < run) {
        std::this_thread::yield();
      }
      is_put = ends.participant->put("report", 0);
      done = run;
    }
  });
  int missed = 0;
  for (int run = 1; run <= kRuns; ++run) {
    begun = run;
    for (int delay = run % 64; delay > 0; --delay) {
      static_cast<void>(begun.load());
    }
    ends.master->setAsleep(true);
    const bool is_seen = ends.master->hasPiece();
    while (done < run) {
      std::this_thread::yield();
    }
    missed += is_put && !is_seen ? 1 : 0;  // it would sleep now
    ends.master->take(0);
    ends.master->setAsleep(false);
  }
  writer.join();
  EXPECT_EQ(missed, 0);
}

TEST(SharedChannel, MergePutsPiecesWhereTheyWereSent) {
  Pair ends;
  ASSERT_TRUE(ends.participant->put("<piece>", 5));
  EXPECT_EQ(merged(ends.master.get(), 0, "abc"), "abc");  // it comes later
  EXPECT_EQ(merged(ends.master.get(), 3, "defg"), "de<piece>fg");
  ASSERT_TRUE(ends.participant->put("<next>", 7));
  EXPECT_EQ(merged(ends.master.get(), 7, ""), "<next>");
  EXPECT_EQ(merged(nullptr, 7, "hij"), "hij");
}

TEST(SharedChannel, AnyMixtureComesInTheOrderInWhichItWasSent) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    Pair ends;
    std::string sent, socket, received;
    std::uint64_t written = 0, read = 0;
    const auto collect = [&received](std::string_view bytes) { received += bytes; };
    for (int step = 0; step < 200; ++step) {
      const std::string bytes = "[" + std::to_string(step) + "]";
      switch (random() % 3) {
        case 0:
          if (ends.participant->put(bytes, written)) {
            sent += bytes;
            break;
          }
          [[fallthrough]];
        case 1:
          sent += bytes;
          socket += bytes;
          written += bytes.size();
          break;
        default: {
          const std::size_t size = random() % (socket.size() + 1);
          read = merge(ends.master.get(), read, socket.substr(0, size), collect);
          socket.erase(0, size);
        }
      }
    }
    merge(ends.master.get(), read, socket, collect);
    ASSERT_EQ(received, sent) << seed;
  }
}

// ---- what is not such memory, and what a participant may do to it -----------------------------

TEST(SharedChannel, OtherFilesAreNotUsed) {
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  EXPECT_EQ(SharedChannel::use(pipe[0]), nullptr);
  EXPECT_EQ(SharedChannel::use(-1), nullptr);
  ::close(pipe[0]);
  ::close(pipe[1]);

  Pair good;
  const off_t size = ::lseek(good.file, 0, SEEK_END);
  const int unsealed = ::memfd_create("unsealed", MFD_ALLOW_SEALING);
  ASSERT_EQ(::ftruncate(unsealed, size), 0);
  EXPECT_EQ(SharedChannel::use(unsealed), nullptr);
  ASSERT_EQ(::fcntl(unsealed, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL), 0);
  EXPECT_EQ(SharedChannel::use(unsealed), nullptr);  // no mark
  ::close(unsealed);
  const int small = ::memfd_create("small", MFD_ALLOW_SEALING);
  ASSERT_EQ(::ftruncate(small, size / 2), 0);
  ASSERT_EQ(::fcntl(small, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL), 0);
  EXPECT_EQ(SharedChannel::use(small), nullptr);
  ::close(small);
}

TEST(SharedChannel, MemoryCannotShrinkWhileItIsUsed) {
  Pair ends;
  EXPECT_NE(::ftruncate(ends.file, 0), 0);
}

TEST(SharedChannel, MemoryFullOfAnythingIsReadWithinItsBounds) {
  for (const int value : {0x00, 0x01, 0x02, 0x7f, 0xff}) {
    Pair ends;
    const auto size = static_cast<std::size_t>(::lseek(ends.file, 0, SEEK_END));
    void* const place = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, ends.file, 0);
    std::memset(place, value, size);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(merged(ends.master.get(), 0, "bytes of the socket").size(),
                SharedChannel::kMostBytes + 19);
      for (const auto topic : {std::optional<std::uint32_t>(), {0}, {1}, {900}}) {
        ends.master->put("grant", 1, topic);
      }
      ends.master->wake();
      Place own;
      ends.master->wait(1, &own);
    }
    ::munmap(place, size);
  }
}

// ---- the time master's end of a connection ----------------------------------------------------

std::ptrdiff_t openFiles() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                       std::filesystem::directory_iterator());
}

/** A connection over which a participant has offered its memory, with the first byte. */
struct Connection {
  Connection() {
    int sockets[2];
    ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, sockets);
    stream = ParticipantStream(Descriptor(sockets[0]));
    socket = Descriptor(sockets[1]);
    int file = -1;
    participant = SharedChannel::make(&file);
    sendWithFile(socket.get(), "H", file);
    ::close(file);
  }
  ParticipantStream::Received receive() {
    return stream.receive(&buffer, [this](std::string_view bytes) { received += bytes; });
  }
  void send(const std::string& bytes) { ::send(socket.get(), bytes.data(), bytes.size(), 0); }

  ParticipantStream stream;
  Descriptor socket;
  std::unique_ptr<SharedChannel> participant;
  std::vector<char> buffer = std::vector<char>(1024);
  std::string received;
};

TEST(ParticipantStream, UsesTheMemoryThatCameWithTheFirstBytesIfItIsAllowed) {
  for (const bool is_allowed : {true, false}) {
    Connection one;
    EXPECT_EQ(one.receive(), ParticipantStream::Received::kAll);
    one.stream.endOffer(is_allowed);
    EXPECT_EQ(one.participant->isUsed(), is_allowed);
    one.participant->setAsleep(false);
    one.stream.send("grant", false);
    EXPECT_EQ(one.participant->hasPiece(), is_allowed);
  }
}

TEST(ParticipantStream, KeepsOneOfSeveralDescriptorsAndNoneAfterTheOffer) {
  const auto before = openFiles();
  {
    Connection one;
    one.receive();
    int files[2] = {0, 0};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(files))] = {};
    char byte = 'x';
    iovec bytes{&byte, 1};
    msghdr message{};
    message.msg_iov = &bytes;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof(control);
    CMSG_FIRSTHDR(&message)->cmsg_level = SOL_SOCKET;
    CMSG_FIRSTHDR(&message)->cmsg_type = SCM_RIGHTS;
    CMSG_FIRSTHDR(&message)->cmsg_len = CMSG_LEN(sizeof(files));
    std::memcpy(CMSG_DATA(CMSG_FIRSTHDR(&message)), files, sizeof(files));
    for (int k = 0; k < 5; ++k) {
      ASSERT_EQ(::sendmsg(one.socket.get(), &message, 0), 1);
      one.receive();
    }
    one.stream.endOffer(true);
    ASSERT_EQ(::sendmsg(one.socket.get(), &message, 0), 1);
    one.receive();
    EXPECT_EQ(one.received, "Hxxxxxx");
    EXPECT_FALSE(one.participant->isUsed());
  }
  EXPECT_EQ(openFiles(), before);
}

TEST(ParticipantStream, ReceivesAPieceAfterTheBytesBeforeIt) {
  Connection one;
  one.receive();
  one.stream.endOffer(true);
  one.send("knock");
  ASSERT_TRUE(one.participant->put("report", 6));
  EXPECT_TRUE(one.stream.await(-1, 0));
  EXPECT_EQ(one.receive(), ParticipantStream::Received::kAll);
  EXPECT_EQ(one.received, "Hknockreport");
  EXPECT_FALSE(one.stream.await(-1, 0));
}

TEST(ParticipantStream, AParticipantThatClaimsBytesThatItHasNotSentIsGone) {
  Connection one;
  one.receive();
  one.stream.endOffer(true);
  ASSERT_TRUE(one.participant->put("report", 1000));
  EXPECT_EQ(one.receive(), ParticipantStream::Received::kGone);
}

}  // namespace
}  // namespace move_base_abstract::shared_channel_test
