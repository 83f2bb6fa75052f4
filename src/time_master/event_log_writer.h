// Writes the events of a run to a file, by which two runs can be compared. No ROS.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace move_base_abstract {

/** @return whether @p text is one JSON array (RFC 8259), nested at most 100 deep, and nothing else.
 */
bool isJsonArray(std::string_view text);

/**
 * @brief One event log: JSON lines if the path ends in .jsonl, CSV if it ends in .csv.
 *
 * While the run goes on, the file is PATH.part. A proper end renames it to PATH, so the file that a
 * crash leaves behind is not taken for a whole run. docs/time_master.md describes the format, and
 * move_base_abstract/runs/event_log.py reads it. Thread-safe. flush() and finish() wait for the
 * disk; add() does so only if flush() was not called for long.
 */
class EventLogWriter {
 public:
  /** @brief How a run ended. */
  struct End {
    std::string reason;
    std::vector<std::string> not_repeatable_because;
    std::vector<std::string> degraded_because;
    bool by_fault = false;  // neither as the settings wish nor on request
    std::optional<std::int64_t> cut_ns =
        {};  // simulated; instant of an end from outside, see LockstepStatus
    /** @brief A participant that left or died while the run went on. */
    struct Departure {
      std::string node;
      std::int64_t time_ns;  // simulated
      bool died;
    };
    std::vector<Departure> departures = {};
    /** @brief Goals of a participant on an action that have not ended. */
    struct OpenGoals {
      std::string client;
      std::string action;
      std::size_t count;
    };
    std::vector<OpenGoals> open_goals = {};
    std::string ended_by = {};    // a code of ended_by; '': none is written
    std::string ended_with = {};  // the node whose departure ended the run; ''
    std::int64_t at_ns = 0;       // simulated; when it ended
  };

  /**
   * @param start_ns the first instant of simulated time.
   * @param stored_topics the topics that nodes only store; the head names them, if there are any.
   * @param more_of_head a further entry of the head, as JSON '"key":value'; '': none.
   *
   * A file that already exists as @p path or PATH.part is replaced only if it is an event log. No
   * symbolic link is followed.
   * @throws std::invalid_argument if @p path has another ending or cannot be written, if it is a
   * file of another kind, or if another process writes this log.
   */
  EventLogWriter(const std::string& path, std::int64_t start_ns,
                 const std::vector<std::string>& stored_topics = {},
                 const std::string& more_of_head = {});

  /** @param values a JSON array. A text that is not one is written as an array of this one text. */
  void add(std::int64_t time_ns, std::string_view robot, std::string_view kind,
           std::string_view values);

  /** @brief Write everything that was added so far to the file. */
  void flush();

  /**
   * @brief Write the end record and give the file its name.
   * @return the text of an error; '' if the whole file is on the disk and has its name.
   */
  std::string finish(const End& end);

  /** @return the text of an error in writing so far; '' if there was none. */
  std::string error() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void writeOut();
  void fail(const std::string& what, const std::string& reason);

  mutable std::mutex buffer_mutex_;  // held for moments only
  std::mutex file_mutex_;            // held while waiting for the disk; before buffer_mutex_
  const std::string path_;
  const bool csv_;
  std::unique_ptr<std::FILE, Close> file_;
  std::string buffer_;
  std::string error_;
  std::uint64_t events_ = 0;
};

}  // namespace move_base_abstract
