#include "wire.h"

#include <type_traits>

namespace move_base_abstract::wire {
namespace {

enum FrameType : std::uint8_t {
  kHello = 1,
  kReport = 2,
  kKnock = 3,
  kLeave = 4,
  kWelcome = 16,
  kMember = 17,
  kGone = 18,
  kGrant = 19,
  kEnd = 20
};

constexpr std::uint8_t kLeavingFlag = 1;

/** @brief Text fields, which must be UTF-8; other string_views are plain bytes. */
struct Text {
  std::string_view& value;
};

// ---- one list of fields for each structure, which both writing and reading follow -------------

template <typename Visit>
void fields(Hello& hello, Visit&& visit) {
  visit("protocol", hello.protocol);
  visit("name", Text{hello.name});
  visit("node_uri", Text{hello.node_uri});
  visit("rank", hello.rank);
  visit("rank_declared", hello.rank_declared);
  visit("incarnation", hello.incarnation);
  visit("secret", hello.secret);
}

template <typename Visit>
void fields(Knock&, Visit&&) {}

template <typename Visit>
void fields(Leave& leave, Visit&& visit) {
  visit("reason", Text{leave.reason});
}

template <typename Visit>
void fields(Welcome& welcome, Visit&& visit) {
  visit("own_id", welcome.own_id);
}

template <typename Visit>
void fields(Member& member, Visit&& visit) {
  visit("id", member.id);
  visit("name", Text{member.name});
  visit("node_uri", Text{member.node_uri});
}

template <typename Visit>
void fields(Gone& gone, Visit&& visit) {
  visit("id", gone.id);
}

template <typename Visit>
void fields(End& end, Visit&& visit) {
  visit("reason", Text{end.reason});
}

template <typename Visit>
void fields(Advertise& item, Visit&& visit) {
  visit("topic", item.topic);
  visit("sub", item.sub);
  visit("name", Text{item.name});
  visit("type", Text{item.type});
  visit("md5", Text{item.md5});
  visit("latched", item.latched);
  visit("definition", Text{item.definition});
}

template <typename Visit>
void fields(Unadvertise& item, Visit&& visit) {
  visit("topic", item.topic);
}

template <typename Visit>
void fields(Subscribe& item, Visit&& visit) {
  visit("topic", item.topic);
  visit("sub", item.sub);
  visit("name", Text{item.name});
  visit("md5", Text{item.md5});
}

template <typename Visit>
void fields(Unsubscribe& item, Visit&& visit) {
  visit("topic", item.topic);
}

template <typename Visit>
void fields(Send& item, Visit&& visit) {
  visit("topic", item.topic);
  visit("sub", item.sub);
  visit("target", item.target);
  visit("payload", item.payload);
}

template <typename Visit>
void fields(Serve& item, Visit&& visit) {
  visit("service", item.service);
  visit("sub", item.sub);
  visit("name", Text{item.name});
}

template <typename Visit>
void fields(Unserve& item, Visit&& visit) {
  visit("service", item.service);
}

template <typename Visit>
void fields(Call& item, Visit&& visit) {
  visit("number", item.number);
  visit("sub", item.sub);
  visit("service", Text{item.service});
  visit("request", item.request);
}

template <typename Visit>
void fields(Response& item, Visit&& visit) {
  visit("caller", item.caller);
  visit("number", item.number);
  visit("ok", item.ok);
  visit("bytes", item.bytes);
}

template <typename Visit>
void fields(Log& item, Visit&& visit) {
  visit("sub", item.sub);
  visit("robot", Text{item.robot});
  visit("kind", Text{item.kind});
  visit("values", Text{item.values});
}

template <typename Visit>
void fields(Note& item, Visit&& visit) {
  visit("what", item.what);
  visit("text", Text{item.text});
}

template <typename Visit>
void fields(Watch& item, Visit&& visit) {
  visit("service", Text{item.service});
}

template <typename Visit>
void fields(Publisher& item, Visit&& visit) {
  visit("topic", item.topic);
  visit("sender", item.sender);
  visit("type", Text{item.type});
  visit("md5", Text{item.md5});
  visit("latched", item.latched);
  visit("definition", Text{item.definition});
}

template <typename Visit>
void fields(NoPublisher& item, Visit&& visit) {
  visit("topic", item.topic);
  visit("sender", item.sender);
}

template <typename Visit>
void fields(Subscriber& item, Visit&& visit) {
  visit("topic", item.topic);
  visit("receiver", item.receiver);
}

template <typename Visit>
void fields(NoSubscriber& item, Visit&& visit) {
  visit("topic", item.topic);
  visit("receiver", item.receiver);
}

template <typename Visit>
void fields(Deliver& item, Visit&& visit) {
  visit("topic", item.topic);
  visit("sender", item.sender);
  visit("payload", item.payload);
}

template <typename Visit>
void fields(CallIn& item, Visit&& visit) {
  visit("service", item.service);
  visit("caller", item.caller);
  visit("number", item.number);
  visit("request", item.request);
}

template <typename Visit>
void fields(Answer& item, Visit&& visit) {
  visit("number", item.number);
  visit("status", item.status);
  visit("bytes", item.bytes);
}

template <typename Visit>
void fields(Found& item, Visit&& visit) {
  visit("service", Text{item.service});
}

constexpr const char* kFrameNames[] = {"HELLO", "REPORT", "KNOCK", "LEAVE"};
constexpr const char* kMasterFrameNames[] = {"WELCOME", "MEMBER", "GONE", "GRANT", "END"};
constexpr const char* kReportItemNames[] = {"ADVERTISE", "UNADVERTISE", "SUBSCRIBE", "UNSUBSCRIBE",
                                            "SEND",      "SERVE",       "UNSERVE",   "CALL",
                                            "RESPONSE",  "LOG",         "NOTE",      "WATCH"};
constexpr const char* kGrantItemNames[] = {"PUBLISHER",     "NO_PUBLISHER", "SUBSCRIBER",
                                           "NO_SUBSCRIBER", "DELIVER",      "CALL",
                                           "RESPONSE",      "FOUND"};

// ---- writing ---------------------------------------------------------------------------------

template <typename Integer>
void putInteger(std::string& out, Integer value) {
  const auto bits = static_cast<std::make_unsigned_t<Integer>>(value);
  char bytes[sizeof(Integer)];
  for (std::size_t k = 0; k < sizeof(Integer); ++k) {
    bytes[k] = static_cast<char>((bits >> (8 * k)) & 0xFFU);
  }
  out.append(bytes, sizeof(Integer));
}

class Writer {
 public:
  explicit Writer(std::string& out) : out_(out) {}

  void operator()(const char*, Text text) { put(text.value); }
  void operator()(const char*, std::string_view bytes) { put(bytes); }
  void operator()(const char*, bool value) { putInteger<std::uint8_t>(out_, value ? 1 : 0); }
  void operator()(const char*, NoteKind what) { putEnum(what); }
  void operator()(const char*, CallStatus status) { putEnum(status); }
  template <typename Integer>
  std::enable_if_t<std::is_integral_v<Integer>> operator()(const char*, Integer value) {
    putInteger(out_, value);
  }

 private:
  void put(std::string_view bytes) {
    if (bytes.size() > kLargestFrame) {
      throw std::invalid_argument("a field must have at most " + std::to_string(kLargestFrame) +
                                  " bytes, got " + std::to_string(bytes.size()));
    }
    putInteger(out_, static_cast<std::uint32_t>(bytes.size()));
    out_.append(bytes);
  }
  template <typename Enum>
  void putEnum(Enum value) {
    putInteger(out_, static_cast<std::uint8_t>(value));
  }

  std::string& out_;
};

/** @brief Write all fields of @p value. (One list of fields serves reading too, hence the cast.) */
template <typename Structure>
void write(std::string& out, const Structure& value) {
  fields(const_cast<Structure&>(value), Writer(out));
}

constexpr std::size_t kLengthSize = 4;

/** @brief Put the length in front, for which open() left room. */
std::string closed(std::string frame) {
  const std::size_t length = frame.size() - kLengthSize;
  if (length > kLargestFrame) {
    throw std::invalid_argument("a frame must have at most " + std::to_string(kLargestFrame) +
                                " bytes, got " + std::to_string(length));
  }
  for (std::size_t k = 0; k < kLengthSize; ++k) {
    frame[k] = static_cast<char>((length >> (8 * k)) & 0xFFU);
  }
  return frame;
}

std::string opened(FrameType type, std::size_t body) {
  std::string frame;
  frame.reserve(kLengthSize + 1 + body);
  frame.assign(kLengthSize, '\0');
  frame.push_back(static_cast<char>(type));
  return frame;
}

template <typename Structure>
std::string encodeSimple(FrameType type, const Structure& frame) {
  std::string out = opened(type, 32);
  write(out, frame);
  return closed(std::move(out));
}

template <typename Items>
std::string joined(const Items& items) {
  std::string out;
  for (const auto& item : items) {
    append(out, item);
  }
  return out;
}

struct Encoder {
  std::string operator()(const Hello& frame) const { return encodeSimple(kHello, frame); }
  std::string operator()(const Report& frame) const {
    return encodeReport(frame, joined(frame.items));
  }
  std::string operator()(const Knock& frame) const { return encodeSimple(kKnock, frame); }
  std::string operator()(const Leave& frame) const { return encodeSimple(kLeave, frame); }
  std::string operator()(const Welcome& frame) const { return encodeSimple(kWelcome, frame); }
  std::string operator()(const Member& frame) const { return encodeSimple(kMember, frame); }
  std::string operator()(const Gone& frame) const { return encodeSimple(kGone, frame); }
  std::string operator()(const Grant& frame) const {
    return encodeGrant(frame, joined(frame.items));
  }
  std::string operator()(const End& frame) const { return encodeSimple(kEnd, frame); }
};

template <typename Item>
void appendItem(std::string& items, const Item& item) {
  items.push_back(static_cast<char>(item.index() + 1));  // kinds count from 1, in this order
  std::visit([&](const auto& value) { write(items, value); }, item);
}

// ---- reading ---------------------------------------------------------------------------------

bool continues(std::string_view text, std::size_t at, unsigned low, unsigned high) {
  if (at >= text.size()) {
    return false;
  }
  const auto byte = static_cast<unsigned char>(text[at]);
  return byte >= low && byte <= high;
}

/** @return how many bytes the character at @p at has, 0 where it is not UTF-8. */
std::size_t characterSize(std::string_view text, std::size_t at) {
  const auto lead = static_cast<unsigned char>(text[at]);
  if (lead < 0x80) {
    return 1;
  }
  std::size_t size = 0;
  unsigned low = 0x80;
  unsigned high = 0xBF;
  if (lead >= 0xC2 && lead <= 0xDF) {
    size = 2;
  } else if (lead >= 0xE0 && lead <= 0xEF) {
    size = 3;
    low = lead == 0xE0 ? 0xA0 : 0x80;   // no overlong form
    high = lead == 0xED ? 0x9F : 0xBF;  // no surrogate
  } else if (lead >= 0xF0 && lead <= 0xF4) {
    size = 4;
    low = lead == 0xF0 ? 0x90 : 0x80;
    high = lead == 0xF4 ? 0x8F : 0xBF;
  } else {
    return 0;
  }
  for (std::size_t k = 1; k < size; ++k) {
    if (!continues(text, at + k, k == 1 ? low : 0x80, k == 1 ? high : 0xBF)) {
      return 0;
    }
  }
  return size;
}

bool isUtf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t size = characterSize(text, at);
    if (size == 0) {
      return false;
    }
    at += size;
  }
  return true;
}

class Reader {
 public:
  Reader(std::string_view bytes, std::string where) : bytes_(bytes), where_(std::move(where)) {}

  bool atEnd() const { return at_ == bytes_.size(); }

  /** @brief What is read from now on, for errors. */
  void enter(std::string where) { where_ = std::move(where); }

  void operator()(const char* field, Text text) {
    text.value = bytes(field);
    if (!isUtf8(text.value)) {
      fail(field, "must be UTF-8");
    }
  }
  void operator()(const char* field, std::string_view& value) { value = bytes(field); }
  void operator()(const char* field, bool& value) { value = oneOf(field, 0, 1) == 1; }
  void operator()(const char* field, NoteKind& what) {
    what = static_cast<NoteKind>(oneOf(field, 1, 3));
  }
  void operator()(const char* field, CallStatus& status) {
    status = static_cast<CallStatus>(oneOf(field, 0, 3));
  }
  template <typename Integer>
  std::enable_if_t<std::is_integral_v<Integer>> operator()(const char* field, Integer& value) {
    const std::string_view raw = take(field, sizeof(Integer));
    std::make_unsigned_t<Integer> bits = 0;
    for (std::size_t k = sizeof(Integer); k-- > 0;) {
      const auto byte = static_cast<unsigned char>(raw[k]);
      bits = static_cast<std::make_unsigned_t<Integer>>((std::uint64_t{bits} << 8U) | byte);
    }
    value = static_cast<Integer>(bits);
  }

  std::uint8_t oneOf(const char* field, int low, int high) {
    std::uint8_t value = 0;
    (*this)(field, value);
    if (value < low || value > high) {
      fail(field, "must be from " + std::to_string(low) + " to " + std::to_string(high) + ", got " +
                      std::to_string(value));
    }
    return value;
  }

  [[noreturn]] void fail(const char* field, const std::string& text) const {
    throw MalformedFrame(where_ + ": " + field + " " + text + " (byte " + std::to_string(at_) +
                         " of " + std::to_string(bytes_.size()) + ")");
  }

 private:
  std::string_view bytes(const char* field) {
    std::uint32_t size = 0;
    (*this)(field, size);
    return take(field, size);
  }

  std::string_view take(const char* field, std::size_t size) {
    if (size > bytes_.size() - at_) {
      fail(field, "must fit into the frame, needs " + std::to_string(size) + " bytes of " +
                      std::to_string(bytes_.size() - at_));
    }
    const std::string_view taken = bytes_.substr(at_, size);
    at_ += size;
    return taken;
  }

  std::string_view bytes_;
  std::string where_;
  std::size_t at_ = 0;
};

template <typename Frame, typename Result>
Result readSimple(Reader& reader) {
  Frame frame;
  fields(frame, reader);
  return frame;
}

template <typename Variant, std::size_t index = 0>
Variant readKind(Reader& reader, std::size_t kind) {
  if constexpr (index < std::variant_size_v<Variant>) {
    if (kind == index) {
      std::variant_alternative_t<index, Variant> item;
      fields(item, reader);
      return item;
    }
    return readKind<Variant, index + 1>(reader, kind);
  } else {
    throw std::logic_error("no such kind of item");  // oneOf() has refused it
  }
}

template <typename Item>
std::vector<Item> readItems(Reader& reader, const std::string& frame, const char* const* names) {
  std::vector<Item> items;
  while (!reader.atEnd()) {
    reader.enter(frame);
    const int last = static_cast<int>(std::variant_size_v<Item>);
    const std::size_t kind = reader.oneOf("kind of item", 1, last) - 1U;
    reader.enter(frame + " item " + names[kind]);
    items.push_back(readKind<Item>(reader, kind));
  }
  return items;
}

/** @brief The rest of another version's HELLO is not looked at: the protocol alone is told. */
std::optional<Hello> readForeignHello(std::string_view body) {
  Hello hello;
  Reader reader(body, "HELLO");
  reader("protocol", hello.protocol);
  if (hello.protocol == kProtocol) {
    return std::nullopt;
  }
  reader("name", Text{hello.name});
  return hello;
}

Report readReport(Reader& reader) {
  Report report;
  std::uint8_t flags = 0;
  reader("round", report.round);
  flags = reader.oneOf("flags", 0, kLeavingFlag);
  report.leaving = flags == kLeavingFlag;
  reader("next_ns", report.next_ns);
  if (report.next_ns < 0) {
    reader.fail("next_ns", "must not be negative, got " + std::to_string(report.next_ns));
  }
  reader("open", report.open);
  report.items = readItems<ReportItem>(reader, "REPORT", kReportItemNames);
  return report;
}

Grant readGrant(Reader& reader) {
  Grant grant;
  reader("round", grant.round);
  reader("time_ns", grant.time_ns);
  reader("microstep", grant.microstep);
  grant.items = readItems<GrantItem>(reader, "GRANT", kGrantItemNames);
  return grant;
}

/** @return the reader behind the type, and the type, one of the @p count from @p first on. */
std::pair<Reader, int> open(std::string_view frame, int first, int count,
                            const char* const* names) {
  if (frame.empty()) {
    throw MalformedFrame("a frame must have a type, got an empty one");
  }
  const int type = static_cast<unsigned char>(frame[0]);
  if (type < first || type >= first + count) {
    throw MalformedFrame("type of frame must be from " + std::to_string(first) + " to " +
                         std::to_string(first + count - 1) + ", got " + std::to_string(type));
  }
  return {Reader(frame.substr(1), names[type - first]), type};
}

template <typename Result>
Result whole(const Reader& reader, Result frame) {
  if (!reader.atEnd()) {
    reader.fail("end", "must come here, got more bytes");
  }
  return frame;
}

}  // namespace

void append(std::string& items, const ReportItem& item) { appendItem(items, item); }

void append(std::string& items, const GrantItem& item) { appendItem(items, item); }

std::string encode(const ParticipantFrame& frame) { return std::visit(Encoder{}, frame); }

std::string encode(const MasterFrame& frame) { return std::visit(Encoder{}, frame); }

std::string encodeReport(const Report& head, std::string_view items) {
  std::string out = opened(kReport, items.size() + 32);
  putInteger(out, head.round);
  putInteger<std::uint8_t>(out, head.leaving ? kLeavingFlag : 0);
  putInteger(out, head.next_ns);
  putInteger(out, head.open);
  out.append(items);
  return closed(std::move(out));
}

std::string encodeGrant(const Grant& head, std::string_view items) {
  std::string out = opened(kGrant, items.size() + 32);
  putInteger(out, head.round);
  putInteger(out, head.time_ns);
  putInteger(out, head.microstep);
  out.append(items);
  return closed(std::move(out));
}

bool isReport(std::string_view frame) { return !frame.empty() && frame[0] == kReport; }

ParticipantFrame decodeFromParticipant(std::string_view frame) {
  auto [reader, type] = open(frame, kHello, 4, kFrameNames);
  switch (type) {
    case kHello:
      if (const auto foreign = readForeignHello(frame.substr(1))) {
        return *foreign;
      }
      return whole(reader, readSimple<Hello, ParticipantFrame>(reader));
    case kReport:
      return whole(reader, ParticipantFrame(readReport(reader)));
    case kKnock:
      return whole(reader, readSimple<Knock, ParticipantFrame>(reader));
    default:
      return whole(reader, readSimple<Leave, ParticipantFrame>(reader));
  }
}

MasterFrame decodeFromMaster(std::string_view frame) {
  auto [reader, type] = open(frame, kWelcome, 5, kMasterFrameNames);
  switch (type) {
    case kWelcome:
      return whole(reader, readSimple<Welcome, MasterFrame>(reader));
    case kMember:
      return whole(reader, readSimple<Member, MasterFrame>(reader));
    case kGone:
      return whole(reader, readSimple<Gone, MasterFrame>(reader));
    case kGrant:
      return whole(reader, MasterFrame(readGrant(reader)));
    default:
      return whole(reader, readSimple<End, MasterFrame>(reader));
  }
}

std::optional<std::string_view> FrameBuffer::next(std::uint32_t largest) {
  const std::size_t have = bytes_.size() - begin_;
  std::uint32_t length = 0;
  if (have >= kLengthSize) {
    Reader reader(std::string_view(bytes_).substr(begin_, kLengthSize), "frame");
    reader("length", length);
    if (length == 0 || length > largest) {
      reader.fail("length", "must be from 1 to " + std::to_string(largest) + ", got " +
                                std::to_string(length));
    }
  }
  if (have < kLengthSize || have - kLengthSize < length) {
    bytes_.erase(0, begin_);
    begin_ = 0;
    return std::nullopt;
  }
  const std::string_view frame = std::string_view(bytes_).substr(begin_ + kLengthSize, length);
  begin_ += kLengthSize + length;
  return frame;
}

}  // namespace move_base_abstract::wire
