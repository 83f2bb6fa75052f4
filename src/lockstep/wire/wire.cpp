#include "wire.h"

#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "clock/little_endian.h"
#include "utf8.h"

namespace move_base_abstract::wire {
namespace {

// ---- writing ---------------------------------------------------------------------------------

template <typename Number>
void putInteger(std::string& out, Number value) {
  char bytes[sizeof(Number)];
  putNumber(bytes, value);
  out.append(bytes, sizeof(Number));
}

class Writer {
 public:
  explicit Writer(std::string& out) : out_(out) {}

  void operator()(const char*, Text text) { put(text.value); }
  void operator()(const char*, std::string_view bytes) { put(bytes); }
  void operator()(const char*, bool value) { putInteger<std::uint8_t>(out_, value ? 1 : 0); }
  void operator()(const char*, Instant instant) { putInteger(out_, instant.value); }
  void operator()(const char*, Texts texts) {
    putInteger(out_, static_cast<std::uint32_t>(texts.values.size()));
    for (const std::string_view text : texts.values) {
      put(text);
    }
  }
  template <typename Number>
  std::enable_if_t<std::is_integral_v<Number>> operator()(const char*, Number value) {
    putInteger(out_, value);
  }
  template <typename Choice>
  std::enable_if_t<std::is_enum_v<Choice>> operator()(const char*, Choice value) {
    putInteger(out_, static_cast<std::uint8_t>(value));
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

  std::string& out_;
};

/** @brief Write all fields of @p value. The same list of fields is used to read, hence the cast. */
template <typename Structure>
void write(std::string& out, const Structure& value) {
  fields(const_cast<Structure&>(value), Writer(out));
}

constexpr std::size_t kLengthSize = 4;

/** @brief Fill in the length at the beginning, for which opened() has left room. */
std::string closed(std::string frame) {
  const std::size_t length = frame.size() - kLengthSize;
  if (length > kLargestFrame) {
    throw std::invalid_argument("a frame must have at most " + std::to_string(kLargestFrame) +
                                " bytes, got " + std::to_string(length));
  }
  putNumber(frame.data(), static_cast<std::uint32_t>(length));
  return frame;
}

std::string opened(int type, std::size_t body) {
  std::string frame;
  frame.reserve(kLengthSize + 1 + body);
  frame.assign(kLengthSize, '\0');
  frame.push_back(static_cast<char>(type));
  return frame;
}

/** @return a frame whose body is @p head, followed by @p items. */
template <typename Structure>
std::string encodeWith(int type, const Structure& head, std::string_view items) {
  constexpr std::size_t kUsualHead = 32;  // bytes
  std::string out = opened(type, items.size() + kUsualHead);
  write(out, head);
  out.append(items);
  return closed(std::move(out));
}

template <typename Structure>
constexpr bool kHasItems = std::is_same_v<Structure, Report> || std::is_same_v<Structure, Grant>;

template <typename Structure>
std::string itemsOf([[maybe_unused]] const Structure& frame) {
  std::string out;
  if constexpr (kHasItems<Structure>) {
    for (const auto& item : frame.items) {
      append(out, item);
    }
  }
  return out;
}

template <typename Frame>
std::string encodeAny(const Frame& frame, int first) {
  const int type = first + static_cast<int>(frame.index());
  return std::visit([&](const auto& one) { return encodeWith(type, one, itemsOf(one)); }, frame);
}

template <typename Item>
void appendItem(std::string& items, const Item& item, int first) {
  items.push_back(static_cast<char>(first + static_cast<int>(item.index())));
  std::visit([&](const auto& value) { write(items, value); }, item);
}

// ---- reading ---------------------------------------------------------------------------------

class Reader {
 public:
  Reader(std::string_view bytes, const char* frame) : bytes_(bytes), frame_(frame) {}

  bool atEnd() const { return at_ == bytes_.size(); }

  /** @brief Set the name of the item that is read from now on, for errors. */
  void enter(const char* item) { item_ = item; }

  void operator()(const char* field, Text text) {
    text.value = bytes(field);
    if (!isUtf8(text.value)) {
      fail(field, "must be UTF-8");
    }
  }
  void operator()(const char* field, std::string_view& value) { value = bytes(field); }
  void operator()(const char* field, bool& value) { value = oneOf(field, 0, 1) == 1; }
  void operator()(const char* field, Instant instant) {
    (*this)(field, instant.value);
    if (instant.value < 0) {
      fail(field, "must not be negative, got " + std::to_string(instant.value));
    }
  }
  void operator()(const char* field, Texts texts) {
    std::uint32_t count = 0;
    (*this)(field, count);
    for (; count > 0; --count) {  // each takes bytes, so a wrong count ends at the frame's end
      (*this)(field, Text{texts.values.emplace_back()});
    }
  }
  template <typename Choice>
  std::enable_if_t<std::is_enum_v<Choice>> operator()(const char* field, Choice& value) {
    value = static_cast<Choice>(oneOf(field, Range<Choice>::kLow, Range<Choice>::kHigh));
  }
  template <typename Number>
  std::enable_if_t<std::is_integral_v<Number>> operator()(const char* field, Number& value) {
    value = numberAt<Number>(take(field, sizeof(Number)).data());
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
    const std::string where = item_ == nullptr ? frame_ : std::string(frame_) + " item " + item_;
    throw MalformedFrame(where + ": " + field + " " + text + " (byte " + std::to_string(at_) +
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
  const char* frame_;
  const char* item_ = nullptr;
  std::size_t at_ = 0;
};

template <typename Structure>
void readInto(Reader& reader, Structure& one);

/** @brief Read the alternative number @p wanted of a variant. */
template <typename Variant, std::size_t place = 0>
Variant readAlternative(Reader& reader, std::size_t wanted) {
  if constexpr (place < std::variant_size_v<Variant>) {
    if (wanted == place) {
      std::variant_alternative_t<place, Variant> one;
      readInto(reader, one);
      return one;
    }
    return readAlternative<Variant, place + 1>(reader, wanted);
  } else {
    throw std::logic_error("no such frame or item");  // the number was checked before
  }
}

template <typename Item>
std::vector<Item> readItems(Reader& reader, int first, const char* const* names) {
  constexpr int kCount = static_cast<int>(std::variant_size_v<Item>);
  constexpr std::size_t kUsualItems = 8;
  std::vector<Item> items;
  items.reserve(reader.atEnd() ? 0 : kUsualItems);
  while (!reader.atEnd()) {
    reader.enter(nullptr);
    const int kind = reader.oneOf("kind of item", first, first + kCount - 1) - first;
    reader.enter(names[kind]);
    items.push_back(readAlternative<Item>(reader, static_cast<std::size_t>(kind)));
  }
  return items;
}

template <typename Structure>
void readInto(Reader& reader, Structure& one) {
  fields(one, reader);
  if constexpr (std::is_same_v<Structure, Report>) {
    one.items = readItems<ReportItem>(reader, kFirstReportItem, kReportItemNames);
  } else if constexpr (std::is_same_v<Structure, Grant>) {
    one.items = readItems<GrantItem>(reader, kFirstGrantItem, kGrantItemNames);
  }
}

/**
 * @brief Read the HELLO of another version: only its protocol and name, since the rest may differ.
 * @return nothing if it is of this version.
 */
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

template <typename Frame>
Frame decode(std::string_view frame, int first, const char* const* names) {
  if (frame.empty()) {
    throw MalformedFrame("a frame must have a type, got an empty one");
  }
  const int type = static_cast<unsigned char>(frame[0]);
  const int last = first + static_cast<int>(std::variant_size_v<Frame>) - 1;
  if (type < first || type > last) {
    throw MalformedFrame("type of frame must be from " + std::to_string(first) + " to " +
                         std::to_string(last) + ", got " + std::to_string(type));
  }
  Reader reader(frame.substr(1), names[type - first]);
  Frame decoded = readAlternative<Frame>(reader, static_cast<std::size_t>(type - first));
  if (!reader.atEnd()) {
    reader.fail("end", "must come here, got more bytes");
  }
  return decoded;
}

}  // namespace

void append(std::string& items, const ReportItem& item) {
  appendItem(items, item, kFirstReportItem);
}

void append(std::string& items, const GrantItem& item) { appendItem(items, item, kFirstGrantItem); }

std::string encode(const ParticipantFrame& frame) {
  return encodeAny(frame, kFirstParticipantFrame);
}

std::string encode(const MasterFrame& frame) { return encodeAny(frame, kFirstMasterFrame); }

std::string encodeReport(const Report& head, std::string_view items) {
  return encodeWith(kTypeOf<Report>, head, items);
}

std::string encodeGrant(const Grant& head, std::string_view items) {
  return encodeWith(kTypeOf<Grant>, head, items);
}

bool isReport(std::string_view frame) {
  return !frame.empty() && static_cast<unsigned char>(frame[0]) == kTypeOf<Report>;
}

ParticipantFrame decodeFromParticipant(std::string_view frame) {
  if (!frame.empty() && static_cast<unsigned char>(frame[0]) == kTypeOf<Hello>) {
    if (const auto foreign = readForeignHello(frame.substr(1))) {
      return *foreign;
    }
  }
  return decode<ParticipantFrame>(frame, kFirstParticipantFrame, kParticipantFrameNames);
}

MasterFrame decodeFromMaster(std::string_view frame) {
  return decode<MasterFrame>(frame, kFirstMasterFrame, kMasterFrameNames);
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
