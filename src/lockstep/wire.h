// The frames between the time master and its participants, as bytes. No ROS, no sockets.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "clock/scaled_clock.h"

/**
 * Little endian throughout. A frame is u32 length of what follows, u8 type, body; a text or bytes
 * field is u32 length, then as many bytes; a text is UTF-8. Every std::string_view that a decoder
 * returns lies in the frame that was decoded, and is good as long as that is.
 */
namespace move_base_abstract::wire {

constexpr std::uint32_t kProtocol = 2;
/** Bytes after the length field. What is longer is refused before it is stored. */
constexpr std::uint32_t kLargestFrame = 256U * 1024 * 1024;
/** The same before HELLO, when anybody may be at the other end. */
constexpr std::uint32_t kLargestHello = 4096;

/** @brief What was wrong with a frame: what was got, what is allowed, and where. */
class MalformedFrame : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// ---- what a report contains ------------------------------------------------------------------
// `topic` and `service` are the participant's own numbers, one for each name; `sub` is the index
// of the robot within a fleet (0 for others).

struct Advertise {
  std::uint32_t topic = 0;
  std::uint32_t sub = 0;
  std::string_view name;
  std::string_view type;
  std::string_view md5;
  bool latched = false;
  std::string_view definition;
};

struct Unadvertise {
  std::uint32_t topic = 0;
};

struct Subscribe {
  std::uint32_t topic = 0;
  std::uint32_t sub = 0;
  std::string_view name;
  std::string_view md5;  // "*" takes any type
};

struct Unsubscribe {
  std::uint32_t topic = 0;
};

struct Send {
  std::uint32_t topic = 0;
  std::uint32_t sub = 0;
  std::uint32_t target = 0;  // id of the only receiver, or 0: all members that subscribe
  std::string_view payload;
};

struct Serve {
  std::uint32_t service = 0;
  std::uint32_t sub = 0;
  std::string_view name;
};

struct Unserve {
  std::uint32_t service = 0;
};

struct Call {
  std::uint32_t number = 0;  // the caller's own, counts up
  std::uint32_t sub = 0;
  std::string_view service;  // name
  std::string_view request;
};

struct Response {
  std::uint32_t caller = 0;  // id
  std::uint32_t number = 0;  // the caller's
  bool ok = false;
  std::string_view bytes;  // response, or the text of the error
};

struct Log {
  std::uint32_t sub = 0;
  std::string_view robot;
  std::string_view kind;
  std::string_view values;  // a JSON array
};

enum class NoteKind : std::uint8_t {
  kWaitsFor = 1,
  kNotRepeatable = 2,
  kDegraded = 3,
};

struct Note {
  NoteKind what = NoteKind::kWaitsFor;
  std::string_view text;
};

struct Watch {
  std::string_view service;  // name
};

using ReportItem = std::variant<Advertise, Unadvertise, Subscribe, Unsubscribe, Send, Serve,
                                Unserve, Call, Response, Log, Note, Watch>;

// ---- what a grant contains -------------------------------------------------------------------
// `topic` and `service` are the numbers of the participant that gets the grant.

struct Publisher {
  std::uint32_t topic = 0;
  std::uint32_t sender = 0;  // id
  std::string_view type;
  std::string_view md5;
  bool latched = false;
  std::string_view definition;
};

struct NoPublisher {
  std::uint32_t topic = 0;
  std::uint32_t sender = 0;
};

struct Subscriber {
  std::uint32_t topic = 0;
  std::uint32_t receiver = 0;  // id
};

struct NoSubscriber {
  std::uint32_t topic = 0;
  std::uint32_t receiver = 0;
};

struct Deliver {
  std::uint32_t topic = 0;
  std::uint32_t sender = 0;
  std::string_view payload;
};

struct CallIn {
  std::uint32_t service = 0;
  std::uint32_t caller = 0;  // id
  std::uint32_t number = 0;  // the caller's
  std::string_view request;
};

enum class CallStatus : std::uint8_t {
  kError = 0,      // the bytes are the server's text
  kOk = 1,         // the bytes are the response
  kNoServer = 2,   // no member serves it
  kServerGone = 3  // it left, died or stopped serving before it answered
};

struct Answer {
  std::uint32_t number = 0;
  CallStatus status = CallStatus::kError;
  std::string_view bytes;
};

struct Found {
  std::string_view service;
};

using GrantItem =
    std::variant<Publisher, NoPublisher, Subscriber, NoSubscriber, Deliver, CallIn, Answer, Found>;

// ---- frames ----------------------------------------------------------------------------------

struct Hello {
  std::uint32_t protocol = kProtocol;
  std::string_view name;
  std::string_view node_uri;
  std::int32_t rank = 0;
  bool rank_declared = false;
  std::uint64_t incarnation = 0;
  std::string_view secret;  // of the run; empty: none
};

struct Report {
  std::uint64_t round = 0;
  bool leaving = false;           // this report is the last
  Nanoseconds next_ns = kNever;   // simulated; not after the present: once more at this instant
  std::uint32_t open = 0;         // application threads that wait without end
  std::vector<ReportItem> items;  // in the order in which they were done
};

struct Knock {};

struct Leave {
  std::string_view reason;
};

struct Welcome {
  std::uint32_t own_id = 0;
};

struct Member {
  std::uint32_t id = 0;
  std::string_view name;
  std::string_view node_uri;
};

struct Gone {
  std::uint32_t id = 0;
};

struct Grant {
  std::uint64_t round = 0;
  Nanoseconds time_ns = 0;
  std::uint32_t microstep = 0;
  std::vector<GrantItem> items;  // in the order in which they are to be handled
};

struct End {
  std::string_view reason;
};

using ParticipantFrame = std::variant<Hello, Report, Knock, Leave>;
using MasterFrame = std::variant<Welcome, Member, Gone, Grant, End>;

/** @return the whole frame, its length included. */
std::string encode(const ParticipantFrame& frame);
std::string encode(const MasterFrame& frame);

/** @brief Append one item, so that a frame can be built while its items come up. */
void append(std::string& items, const ReportItem& item);
void append(std::string& items, const GrantItem& item);

/** @return a whole frame around @p items (see append); the items of @p head are left out. */
std::string encodeReport(const Report& head, std::string_view items);
std::string encodeGrant(const Grant& head, std::string_view items);

/** @return whether the frame (type and body) is a REPORT, well-formed or not. */
bool isReport(std::string_view frame);

/**
 * @param frame type and body, without the length (see FrameBuffer).
 * @throws MalformedFrame where it is not exactly one frame of that direction.
 */
ParticipantFrame decodeFromParticipant(std::string_view frame);
MasterFrame decodeFromMaster(std::string_view frame);

/** @brief Puts the frames of one direction of one connection together again. */
class FrameBuffer {
 public:
  void append(std::string_view bytes) { bytes_.append(bytes); }

  /**
   * @return type and body of the next complete frame, if there is one; good until the next call.
   * @throws MalformedFrame where the length is 0 or over @p largest; no frame comes after that.
   */
  std::optional<std::string_view> next(std::uint32_t largest = kLargestFrame);

  /** @return how many bytes of an incomplete frame wait here (after next() had nothing to give). */
  std::size_t waiting() const { return bytes_.size() - begin_; }

 private:
  std::string bytes_;
  std::size_t begin_ = 0;
};

}  // namespace move_base_abstract::wire

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_WIRE_H
