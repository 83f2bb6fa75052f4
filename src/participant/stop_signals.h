// SIGINT and SIGTERM, seen beside whoever handles them: the time master is told at once.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_STOP_SIGNALS_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_STOP_SIGNALS_H

namespace move_base_abstract::lockstep::internal {

/**
 * @brief Send STOPPING over a connection when a signal tells the process to end.
 *
 * What handled the signal before is called then; where nothing did, the process ends by it as ever.
 * A signal that is ignored stays so. One connection per process.
 *
 * @param socket of the connection to the time master
 */
void announceStopSignals(int socket);

/** @brief The connection is about to be closed. */
void forgetStopSignals(int socket);

/** @return whether such a signal has come. */
bool stopSignalCame();

/** @brief While bytes of a frame are on their way none of another one may come between them. */
class Sending {
 public:
  Sending();
  ~Sending();
  Sending(const Sending&) = delete;
  Sending& operator=(const Sending&) = delete;
};

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_STOP_SIGNALS_H
