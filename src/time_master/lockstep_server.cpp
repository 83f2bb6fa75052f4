#include "lockstep_server.h"

#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "lockstep/welcome.h"
#include "wall_now.h"

namespace move_base_abstract {
namespace {

constexpr std::uint64_t kListener = 0;
constexpr std::uint64_t kEvent = 1;
constexpr std::uint64_t kTimer = 2;
constexpr std::uint64_t kLocalListener = 3;
constexpr ConnectionId kFirstConnection = 4;

constexpr std::size_t kBufferSize = 1 << 18;  // bytes received at once
constexpr int kMostReceives = 64;             // of one connection in a row
constexpr std::size_t kMostStrangers = 256;   // connections without a HELLO
constexpr std::size_t kMostConnections = 4096;
constexpr int kRoundPatience = 1;               // ms, wall; see awaitReports()
constexpr Nanoseconds kLookPeriod = 1'000'000;  // wall, while one round follows another
constexpr Nanoseconds kFinishLimit = kNanosecondsPerSecond;  // wall, for the last bytes to all

}  // namespace

LockstepServer::LockstepServer(const LockstepSettings& settings, const std::string& host, int port,
                               Local local, Listeners listeners)
    : session_(settings, wallNow()),
      shares_memory_(local.shares_memory),
      cores_(local.uses_all_cores || settings.lookahead > 0),
      listeners_(std::move(listeners)),
      listener_(listenOn(host, port)),
      address_(host + ":" + std::to_string(portOf(listener_))),
      local_listener_(listenLocally(address_)),
      epoll_(checked(epoll_create1(EPOLL_CLOEXEC), "epoll")),
      event_(checked(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd")),
      timer_(checked(timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK), "timerfd")),
      last_id_(kFirstConnection),
      buffer_(kBufferSize) {
  watch(listener_.get(), kListener, EPOLLIN, EPOLL_CTL_ADD);
  if (local_listener_.get() >= 0) {
    watch(local_listener_.get(), kLocalListener, EPOLLIN, EPOLL_CTL_ADD);
  }
  watch(event_.get(), kEvent, EPOLLIN, EPOLL_CTL_ADD);
  watch(timer_.get(), kTimer, EPOLLIN, EPOLL_CTL_ADD);
  wake();  // so that the thread asks for the session's first wake-up
  thread_ = std::thread([this] { run(); });
}

LockstepServer::~LockstepServer() { finish("the time master ends"); }

void LockstepServer::watch(int fd, std::uint64_t id, std::uint32_t events, int operation) {
  epoll_event event{};
  event.events = events;
  event.data.u64 = id;
  epoll_ctl(epoll_.get(), operation, fd, &event);
}

void LockstepServer::wake() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(event_.get(), &one, sizeof(one));
}

std::vector<LockstepMessage> LockstepServer::takeMessages() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(messages_, {});
}

void LockstepServer::finish(const std::string& reason) {
  if (!thread_.joinable()) {
    return;
  }
  with([&](LockstepSession& session) { session.endFromOutside(reason); });
  stopping_ = true;
  wake();
  thread_.join();
}

void LockstepServer::run() {
  cores_.begin();
  std::array<epoll_event, 64> events;
  Nanoseconds stop_due = kNever;
  while (wallNow() < stop_due) {
    const Reports reports = awaitReports();
    int count = 0;
    if (reports != Reports::kAll || wallNow() >= look_due_) {
      const bool is_asleep = reports == Reports::kNone && fallAsleep();
      const int patience = is_asleep ? -1 : 0;
      count = epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), patience);
      look_due_ = wallNow() + kLookPeriod;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    const Nanoseconds wall = wallNow();
    for (int index = 0; index < count; ++index) {
      const epoll_event& event = events[static_cast<std::size_t>(index)];
      handle(event.data.u64, event.events, wall);
    }
    if (reports == Reports::kNone) {
      wakeUp(wall);
    }
    work();
    if (stopping_) {
      if (connections_.empty()) {
        return;
      }
      stop_due = std::min(stop_due, wall + kFinishLimit);
    }
    arm(std::min({stop_due, session_.nextWake(), cores_.due()}));
    last_awaited_ = session_.lastAwaited();
  }
}

/**
 * @brief Read the reports of a round, and begin with the one that is likely to come last. To be
 * woken by each report, and to ask the kernel which sockets are readable, would cost more than the
 * reports.
 *
 * This does not wait for long, because everything else is handled only afterwards, and it ends in
 * time although a participant sends other things without end.
 */
LockstepServer::Reports LockstepServer::awaitReports() {
  Reports reports = Reports::kNone;
  bool is_likely_there = false;  // the others, once the last report is there
  for (ConnectionId id = last_awaited_; id != 0;) {
    const auto found = connections_.find(id);
    if (found == connections_.end() ||
        (!is_likely_there && !found->second.stream.await(event_.get(), kRoundPatience))) {
      return reports;
    }
    const Nanoseconds wall = wallNow();
    const std::lock_guard<std::mutex> lock(mutex_);
    receive(id, found->second, wall);
    reports = Reports::kSome;
    const ConnectionId next = session_.lastAwaited();
    is_likely_there = next != id;
    if (!is_likely_there && wall >= look_due_) {
      return reports;
    }
    id = next;
  }
  return reports == Reports::kNone ? reports : Reports::kAll;
}

/**
 * @brief Have all participants report over their sockets, so that each wakes this thread.
 * @return whether nothing has come by another way until then.
 */
bool LockstepServer::fallAsleep() {
  bool is_quiet = true;
  for (auto& [id, connection] : connections_) {
    connection.stream.setAsleep(true);
    is_quiet = is_quiet && !connection.stream.hasPiece();
  }
  return is_quiet;
}

void LockstepServer::wakeUp(Nanoseconds wall) {
  std::vector<ConnectionId> ready;
  for (auto& [id, connection] : connections_) {
    connection.stream.setAsleep(false);
    if (connection.stream.hasPiece()) {
      ready.push_back(id);
    }
  }
  for (const ConnectionId id : ready) {
    receive(id, connections_.at(id), wall);
  }
}

/** @brief Ask for a wake-up. If an earlier one is set already, it stays: it costs only a look. */
void LockstepServer::arm(Nanoseconds due) {
  if (!closing_.empty()) {
    due = std::min(due, connections_.at(closing_.front()).close_due);
  }
  if (due >= armed_) {
    return;
  }
  armed_ = due;
  itimerspec when{};
  const Nanoseconds at = std::max<Nanoseconds>(due, 1);  // 0 would switch the timer off
  when.it_value.tv_sec = at / kNanosecondsPerSecond;
  when.it_value.tv_nsec = at % kNanosecondsPerSecond;
  timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &when, nullptr);
}

void LockstepServer::work() {
  const Nanoseconds wall = wallNow();
  std::vector<LockstepSession::Output> outputs = session_.poll(wall);
  tellOfParameters();
  keepCores(wall);
  for (LockstepSession::Output& output : outputs) {
    send(output);
  }
  tellListeners();
  closeOverdue(wall);
  listenOrNot();
}

/** @brief Let the core keeper work while no participant does: the decisions are not sent yet. */
void LockstepServer::keepCores(Nanoseconds wall) {
  if (session_.ended()) {
    cores_.end();
  } else {
    cores_.follow(session_.rounds(), session_.owing(), wall);
  }
}

void LockstepServer::tellOfParameters() {
  const std::vector<ParameterChange> changes = session_.takeParameters();
  if (changes.empty()) {
    return;
  }
  for (const ParameterChange& change : listeners_.parameters(changes)) {
    session_.parameterNotTaken(change);
  }
}

void LockstepServer::tellListeners() {
  for (const LockstepLogEntry& entry : session_.takeLog()) {
    listeners_.event(entry);
  }
  for (LockstepMessage& message : session_.takeMessages()) {
    messages_.push_back(std::move(message));
  }
  if (session_.now() == told_) {
    return;
  }
  const LockstepPhase phase = session_.phase();
  const bool never_started = phase == LockstepPhase::kEnded && told_ == 0;
  if (phase != LockstepPhase::kWaitingForParticipants && !never_started) {
    told_ = session_.now();
    listeners_.time(told_);
  }
}

void LockstepServer::handle(std::uint64_t id, std::uint32_t events, Nanoseconds wall) {
  std::uint64_t ignored = 0;
  if (id == kListener) {
    acceptAll(listener_, wall);
  } else if (id == kLocalListener) {
    acceptAll(local_listener_, wall);
  } else if (id == kEvent) {
    [[maybe_unused]] const auto got = read(event_.get(), &ignored, sizeof(ignored));
  } else if (id == kTimer) {
    [[maybe_unused]] const auto got = read(timer_.get(), &ignored, sizeof(ignored));
    armed_ = kNever;
  } else if (const auto found = connections_.find(id); found != connections_.end()) {
    if ((events & EPOLLOUT) != 0) {
      found->second.stream.sendMore();
      afterSending(id, found->second);
    }
    if ((events & (EPOLLIN | EPOLLERR | EPOLLHUP)) != 0) {
      receive(id, found->second, wall);
    }
  }
}

void LockstepServer::acceptAll(const Descriptor& listener, Nanoseconds wall) {
  while (mayListen() && accept(listener, wall)) {
  }
}

/** @return whether more connections can be accepted. Others wait in the kernel's queue. */
bool LockstepServer::mayListen() const {
  return !exhausted_ && session_.strangers() < kMostStrangers &&
         connections_.size() < kMostConnections;
}

/**
 * @brief Watch the listening sockets only while connections can be accepted. Otherwise one that
 * waits would wake the thread all the time.
 */
void LockstepServer::listenOrNot() {
  if (mayListen() != listening_) {
    listening_ = !listening_;
    const std::uint32_t events = listening_ ? EPOLLIN : 0U;
    watch(listener_.get(), kListener, events, EPOLL_CTL_MOD);
    if (local_listener_.get() >= 0) {
      watch(local_listener_.get(), kLocalListener, events, EPOLL_CTL_MOD);
    }
  }
}

bool LockstepServer::accept(const Descriptor& listener, Nanoseconds wall) {
  Descriptor fd(accept4(listener.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (fd.get() < 0) {
    if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
      exhausted_ = true;
      messages_.push_back({LockstepMessage::Level::kError,
                           std::string("the connection of a participant cannot be accepted: ") +
                               std::strerror(errno)});
      return false;
    }
    return errno == ECONNABORTED || errno == EINTR;
  }
  tuneConnection(fd);
  const ConnectionId id = ++last_id_;
  watch(fd.get(), id, EPOLLIN, EPOLL_CTL_ADD);
  connections_[id].stream = ParticipantStream(std::move(fd));
  session_.connect(id, wall);
  return true;
}

void LockstepServer::receive(ConnectionId id, Connection& connection, Nanoseconds wall) {
  const auto pass = [&](std::string_view bytes) {
    if (!connection.closing) {
      session_.received(id, bytes, wall);
    }
  };
  for (int k = 0; k < kMostReceives; ++k) {
    const auto received = connection.stream.receive(&buffer_, std::cref(pass));
    if (received == ParticipantStream::Received::kGone) {
      lose(id, wall);
      return;
    }
    if (!connection.process && session_.takesPart(id)) {
      connection.process = processOf(connection.stream.socket());
      cores_.join(*connection.process);
      connection.stream.endOffer(shares_memory_);
    }
    if (received == ParticipantStream::Received::kAll) {
      return;
    }
  }
}

void LockstepServer::lose(ConnectionId id, Nanoseconds wall) {
  session_.disconnected(id, wall);
  forget(id);
}

void LockstepServer::forget(ConnectionId id) {
  if (const auto found = connections_.find(id); found != connections_.end()) {
    cores_.leave(found->second.process.value_or(0));
  }
  connections_.erase(id);  // epoll forgets a closed descriptor by itself
  closing_.erase(std::remove(closing_.begin(), closing_.end(), id), closing_.end());
  exhausted_ = false;
}

void LockstepServer::send(LockstepSession::Output& output) {
  const auto found = connections_.find(output.connection);
  if (found == connections_.end()) {
    return;
  }
  Connection& connection = found->second;
  if (output.close) {
    connection.closing = true;
    connection.close_due = wallNow() + kLeaveLimit;
    closing_.push_back(output.connection);
  }
  connection.stream.send(std::move(output.bytes), output.close, output.topic);
  afterSending(output.connection, connection);
}

void LockstepServer::afterSending(ConnectionId id, Connection& connection) {
  const bool awaits_space = connection.stream.awaitsSpace();
  if (awaits_space != connection.awaits_space) {
    connection.awaits_space = awaits_space;
    watch(connection.stream.socket().get(), id, EPOLLIN | (awaits_space ? EPOLLOUT : 0U),
          EPOLL_CTL_MOD);
  }
  if (connection.closing && !awaits_space) {
    connection.stream.shutDown();
  }
}

/** @brief Close connections that got END and have not closed their side in time. */
void LockstepServer::closeOverdue(Nanoseconds wall) {
  while (!closing_.empty() && connections_.at(closing_.front()).close_due <= wall) {
    forget(closing_.front());
  }
}

}  // namespace move_base_abstract
