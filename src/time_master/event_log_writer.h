// Writes the events of a run to a file that two runs can be compared by. No ROS.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_EVENT_LOG_WRITER_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_EVENT_LOG_WRITER_H

#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace move_base_abstract {

/**
 * @brief One event log: JSON lines where the path ends in .jsonl, CSV where it ends in .csv.
 *
 * While the run goes on, the file is PATH.part; a proper end renames it to PATH, so that what a
 * crash leaves behind cannot be taken for a whole run. The format is told in docs/time_master.md
 * and read by move_base_abstract/runs/event_log.py. Thread-safe; only flush() and finish() wait for
 * the disk, and add() where nobody has flushed for long.
 */
class EventLogWriter {
 public:
  /** @brief How a run ended. */
  struct End {
    std::string reason;
    std::vector<std::string> not_repeatable_because;
    std::vector<std::string> degraded_because;
    bool by_fault = false;  // neither as wished nor because somebody has asked for it
    std::optional<std::int64_t> cut_ns =
        {};  // simulated; where it was ended from outside, see LockstepStatus
    /** @brief Who left or died while the run went on, in this order. */
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
    std::string ended_by = {};    // a code of LockstepStatus; '': none is written
    std::string ended_with = {};  // the node whose departure has ended the run; ''
    std::int64_t at_ns = 0;       // simulated; when it ended
  };

  /**
   * @param stored_topics what the user says of them; the head says so, where there are any.
   * @param more_of_head JSON, '"key":value', that the head has, too; '': none.
   *
   * Of what is there under @p path or PATH.part already, only an event log is replaced, and no
   * symbolic link is followed.
   * @throws std::invalid_argument if @p path has another ending or cannot be written, if something
   * else is there, or if another process writes this log.
   */
  EventLogWriter(const std::string& path, std::int64_t start_ns,
                 const std::vector<std::string>& stored_topics = {},
                 const std::string& more_of_head = {});

  /** @param values a JSON array; what is none is written as an array of one text. */
  void add(std::int64_t time_ns, std::string_view robot, std::string_view kind,
           std::string_view values);

  /** @brief Hand everything added so far to the file system. */
  void flush();

  /**
   * @brief Write the end record and give the file its name.
   * @return an error's text; '' if all is on the disk and bears its name.
   */
  std::string finish(const End& end);

  /** @return what went wrong in writing so far; '' if nothing did. */
  std::string error() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void writeOut();
  void fail(const std::string& what, const std::string& reason);

  mutable std::mutex buffer_mutex_;  // taken for moments only
  std::mutex file_mutex_;            // taken while the disk is waited for; before buffer_mutex_
  const std::string path_;
  const bool csv_;
  std::unique_ptr<std::FILE, Close> file_;
  std::string buffer_;
  std::string error_;
  std::uint64_t events_ = 0;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_EVENT_LOG_WRITER_H
