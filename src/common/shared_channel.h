// Memory that a participant shares with the time master on its computer. Grants and reports go
// through it; everything else, and what is too large, goes over their socket. No ROS.
#pragma once

#include <sys/types.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace move_base_abstract {

/** @brief Where one thread sleeps until another one calls it, which may be of another process. */
class Sleeper {
 public:
  std::uint32_t calls() const { return calls_; }
  /** @brief End the sleep of the thread, or its next one. */
  void call();
  /** @brief Sleep until there are other calls than @p seen, for at most @p timeout_ms of wall time
   * (-1: without end). It may end earlier. */
  void sleep(std::uint32_t seen, int timeout_ms);

 private:
  std::atomic<std::uint32_t> calls_{0};  // the futex
  std::atomic<std::uint32_t> is_asleep_{0};
};

/** @brief A thread's place in a channel, and the calls that it has seen. Place 0 is not a thread's.
 */
struct Place {
  std::uint32_t number = 0;
  std::uint32_t seen = 0;
};

/**
 * @brief Which thread of a participant is likely to go on with a grant, by its place (0: the one
 * that reads). If that is wrong, the thread hands over.
 */
struct Directions {
  using Number = std::atomic<std::uint8_t>;

  std::array<Number, 256> queue_of_topic{};  // by the participant's number of the topic
  std::array<Number, 64> thread_of_queue{};  // queue 0 is none
  Number thread_at_wake{0};
};

/**
 * @brief Two boxes, one for each direction, each with room for one piece of the stream of bytes.
 *
 * A piece says after how many bytes of the socket it comes, so that the reader puts both into the
 * order in which they were sent (merge()). A wait for the other side is one futex, which is about
 * half as expensive as a wait for a socket. Each thread of a participant has a place to sleep, so
 * that the time master wakes the one that goes on. The other side may be hostile or dead: nothing
 * that it writes is trusted, and nothing waits for it without a limit.
 *
 * For each side, one thread at a time reads, and one at a time writes. Any thread may wake().
 */
class SharedChannel {
 public:
  enum class Side { kParticipant, kTimeMaster };
  static constexpr std::size_t kMostBytes = 32 * 1024 - 64;  // of a piece
  static constexpr std::uint32_t kPlaces = 64;

  /**
   * @brief Make the memory, as a participant does.
   * @return none, if the system has no such memory. @p file is then -1, otherwise a descriptor for
   * the other side, which the caller closes.
   */
  static std::unique_ptr<SharedChannel> make(int* file);
  /**
   * @brief Use the memory of a participant, as the time master does, and tell the participant.
   * @return none, if @p file is not such memory, or might shrink while it is in use.
   */
  static std::unique_ptr<SharedChannel> use(int file);

  ~SharedChannel();
  SharedChannel(const SharedChannel&) = delete;
  SharedChannel& operator=(const SharedChannel&) = delete;

  /** @return whether the time master uses the memory. */
  bool isUsed() const;

  // ---- writing
  /**
   * @brief Hand over a piece that comes after @p after bytes of the socket, and wake the other
   * side.
   * @param topic for a participant: its number of the topic of a grant's first message; 0: there is
   * none; nothing: it is not such a grant. See Directions.
   * @return false if it has to go over the socket: the piece is too large, the one before has not
   * been taken yet, or the other side looks at its sockets only.
   */
  bool put(std::string_view bytes, std::uint64_t after, std::optional<std::uint32_t> topic = {});
  /** @brief End the wait() of the other side, or its next one: something is in its socket. */
  void wake();

  // ---- reading
  /** @return whether there is a piece. */
  bool hasPiece() const;
  /** @return after how many bytes of the socket the piece comes; none: there is no piece. */
  std::optional<std::uint64_t> place() const;
  struct Piece {
    std::uint64_t after;     // bytes of the socket
    std::string_view bytes;  // valid until the next call of take()
  };
  /** @return the piece, if it comes after @p end bytes of the socket at most. */
  std::optional<Piece> take(std::uint64_t end);
  /**
   * @brief Wait until there is a piece or a wake-up, for at most @p timeout_ms of wall time.
   * A wake-up since the last takeNews() counts.
   * @param place where the calling thread sleeps. Without a number, calls that came before do not
   * count.
   */
  void wait(int timeout_ms, Place* place);
  /** @return whether there was a wake-up since the last call. */
  bool takeNews();
  /** @brief End the own wait(), or the next one, from another thread. */
  void wakeSelf();
  /** @brief Say whether the other side is to use the socket only, because nobody looks here. */
  void setAsleep(bool is_asleep);

  // ---- the participant's threads
  Sleeper& sleeper(std::uint32_t place);
  Directions& directions();

 private:
  struct Box;
  struct Memory;

  SharedChannel(Memory* memory, Side side);
  static void callReader(Box* box);
  std::uint32_t threadFor(std::optional<std::uint32_t> topic) const;
  bool takeBack(Box* box);

  Memory* memory_;
  Box* in_;
  Box* out_;
  std::uint32_t news_ = 0;  // wake-ups that were taken
  std::string taken_;       // the other side may change what is in the memory
};

/** @brief Send @p bytes over a local @p socket, and with them a copy of the descriptor @p file. */
ssize_t sendWithFile(int socket, std::string_view bytes, int file);
/**
 * @brief Receive bytes as recv() does, and descriptors that may come with them.
 * @param file the descriptor that has come, which the caller closes; -1: none. Of several one is
 * kept.
 */
ssize_t receiveWithFile(int socket, char* bytes, std::size_t size, int* file);

/**
 * @brief Pass on what has come over the socket, with the pieces of the channel in their places.
 *
 * @param channel may be none.
 * @param read the number of bytes of the socket that were passed on before.
 * @param got what has come over the socket since then; may be empty.
 * @param pass called with the next bytes of the stream.
 * @return the new number of bytes of the socket.
 */
std::uint64_t merge(SharedChannel* channel, std::uint64_t read, std::string_view got,
                    const std::function<void(std::string_view)>& pass);

}  // namespace move_base_abstract
