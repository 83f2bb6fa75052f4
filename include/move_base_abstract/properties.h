// Statements of a node about a run: what must hold always, sometimes, or never again.
// docs/properties.md is the contract. This header is for any roscpp node, in lockstep or not, with
// or without our library.
#ifndef MOVE_BASE_ABSTRACT_PROPERTIES_H
#define MOVE_BASE_ABSTRACT_PROPERTIES_H

#include <dlfcn.h>
#include <ros/console.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace move_base_abstract::properties {

/** @brief Names and values that are shown when a statement breaks. */
using Details = std::vector<std::pair<std::string, std::string>>;

namespace internal {

constexpr std::size_t kLongestText = 200;  // bytes
constexpr std::size_t kMostDetails = 16;
constexpr std::size_t kMostStatements = 1000;

enum class Kind { kAlways, kSometimes, kNeverAgain };

inline const char* nameOf(Kind kind) {
  return kind == Kind::kAlways ? "always" : kind == Kind::kSometimes ? "sometimes" : "never_again";
}

/** @return @p text [ASCII or UTF-8] in one line, cut to kLongestText. */
inline std::string shortened(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) {
    line += (line.empty() ? "" : " ") + word;
  }
  if (line.size() <= kLongestText) {
    return line;
  }
  std::size_t end = kLongestText - 3;
  while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xC0) == 0x80) {
    --end;  // so that no character is cut in two
  }
  return line.substr(0, end) + "...";
}

inline std::string quoted(const std::string& text) {
  static constexpr const char* kDigits = "0123456789abcdef";
  std::string json = "\"";
  for (const char sign : text) {
    const auto byte = static_cast<unsigned char>(sign);
    if (byte < 0x20) {
      json += std::string("\\u00") + kDigits[byte >> 4] + kDigits[byte & 15];
    } else {
      json += sign == '"' || sign == '\\' ? std::string("\\") + sign : std::string(1, sign);
    }
  }
  return json + "\"";
}

struct Statement {
  bool is_over = false;
  bool is_true = false;
  unsigned was_true = 0;
};

/**
 * @brief Write @p row into the run's event log, if the node takes part. Otherwise warn of a broken
 * statement.
 */
inline void tell(const std::vector<std::string>& row) {
  // The function of the preloaded library, or of the library that participants link. It returns 0
  // if it took the row.
  using Log = int(const char*, const char*);
  static Log* const log =
      reinterpret_cast<Log*>(::dlsym(RTLD_DEFAULT, "move_base_abstract_log_row"));
  std::string json;
  std::string words;
  for (const std::string& value : row) {
    json += (json.empty() ? "[" : ",") + quoted(value);
    words += (words.empty() ? "" : ", ") + value;
  }
  if ((log == nullptr || log("property", (json + "]").c_str()) != 0) && row[2] == "broken") {
    ROS_WARN("broken: %s", words.c_str());
  }
}

using Rows = std::vector<std::vector<std::string>>;

/** @brief The statements of this process. statements.py has the same rules. */
class Statements {
 public:
  /** @return the rows to write, in order; mostly there are none. */
  Rows take(Kind kind, bool holds, const std::string& text, const Details& details) {
    const std::lock_guard<std::mutex> lock(mutex_);
    auto found = made_.find({kind, text});
    if (found != made_.end() && (found->second.is_over || found->second.is_true == holds)) {
      return {};
    }
    Rows rows;
    if (found == made_.end()) {
      check(kind, text);
      if (made_.size() >= kMostStatements) {
        return tooMany(text);
      }
      found = made_.emplace(std::make_pair(kind, text), Statement()).first;
      rows.push_back({nameOf(kind), shortened(text), "stated"});
    }
    Statement& statement = found->second;
    statement.is_true = holds;
    statement.was_true += holds ? 1 : 0;
    statement.is_over =
        kind == Kind::kAlways ? !holds : statement.was_true > (kind == Kind::kNeverAgain ? 1U : 0U);
    if (statement.is_over) {
      rows.push_back(last(kind, text, details));
    }
    return rows;
  }

 private:
  static void check(Kind kind, const std::string& text) {
    if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
      throw std::invalid_argument(std::string(nameOf(kind)) +
                                  " needs a text that says what it is about, got none");
    }
  }

  static std::vector<std::string> last(Kind kind, const std::string& text, Details details) {
    std::vector<std::string> row{nameOf(kind), shortened(text),
                                 kind == Kind::kSometimes ? "held" : "broken"};
    std::sort(details.begin(), details.end());
    for (std::size_t k = 0; k < std::min(details.size(), kMostDetails); ++k) {
      row.push_back(shortened(details[k].first) + "=" + shortened(details[k].second));
    }
    return row;
  }

  Rows tooMany(const std::string& text) {
    if (std::exchange(is_full_, true)) {
      return {};
    }
    return {{"always",
             "a node states at most 1000 things; what differs each time belongs in the details",
             "broken", "text=" + shortened(text)}};
  }

  std::mutex mutex_;
  std::map<std::pair<Kind, std::string>, Statement> made_;
  bool is_full_ = false;
};

inline void take(Kind kind, bool holds, const std::string& text, const Details& details) {
  static Statements* const statements = new Statements;  // threads may outlive static objects
  for (const auto& row : statements->take(kind, holds, text, details)) {
    tell(row);
  }
}

}  // namespace internal

/** @return a detail, with @p value as an output stream writes it. */
template <class T>
Details::value_type detail(const std::string& name, const T& value) {
  std::ostringstream text;
  text << value;
  return {name, text.str()};
}

/**
 * @brief State that @p condition is true whenever this is called. The first time that it is false
 * breaks the statement.
 * @param text says what is stated, and is the same each time.
 * @throws std::invalid_argument if @p text is empty.
 */
inline void always(bool condition, const std::string& text, const Details& details = {}) {
  internal::take(internal::Kind::kAlways, condition, text, details);
}

/** @brief State that @p condition is true at least once, in at least one run. */
inline void sometimes(bool condition, const std::string& text, const Details& details = {}) {
  internal::take(internal::Kind::kSometimes, condition, text, details);
}

/** @brief State that @p condition never becomes true again after it was true and then false. */
inline void never_again(bool condition, const std::string& text, const Details& details = {}) {
  internal::take(internal::Kind::kNeverAgain, condition, text, details);
}

}  // namespace move_base_abstract::properties

#endif  // MOVE_BASE_ABSTRACT_PROPERTIES_H
