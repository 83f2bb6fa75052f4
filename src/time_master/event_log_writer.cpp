#include "event_log_writer.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "clock/json_text.h"
#include "descriptor.h"

namespace move_base_abstract {
namespace {

constexpr std::size_t kLargestBuffer = 1 << 23;  // bytes; more than a second of any run

using Json = nlohmann::json;

constexpr int kDeepestNesting = 100;  // readers of logs may recurse

/** @brief Checks the depth only. A handler that returns false ends the parse. */
class DepthCheck : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ <= kDeepestNesting; }
  bool end_object() override { return leave(); }
  bool start_array(std::size_t) override { return ++depth_ <= kDeepestNesting; }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t, const std::string&, const Json::exception&) override {
    return false;
  }

 private:
  bool leave() {
    --depth_;
    return true;
  }

  int depth_ = 0;
};

bool endsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

bool isControl(char letter) { return static_cast<unsigned char>(letter) < 0x20; }

void appendJsonArray(std::string& out, const std::vector<std::string>& texts) {
  out += '[';
  for (std::size_t index = 0; index < texts.size(); ++index) {
    out += index == 0 ? "" : ",";
    appendJson(out, texts[index]);
  }
  out += ']';
}

/** @brief Append what ended the run, and when. */
void appendEnding(std::string& out, const EventLogWriter::End& end) {
  out += std::string(",\"by_fault\":") + (end.by_fault ? "true" : "false");
  if (!end.ended_by.empty()) {
    out += ",\"ended_by\":\"" + end.ended_by + "\"";
    if (!end.ended_with.empty()) {
      out += ",\"node\":";
      appendJson(out, end.ended_with);
    }
    out += ",\"at_ns\":" + std::to_string(end.at_ns);
  }
  out += end.cut_ns ? ",\"cut_ns\":" + std::to_string(*end.cut_ns) : "";
}

/** @brief Append the participants that went before the end; nothing if there are none. */
void appendDepartures(std::string& out,
                      const std::vector<EventLogWriter::End::Departure>& departures) {
  for (std::size_t index = 0; index < departures.size(); ++index) {
    out += index == 0 ? ",\"departures\":[{\"node\":" : ",{\"node\":";
    appendJson(out, departures[index].node);
    out += ",\"time_ns\":" + std::to_string(departures[index].time_ns) +
           ",\"died\":" + (departures[index].died ? "true}" : "false}");
  }
  out += departures.empty() ? "" : "]";
}

/** @brief Append the goals that have not ended; nothing if all have. */
void appendOpenGoals(std::string& out, const std::vector<EventLogWriter::End::OpenGoals>& open) {
  for (std::size_t index = 0; index < open.size(); ++index) {
    out += index == 0 ? ",\"open_goals\":[{\"client\":" : ",{\"client\":";
    appendJson(out, open[index].client);
    out += ",\"action\":";
    appendJson(out, open[index].action);
    out += ",\"count\":" + std::to_string(open[index].count) + "}";
  }
  out += open.empty() ? "" : "]";
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

/**
 * @return @p text on one line: control characters of a name, and line breaks of JSON, become
 * spaces.
 */
std::string onOneLine(std::string_view text) {
  std::string line(text);
  for (char& letter : line) {
    letter = isControl(letter) ? ' ' : letter;
  }
  return line;
}

// ---- files -----------------------------------------------------------------------------------

constexpr std::string_view kHead = "{\"event_log\":1,";  // of the first line; in CSV after "# "
constexpr std::string_view kCsvMark = "# ";

/** @param part whether a full disk may have cut the file off, even before its first byte. */
bool isEventLog(int fd, bool part) {
  char start[32];
  const ssize_t size = pread(fd, start, sizeof(start), 0);
  const std::string_view text(start, size > 0 ? static_cast<std::size_t>(size) : 0);
  for (const std::string& head : {std::string(kHead), std::string(kCsvMark) + std::string(kHead)}) {
    const std::size_t common = std::min(text.size(), head.size());
    if (text.substr(0, common) == head.substr(0, common) && (part || common == head.size())) {
      return true;
    }
  }
  return false;
}

/**
 * @return why the file at @p path must not be replaced; '' if there is none, or it is an event log.
 */
std::string objection(const std::string& path) {
  const Descriptor fd(open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (fd.get() < 0) {
    return errno == ENOENT  ? ""
           : errno == ELOOP ? path + " is a symbolic link, which is not followed"
                            : path + ": " + std::strerror(errno);
  }
  struct stat status {};
  const bool is_file = fstat(fd.get(), &status) == 0 && S_ISREG(status.st_mode);
  if (!is_file || !isEventLog(fd.get(), endsWith(path, ".part"))) {
    return path + " is there already and is no event log: it is not replaced";
  }
  // A process that writes a log holds the lock on it. (Some file systems have no locks.)
  return flock(fd.get(), LOCK_SH | LOCK_NB) == 0 || errno != EWOULDBLOCK
             ? ""
             : path + " is being written by another process";
}

[[noreturn]] void refuseLog(const std::string& path, const std::string& why) {
  throw std::invalid_argument("must be a path that can be written, got '" + path + "': " + why);
}

/** @return a new file PATH.part, locked. @throws std::invalid_argument if it cannot be made. */
std::FILE* create(const std::string& path) {
  const std::string part = path + ".part";
  for (const std::string& name : {path, part}) {
    const std::string why = objection(name);
    if (!why.empty()) {
      refuseLog(path, why);
    }
  }
  unlink(part.c_str());  // an event log of an earlier run, as objection() has checked
  Descriptor fd(open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (fd.get() < 0) {
    refuseLog(path, part + ": " + std::strerror(errno));
  }
  flock(fd.get(), LOCK_EX | LOCK_NB);
  std::FILE* const file = fdopen(fd.get(), "w");
  if (file == nullptr) {
    refuseLog(path, std::strerror(errno));
  }
  fd.release();
  return file;
}

}  // namespace

bool isJsonArray(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\n\r");
  // The parser takes a zero byte for the end of the text.
  if (begin == std::string_view::npos || text[begin] != '[' ||
      text.find('\0') != std::string_view::npos) {
    return false;
  }
  DepthCheck check;
  return Json::sax_parse(text.begin(), text.end(), &check);
}

EventLogWriter::EventLogWriter(const std::string& path, std::int64_t start_ns,
                               const std::vector<std::string>& stored_topics,
                               const std::string& more_of_head)
    : path_(path), csv_(endsWith(path, ".csv")) {
  if (!csv_ && !endsWith(path, ".jsonl")) {
    throw std::invalid_argument("must end in .jsonl or .csv, got '" + path + "'");
  }
  file_.reset(create(path));
  buffer_ = std::string(csv_ ? kCsvMark : "") + std::string(kHead) +
            "\"start_ns\":" + std::to_string(start_ns);
  if (!stored_topics.empty()) {
    buffer_ += ",\"stored_topics\":";
    appendJsonArray(buffer_, stored_topics);
  }
  buffer_ += more_of_head.empty() ? "" : "," + more_of_head;
  buffer_ += std::string("}\n") + (csv_ ? "time_ns,robot,kind,values\n" : "");
  flush();
}

void EventLogWriter::add(std::int64_t time_ns, std::string_view robot, std::string_view kind,
                         std::string_view values) {
  std::string json;
  if (isJsonArray(values)) {
    json = onOneLine(values);
  } else {
    appendJsonArray(json, {std::string(values)});
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
    fail("cannot be written", std::strerror(errno) + std::string("; it ends there"));
  }
}

void EventLogWriter::fail(const std::string& what, const std::string& reason) {
  file_.reset();  // later events would follow a gap
  const std::lock_guard<std::mutex> lock(buffer_mutex_);
  error_ = "event log " + path_ + ".part " + what + ": " + reason;
}

std::string EventLogWriter::finish(const End& end) {
  const std::lock_guard<std::mutex> lock(file_mutex_);
  {
    const std::lock_guard<std::mutex> buffer_lock(buffer_mutex_);
    buffer_ += std::string(csv_ ? "# " : "") + "{\"end\":{\"events\":" + std::to_string(events_) +
               ",\"repeatable\":" +
               (end.not_repeatable_because.empty() && !end.cut_ns ? "true" : "false") +
               ",\"not_repeatable_because\":";
    appendJsonArray(buffer_, end.not_repeatable_because);
    buffer_ += ",\"degraded_because\":";
    appendJsonArray(buffer_, end.degraded_because);
    buffer_ += ",\"reason\":";
    appendJson(buffer_, end.reason);
    appendEnding(buffer_, end);
    appendDepartures(buffer_, end.departures);
    appendOpenGoals(buffer_, end.open_goals);
    buffer_ += "}}\n";
  }
  writeOut();
  if (file_ && (fsync(fileno(file_.get())) != 0 && errno != EINVAL)) {
    fail("cannot be written to the disk", std::strerror(errno));
  }
  if (file_) {
    const std::string why = objection(path_);  // a file may have appeared during the run
    file_.reset();
    if (!why.empty()) {
      fail("cannot be given its name", why);
    } else if (std::rename((path_ + ".part").c_str(), path_.c_str()) != 0) {
      fail("cannot be given its name", std::strerror(errno));
    }
  }
  return error();
}

std::string EventLogWriter::error() const {
  const std::lock_guard<std::mutex> lock(buffer_mutex_);
  return error_;
}

}  // namespace move_base_abstract
