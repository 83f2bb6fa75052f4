// The sockets of the event-driven clock: one thread around a LockstepSession. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_LOCKSTEP_SERVER_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_LOCKSTEP_SERVER_H

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

#include "core_keeper.h"
#include "lockstep/session.h"
#include "sockets.h"

namespace move_base_abstract {

/**
 * @brief Listens on a TCP port and hands bytes to a session and back, with one wait, one receive,
 * one decision and one send for each hop.
 *
 * Threading: the session belongs to a mutex. The server's thread takes it for each piece of work;
 * others get at the session by with(), which may be called from any thread.
 */
class LockstepServer {
 public:
  /** @brief Called by the server's thread, with the session locked: they must not wait for others
   * who wait for it. */
  struct Listeners {
    std::function<void(Nanoseconds)> time;               // simulated time, when it has changed
    std::function<void(const LockstepLogEntry&)> event;  // a line of the event log
    // What was set and deleted, before the grants that follow from it; returns what was not taken.
    std::function<std::vector<ParameterChange>(const std::vector<ParameterChange>&)> parameters;
  };

  /**
   * @param host name or address to bind to; @param port 0: any free one.
   * @param cores on which participants of this computer run.
   * @throws std::invalid_argument as LockstepSession does, std::runtime_error if it cannot listen.
   */
  LockstepServer(const LockstepSettings& settings, const std::string& host, int port,
                 CoresWish cores, Listeners listeners);
  /** Ends the run, if nobody did; see finish(). */
  ~LockstepServer();

  LockstepServer(const LockstepServer&) = delete;
  LockstepServer& operator=(const LockstepServer&) = delete;

  /** @return "host:port", for participants. */
  const std::string& address() const { return address_; }

  /** @brief Do @p action(session) and have decided what follows from it. */
  template <typename Action>
  auto with(Action action) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Waker waker{*this};  // whatever comes of it, also an exception
    return action(session_);
  }

  /** @return what is so, as of the latest call or the latest piece of work. */
  LockstepStatus status() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake();  // where nothing comes in, the session learns only so how late it is
    return session_.status();
  }

  /** @return on which cores the participants of this computer run. */
  std::string cores() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return cores_.text();
  }

  Nanoseconds now() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return session_.now();
  }

  std::vector<LockstepMessage> takeMessages();

  /** @brief Tell all participants that the run is over, and why; after a wall second at most, end
   * the thread. What they have reported until then is in the log. */
  void finish(const std::string& reason);

 private:
  struct Waker {
    LockstepServer& server;
    ~Waker() { server.wake(); }
  };

  enum class Reports { kNone, kSome, kAll };

  struct Connection {
    Descriptor socket;
    std::string unsent;
    std::optional<pid_t> process;  // of a participant; 0: on another computer
    bool closing = false;          // the session has done with it: sent to the end, then closed
    Nanoseconds close_due = 0;     // wall; of one that is closing
    bool awaits_space = false;     // asked to be told when it takes bytes again
  };

  void watch(int fd, std::uint64_t id, std::uint32_t events, int operation);
  void wake() const;
  void run();
  void arm(Nanoseconds due);
  void work();
  void handle(std::uint64_t id, std::uint32_t events, Nanoseconds wall);
  Reports awaitReports();
  bool isReadable(const Descriptor& socket) const;
  void acceptAll(const Descriptor& listener, Nanoseconds wall);
  bool accept(const Descriptor& listener, Nanoseconds wall);
  bool mayListen() const;
  void listenOrNot();
  void receive(ConnectionId id, Connection& connection, Nanoseconds wall);
  void lose(ConnectionId id, Nanoseconds wall);
  void forget(ConnectionId id);
  void send(LockstepSession::Output& output);
  void sendMore(ConnectionId id, Connection& connection);
  void keepCores(Nanoseconds wall);
  void closeOverdue(Nanoseconds wall);
  void tellListeners();
  void tellOfParameters();

  mutable std::mutex mutex_;
  LockstepSession session_;
  CoreKeeper cores_;
  Listeners listeners_;
  Descriptor listener_;
  const std::string address_;
  Descriptor
      local_listener_;  // for participants on this computer; none where there is no such socket
  Descriptor epoll_;
  Descriptor event_;
  Descriptor timer_;
  bool listening_ = true;
  bool exhausted_ = false;      // no free file descriptors; the next that is closed ends it
  Nanoseconds armed_ = kNever;  // wall
  std::unordered_map<ConnectionId, Connection> connections_;
  std::vector<ConnectionId> closing_;
  ConnectionId last_awaited_ = 0;  // who is likely to report last; 0: nobody owes a report
  Nanoseconds look_due_ = 0;       // wall; when everything else is looked at, at the latest
  ConnectionId last_id_;
  std::vector<char> buffer_;
  std::vector<LockstepMessage> messages_;
  Nanoseconds told_ = 0;  // simulated
  std::atomic<bool> stopping_{false};
  std::thread thread_;  // last: it uses the others
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_LOCKSTEP_SERVER_H
