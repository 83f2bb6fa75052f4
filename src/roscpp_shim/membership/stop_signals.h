// Notices SIGINT and SIGTERM in addition to the program's handlers, and tells the time master at
// once.
#pragma once

#include <cstdint>

namespace move_base_abstract::lockstep::internal {

/**
 * @brief Send STOPPING over a connection when a signal tells the process to end.
 *
 * Then the earlier handler of the signal is called. If there was none, the signal ends the process
 * as usual. An ignored signal stays ignored. One connection per process.
 *
 * @param socket of the connection to the time master
 */
void announceStopSignals(int socket);

/** @brief Stop sending over a connection that is about to be closed. */
void forgetStopSignals(int socket);

/** @return whether SIGINT or SIGTERM has come. */
bool stopSignalCame();

/** @return the number of bytes that signals have sent over the connection. */
std::uint64_t stopSignalBytes();

/**
 * @brief Exists while the bytes of a frame are being sent, so that the bytes of another frame do
 * not come between them.
 */
class Sending {
 public:
  Sending();
  ~Sending();
  Sending(const Sending&) = delete;
  Sending& operator=(const Sending&) = delete;
};

}  // namespace move_base_abstract::lockstep::internal
