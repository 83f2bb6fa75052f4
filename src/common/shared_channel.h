// Memory that a participant shares with the time master on its computer. Grants and reports go
// through it; everything else, and what is too large, goes over their socket. No ROS.
#ifndef MOVE_BASE_ABSTRACT_COMMON_SHARED_CHANNEL_H
#define MOVE_BASE_ABSTRACT_COMMON_SHARED_CHANNEL_H

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace move_base_abstract {

/**
 * @brief Two boxes, one for each direction, each with room for one piece of the stream of bytes.
 *
 * A piece says after how many bytes of the socket it comes, so that the reader puts both into the
 * order in which they were sent (merge()). A wait for the other side is one futex, which is about
 * half as expensive as a wait for a socket. The other side may be hostile or dead: nothing that it
 * writes is trusted, and nothing waits for it without a limit.
 *
 * For each side, one thread at a time reads, and one at a time writes. Any thread may wake().
 */
class SharedChannel {
 public:
  enum class Side { kParticipant, kTimeMaster };
  static constexpr std::size_t kMostBytes = 32 * 1024 - 64;  // of a piece

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
   * @return false if it has to go over the socket: the piece is too large, the one before has not
   * been taken yet, or the other side looks at its sockets only.
   */
  bool put(std::string_view bytes, std::uint64_t after);
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
   * A wake-up that came since the last wait counts.
   * @return whether the socket is to be looked at: there was a wake-up, or there is no piece.
   */
  bool wait(int timeout_ms);
  /** @brief End the own wait(), or the next one, from another thread. */
  void wakeSelf();
  /** @brief Say whether the other side is to use the socket only, because nobody looks here. */
  void setAsleep(bool is_asleep);

 private:
  struct Box;
  struct Memory;

  SharedChannel(Memory* memory, Side side);
  static void endWait(Box* box);
  bool takeBack(Box* box);

  Memory* memory_;
  Box* in_;
  Box* out_;
  std::uint32_t news_ = 0;  // wake-ups that have ended a wait
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

#endif  // MOVE_BASE_ABSTRACT_COMMON_SHARED_CHANNEL_H
