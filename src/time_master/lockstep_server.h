// The sockets of the event-driven clock: one thread around a LockstepSession. No ROS.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cores/core_keeper.h"
#include "lockstep/session.h"
#include "participant_stream.h"
#include "sockets.h"

namespace move_base_abstract {

/**
 * @brief Listens on a TCP port, and passes bytes between connections and a session. Each hop of a
 * message takes one wait, one receive, one decision and one send.
 *
 * Threading: a mutex protects the session. The server's thread locks it for each piece of work.
 * Other threads use the session through with(), which any thread may call.
 */
class LockstepServer {
 public:
  /**
   * @brief Functions that the server's thread calls with the session locked. They must not wait for
   * a thread that waits for the session.
   */
  struct Listeners {
    std::function<void(Nanoseconds)> time;               // simulated time has changed
    std::function<void(const LockstepLogEntry&)> event;  // a line of the event log
    // Changes of parameters, before the grants that follow from them; returns those that were not
    // accepted.
    std::function<std::vector<ParameterChange>(const std::vector<ParameterChange>&)> parameters;
  };

  /** @brief How participants on this computer are treated. */
  struct Local {
    bool uses_all_cores = false;  // or they are kept on one core, unless there is a lookahead
    bool shares_memory = true;    // whether they may report through shared memory
  };

  /**
   * @param host the name or address to bind to.
   * @param port the TCP port; 0: any free one.
   * @throws std::invalid_argument as LockstepSession does.
   * @throws std::runtime_error if it cannot listen.
   */
  LockstepServer(const LockstepSettings& settings, const std::string& host, int port, Local local,
                 Listeners listeners);
  /** Ends the run, if it has not ended; see finish(). */
  ~LockstepServer();

  LockstepServer(const LockstepServer&) = delete;
  LockstepServer& operator=(const LockstepServer&) = delete;

  /** @return "host:port", for participants. */
  const std::string& address() const { return address_; }

  /** @brief Call @p action(session), and let the server's thread decide what follows. */
  template <typename Action>
  auto with(Action action) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Waker waker{*this};  // after an exception, too
    return action(session_);
  }

  /** @return the state as of the latest call or the latest piece of work. */
  LockstepStatus status() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake();  // without input, only this tells the session how late it is
    return session_.status();
  }

  /** @return the cores on which the participants of this computer run, see CoreKeeper::text(). */
  std::string cores() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return cores_.text();
  }

  Nanoseconds now() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return session_.now();
  }

  std::vector<LockstepMessage> takeMessages();

  /**
   * @brief Tell all participants that the run is over, and why. After a wall second at most, end
   * the thread. The log has what they have reported until then.
   */
  void finish(const std::string& reason);

 private:
  struct Waker {
    LockstepServer& server;
    ~Waker() { server.wake(); }
  };

  enum class Reports { kNone, kSome, kAll };

  struct Connection {
    ParticipantStream stream;
    std::optional<pid_t> process;  // of a participant; 0: on another computer
    bool closing = false;          // the session has closed it: the rest is sent first
    Nanoseconds close_due = 0;     // wall; if it is closing
    bool awaits_space = false;     // waits until the socket takes bytes again
  };

  void watch(int fd, std::uint64_t id, std::uint32_t events, int operation);
  void wake() const;
  void run();
  void arm(Nanoseconds due);
  void work();
  void handle(std::uint64_t id, std::uint32_t events, Nanoseconds wall);
  Reports awaitReports();
  bool fallAsleep();
  void wakeUp(Nanoseconds wall);
  void acceptAll(const Descriptor& listener, Nanoseconds wall);
  bool accept(const Descriptor& listener, Nanoseconds wall);
  bool mayListen() const;
  void listenOrNot();
  void receive(ConnectionId id, Connection& connection, Nanoseconds wall);
  void lose(ConnectionId id, Nanoseconds wall);
  void forget(ConnectionId id);
  void send(LockstepSession::Output& output);
  void afterSending(ConnectionId id, Connection& connection);
  void keepCores(Nanoseconds wall);
  void closeOverdue(Nanoseconds wall);
  void tellListeners();
  void tellOfParameters();

  mutable std::mutex mutex_;
  LockstepSession session_;
  const bool shares_memory_;
  CoreKeeper cores_;
  Listeners listeners_;
  Descriptor listener_;
  const std::string address_;
  Descriptor local_listener_;  // for participants on this computer; may be none
  Descriptor epoll_;
  Descriptor event_;
  Descriptor timer_;
  bool listening_ = true;
  bool exhausted_ = false;      // no free file descriptors, until one is closed
  Nanoseconds armed_ = kNever;  // wall
  std::unordered_map<ConnectionId, Connection> connections_;
  std::vector<ConnectionId> closing_;
  ConnectionId last_awaited_ = 0;  // likely to report last; 0: no report is owed
  Nanoseconds look_due_ = 0;       // wall; when to look at everything else, at the latest
  ConnectionId last_id_;
  std::vector<char> buffer_;
  std::vector<LockstepMessage> messages_;
  Nanoseconds told_ = 0;  // simulated
  std::atomic<bool> stopping_{false};
  std::thread thread_;  // last, as it uses the other members
};

}  // namespace move_base_abstract
