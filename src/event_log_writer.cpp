#include "event_log_writer.h"

#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace move_base_abstract {
namespace {

constexpr std::size_t kLargestBuffer = 1 << 23;  // bytes; more than a second of any run
constexpr int kDeepestNesting = 100;

bool endsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

bool isControl(char letter) { return static_cast<unsigned char>(letter) < 0x20; }

/** @brief A check of JSON (RFC 8259) by recursive descent; builds nothing. */
class JsonCheck {
 public:
  explicit JsonCheck(std::string_view text) : text_(text) {}

  bool wholeArray() {
    space();
    return peek() == '[' && value(0) && at_ == text_.size();
  }

 private:
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  bool take(char letter) {
    if (peek() != letter || at_ == text_.size()) {
      return false;
    }
    ++at_;
    return true;
  }

  bool take(std::string_view word) {
    if (text_.substr(at_, word.size()) != word) {
      return false;
    }
    at_ += word.size();
    return true;
  }

  void space() {
    while (take(' ') || take('\t') || take('\n') || take('\r')) {
    }
  }

  bool digits() {
    const std::size_t begin = at_;
    while (std::isdigit(static_cast<unsigned char>(peek()))) {
      ++at_;
    }
    return at_ > begin;
  }

  bool number() {
    take('-');
    if (!take('0') && !digits()) {
      return false;
    }
    if (take('.') && !digits()) {
      return false;
    }
    if (take('e') || take('E')) {
      take('+') || take('-');
      return digits();
    }
    return true;
  }

  bool escape() {
    if (!take('u')) {
      const char letter = peek();
      ++at_;
      return letter != '\0' && std::strchr("\"\\/bfnrt", letter) != nullptr;
    }
    for (int count = 0; count < 4; ++count, ++at_) {
      if (!std::isxdigit(static_cast<unsigned char>(peek()))) {
        return false;
      }
    }
    return true;
  }

  bool string() {
    if (!take('"')) {
      return false;
    }
    while (at_ < text_.size()) {
      if (take('"')) {
        return true;
      }
      if (take('\\')) {
        if (!escape()) {
          return false;
        }
      } else if (static_cast<unsigned char>(text_[at_++]) < 0x20) {
        return false;
      }
    }
    return false;
  }

  bool member(int depth) {
    space();
    if (!string()) {
      return false;
    }
    space();
    return take(':') && value(depth);
  }

  bool container(char close, bool named, int depth) {
    space();
    if (take(close)) {
      return true;
    }
    do {
      if (!(named ? member(depth) : value(depth))) {
        return false;
      }
    } while (take(','));
    return take(close);
  }

  bool bare(int depth) {
    if (take('[')) {
      return container(']', false, depth + 1);
    }
    if (take('{')) {
      return container('}', true, depth + 1);
    }
    return peek() == '"' ? string() : take("true") || take("false") || take("null") || number();
  }

  bool value(int depth) {
    space();
    const bool good = depth < kDeepestNesting && bare(depth);
    space();
    return good;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

void appendJson(std::string& out, std::string_view text) {
  out += '"';
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') {
      out += '\\';
      out += letter;
    } else if (isControl(letter)) {
      char code[8];
      std::snprintf(code, sizeof(code), "\\u%04x", static_cast<unsigned char>(letter));
      out += code;
    } else {
      out += letter;
    }
  }
  out += '"';
}

void appendJson(std::string& out, const std::vector<std::string>& texts) {
  out += '[';
  for (std::size_t index = 0; index < texts.size(); ++index) {
    out += index == 0 ? "" : ",";
    appendJson(out, texts[index]);
  }
  out += ']';
}

void appendCsv(std::string& out, std::string_view text) {
  if (text.find_first_of("\",") == std::string_view::npos) {
    out += text;
    return;
  }
  out += '"';
  for (const char letter : text) {
    out += letter;
    if (letter == '"') {
      out += letter;
    }
  }
  out += '"';
}

/** @return @p text on one line: a name's control characters, or JSON's line breaks, as spaces. */
std::string onOneLine(std::string_view text) {
  std::string line(text);
  for (char& letter : line) {
    letter = isControl(letter) ? ' ' : letter;
  }
  return line;
}

}  // namespace

bool isJsonArray(std::string_view text) { return JsonCheck(text).wholeArray(); }

EventLogWriter::EventLogWriter(const std::string& path, std::int64_t start_ns)
    : path_(path), csv_(endsWith(path, ".csv")) {
  if (!csv_ && !endsWith(path, ".jsonl")) {
    throw std::invalid_argument("must end in .jsonl or .csv, got '" + path + "'");
  }
  file_.reset(std::fopen((path + ".part").c_str(), "we"));
  if (!file_) {
    throw std::invalid_argument("must be a path that can be written, got '" + path +
                                "': " + std::strerror(errno));
  }
  buffer_ = std::string(csv_ ? "# " : "") +
            "{\"event_log\":1,\"start_ns\":" + std::to_string(start_ns) + "}\n" +
            (csv_ ? "time_ns,robot,kind,values\n" : "");
  flush();
}

void EventLogWriter::add(std::int64_t time_ns, std::string_view robot, std::string_view kind,
                         std::string_view values) {
  std::string json;
  if (isJsonArray(values)) {
    json = onOneLine(values);
  } else {
    appendJson(json, std::vector<std::string>{std::string(values)});
  }
  std::unique_lock<std::mutex> lock(buffer_mutex_);
  ++events_;
  if (csv_) {
    buffer_ += std::to_string(time_ns) + ',';
    appendCsv(buffer_, onOneLine(robot));
    buffer_ += ',';
    appendCsv(buffer_, onOneLine(kind));
    buffer_ += ',';
    appendCsv(buffer_, json);
    buffer_ += '\n';
  } else {
    buffer_ += "{\"time_ns\":" + std::to_string(time_ns) + ",\"robot\":";
    appendJson(buffer_, onOneLine(robot));
    buffer_ += ",\"kind\":";
    appendJson(buffer_, onOneLine(kind));
    buffer_ += ",\"values\":" + json + "}\n";
  }
  if (buffer_.size() > kLargestBuffer) {
    lock.unlock();
    flush();
  }
}

void EventLogWriter::flush() {
  const std::lock_guard<std::mutex> lock(file_mutex_);
  writeOut();
}

void EventLogWriter::writeOut() {
  std::string text;
  {
    const std::lock_guard<std::mutex> lock(buffer_mutex_);
    text.swap(buffer_);
  }
  if (!file_ || text.empty()) {
    return;
  }
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() ||
      std::fflush(file_.get()) != 0) {
    fail("cannot be written");
  }
}

void EventLogWriter::fail(const std::string& what) {
  const std::string reason = std::strerror(errno);
  file_.reset();  // what comes now would follow a gap
  const std::lock_guard<std::mutex> lock(buffer_mutex_);
  error_ = "event log " + path_ + ".part " + what + ": " + reason + "; it ends there";
}

std::string EventLogWriter::finish(const End& end) {
  const std::lock_guard<std::mutex> lock(file_mutex_);
  {
    const std::lock_guard<std::mutex> buffer_lock(buffer_mutex_);
    buffer_ += std::string(csv_ ? "# " : "") + "{\"end\":{\"events\":" + std::to_string(events_) +
               ",\"repeatable\":" + (end.not_repeatable_because.empty() ? "true" : "false") +
               ",\"not_repeatable_because\":";
    appendJson(buffer_, end.not_repeatable_because);
    buffer_ += ",\"degraded_because\":";
    appendJson(buffer_, end.degraded_because);
    buffer_ += ",\"reason\":";
    appendJson(buffer_, end.reason);
    buffer_ += "}}\n";
  }
  writeOut();
  if (file_ && (fsync(fileno(file_.get())) != 0 && errno != EINVAL)) {
    fail("cannot be written to the disk");
  }
  if (file_) {
    file_.reset();
    if (std::rename((path_ + ".part").c_str(), path_.c_str()) != 0) {
      fail("cannot be given its name");
    }
  }
  return error();
}

std::string EventLogWriter::error() const {
  const std::lock_guard<std::mutex> lock(buffer_mutex_);
  return error_;
}

}  // namespace move_base_abstract
