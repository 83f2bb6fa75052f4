#include "shared_channel.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <cstring>
#include <ctime>
#include <new>
#include <utility>

#include "libc/ask_kernel.h"

namespace move_base_abstract {
namespace {

constexpr std::uint32_t kMark = 0x6d626132;  // of this layout
constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
constexpr int kMostPieces = 64;    // of one merge; ours are two at most, as each has an answer
constexpr std::size_t kLine = 64;  // bytes of a line of the processor's cache

enum State : std::uint32_t { kEmpty, kFull, kBeingTaken };

using Number = std::atomic<std::uint32_t>;
static_assert(Number::is_always_lock_free, "processes share these numbers");

}  // namespace

// ---- sleeping --------------------------------------------------------------------------------

void Sleeper::call() {
  ++calls_;
  if (is_asleep_ != 0) {
    askKernel(SYS_futex, reinterpret_cast<long>(&calls_), FUTEX_WAKE, INT_MAX);
  }
}

void Sleeper::sleep(std::uint32_t seen, int timeout_ms) {
  const timespec timeout{timeout_ms / 1000, (timeout_ms % 1000) * 1'000'000L};
  is_asleep_ = 1;
  askKernel(SYS_futex, reinterpret_cast<long>(&calls_), FUTEX_WAIT, seen,
            timeout_ms < 0 ? 0 : reinterpret_cast<long>(&timeout));
  is_asleep_ = 0;
}

/** @brief One direction. From `after` on it is written by the writer, before that by both sides. */
struct alignas(kLine) SharedChannel::Box {
  Number state{kEmpty};
  Number news{0};    // wake-ups for something else than a piece
  Number reader{0};  // the place of the thread that reads
  Number is_asleep{0};
  std::array<Sleeper, kPlaces> sleepers;
  alignas(kLine) std::uint64_t after = 0;
  std::uint64_t size = 0;
  std::array<char, kMostBytes> bytes;
};

struct SharedChannel::Memory {
  std::uint32_t mark = kMark;
  Number is_used{0};
  Directions directions;
  Box to_master;
  Box to_participant;
};

std::unique_ptr<SharedChannel> SharedChannel::make(int* file) {
  *file = ::memfd_create("move_base_abstract", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (*file < 0) {
    return nullptr;
  }
  void* const place =
      ::ftruncate(*file, sizeof(Memory)) == 0 && ::fcntl(*file, F_ADD_SEALS, kSeals) == 0
          ? ::mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE, MAP_SHARED, *file, 0)
          : MAP_FAILED;
  if (place == MAP_FAILED) {
    ::close(*file);
    *file = -1;
    return nullptr;
  }
  auto* const memory = new (place) Memory;
  memory->to_participant.is_asleep = 1;  // until it knows that the memory is used
  return std::unique_ptr<SharedChannel>(new SharedChannel(memory, Side::kParticipant));
}

std::unique_ptr<SharedChannel> SharedChannel::use(int file) {
  struct stat about {};
  const int seals = ::fcntl(file, F_GET_SEALS);
  if (seals < 0 || (seals & kSeals) != kSeals || ::fstat(file, &about) != 0 ||
      about.st_size != static_cast<off_t>(sizeof(Memory))) {
    return nullptr;
  }
  void* const place = ::mmap(nullptr, sizeof(Memory), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (place == MAP_FAILED) {
    return nullptr;
  }
  auto* const memory = static_cast<Memory*>(place);
  std::unique_ptr<SharedChannel> channel(new SharedChannel(memory, Side::kTimeMaster));
  if (memory->mark != kMark) {
    return nullptr;
  }
  memory->is_used = 1;
  return channel;
}

SharedChannel::SharedChannel(Memory* memory, Side side)
    : memory_(memory),
      in_(side == Side::kTimeMaster ? &memory->to_master : &memory->to_participant),
      out_(side == Side::kTimeMaster ? &memory->to_participant : &memory->to_master) {}

SharedChannel::~SharedChannel() { ::munmap(memory_, sizeof(Memory)); }

bool SharedChannel::isUsed() const { return memory_->is_used != 0; }

// ---- writing ---------------------------------------------------------------------------------

bool SharedChannel::put(std::string_view bytes, std::uint64_t after,
                        std::optional<std::uint32_t> topic) {
  if (bytes.size() > kMostBytes || out_->state != kEmpty || out_->is_asleep != 0) {
    return false;
  }
  out_->after = after;
  out_->size = bytes.size();
  bytes.copy(out_->bytes.data(), bytes.size());
  out_->state = kFull;
  // The reader may have fallen asleep meanwhile. It looks once more after it has said so, and this
  // side looks once more after it has written: one of them notices.
  if (out_->is_asleep != 0 && takeBack(out_)) {
    return false;
  }
  const std::uint32_t thread = threadFor(topic);
  thread == 0 ? callReader(out_) : out_->sleepers[thread].call();
  return true;
}

/** @return the place of the thread that goes on with a grant; 0: not known. */
std::uint32_t SharedChannel::threadFor(std::optional<std::uint32_t> topic) const {
  const Directions& to = memory_->directions;
  if (!topic || *topic >= to.queue_of_topic.size()) {
    return 0;
  }
  const auto of_queue = [&to](std::size_t queue) -> const Directions::Number& {
    return to.thread_of_queue[queue % to.thread_of_queue.size()];
  };
  return (*topic == 0 ? to.thread_at_wake : of_queue(to.queue_of_topic[*topic])) % kPlaces;
}

bool SharedChannel::takeBack(Box* box) {
  std::uint32_t full = kFull;
  return box->state.compare_exchange_strong(full, kEmpty);
}

void SharedChannel::wake() {
  ++out_->news;
  callReader(out_);
}

void SharedChannel::wakeSelf() {
  ++in_->news;
  callReader(in_);
}

void SharedChannel::callReader(Box* box) { box->sleepers[box->reader % kPlaces].call(); }

// ---- reading ---------------------------------------------------------------------------------

bool SharedChannel::hasPiece() const { return in_->state == kFull; }

std::optional<std::uint64_t> SharedChannel::place() const {
  return hasPiece() ? std::optional<std::uint64_t>(in_->after) : std::nullopt;
}

std::optional<SharedChannel::Piece> SharedChannel::take(std::uint64_t end) {
  std::uint32_t full = kFull;
  if (!in_->state.compare_exchange_strong(full, kBeingTaken)) {
    return std::nullopt;
  }
  const std::uint64_t after = in_->after;
  if (after > end) {
    in_->state = kFull;
    return std::nullopt;
  }
  const std::size_t size = in_->size;
  taken_.assign(in_->bytes.data(), size <= kMostBytes ? size : 0);
  in_->state = kEmpty;
  return Piece{after, taken_};
}

void SharedChannel::wait(int timeout_ms, Place* place) {
  Sleeper& sleeper = in_->sleepers[place->number];
  place->seen = place->number == 0 ? sleeper.calls() : place->seen;
  in_->reader = place->number;
  if (!hasPiece() && in_->news == news_) {
    sleeper.sleep(place->seen, timeout_ms);
  }
  place->seen = sleeper.calls();
}

bool SharedChannel::takeNews() {
  const std::uint32_t before = std::exchange(news_, in_->news.load());
  return news_ != before;
}

void SharedChannel::setAsleep(bool is_asleep) { in_->is_asleep = is_asleep ? 1 : 0; }

Sleeper& SharedChannel::sleeper(std::uint32_t place) {
  return memory_->to_participant.sleepers[place];
}

Directions& SharedChannel::directions() { return memory_->directions; }

// ---- descriptors over a socket ---------------------------------------------------------------

namespace {

/** @brief A message with room for one descriptor. (Alignment makes it two.) */
struct Envelope {
  Envelope(const char* data, std::size_t size) : bytes{const_cast<char*>(data), size} {
    message.msg_iov = &bytes;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
  }

  iovec bytes;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr message{};
};

}  // namespace

ssize_t sendWithFile(int socket, std::string_view bytes, int file) {
  Envelope envelope(bytes.data(), bytes.size());
  cmsghdr* const header = CMSG_FIRSTHDR(&envelope.message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof(file));
  std::memcpy(CMSG_DATA(header), &file, sizeof(file));
  return ::sendmsg(socket, &envelope.message, MSG_NOSIGNAL);
}

ssize_t receiveWithFile(int socket, char* bytes, std::size_t size, int* file) {
  *file = -1;
  Envelope envelope(bytes, size);
  const ssize_t got = ::recvmsg(socket, &envelope.message, MSG_CMSG_CLOEXEC);
  cmsghdr* const header = got >= 0 ? CMSG_FIRSTHDR(&envelope.message) : nullptr;
  if (header == nullptr || header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_RIGHTS) {
    return got;
  }
  const std::size_t count = (header->cmsg_len - CMSG_LEN(0)) / sizeof(*file);
  for (std::size_t k = 0; k < count; ++k) {
    if (*file >= 0) {
      ::close(*file);
    }
    std::memcpy(file, CMSG_DATA(header) + k * sizeof(*file), sizeof(*file));
  }
  return got;
}

// ---- one stream ------------------------------------------------------------------------------

std::uint64_t merge(SharedChannel* channel, std::uint64_t read, std::string_view got,
                    const std::function<void(std::string_view)>& pass) {
  const std::uint64_t end = read + got.size();
  const auto pass_until = [&](std::uint64_t place) {
    const std::size_t size = place > read ? static_cast<std::size_t>(place - read) : 0;
    if (size > 0) {
      pass(got.substr(0, size));
      got.remove_prefix(size);
      read = place;
    }
  };
  for (int k = 0; channel != nullptr && k < kMostPieces; ++k) {
    const auto piece = channel->take(end);
    if (!piece) {
      break;
    }
    pass_until(piece->after);
    pass(piece->bytes);
  }
  pass_until(end);
  return end;
}

}  // namespace move_base_abstract
