// Where a run is to stop for a debugger.
#pragma once

#include <cstdint>
#include <string>

#include "lockstep/routing/router.h"
#include "round_log.h"

namespace move_base_abstract {

/** @brief After which round a run is to stop. */
struct StopCondition {
  enum class What { kRound, kRow };
  What what = What::kRound;
  // Of a row; '' = any.
  std::string kind;
  std::string robot;
  std::string topic;        // or of a message or call on it, also if the log has no messages
  std::uint64_t count = 1;  // the how manieth, from now on
  std::uint64_t row = 0;    // other than 0: when the log has this number of rows
  Nanoseconds until = 0;    // simulated; pause there at the latest; 0: nowhere
};

/** @brief Sees the rows and messages of a run, and knows after which round it is to stop. */
class Stops {
 public:
  /** @throws std::invalid_argument if @p condition is not valid, or is there already. */
  void check(const StopCondition& condition) const;
  /** @brief Wait for @p condition from now on. @param is_between whether no round is open. */
  void await(const StopCondition& condition, std::uint64_t round, bool is_between);

  void sees(const LockstepLogEntry& row);
  void sees(const MessageRouter::Delivery& delivery, const RoundLog::NameOf& name_of);
  /** @return whether the run is to stop after @p round, which is over. */
  bool isDueAfter(std::uint64_t round) const;
  /** @brief Note that it has stopped there. @param at the instant, as a text. */
  void stopped(std::uint64_t round, const std::string& at);

  std::uint64_t rows() const { return rows_; }
  std::uint64_t count() const { return count_; }  // of stops so far
  /** @return the row at which it stopped last, from 1; 0: it did not stop at a row. */
  std::uint64_t row() const { return row_; }
  const std::string& why() const { return why_; }

 private:
  void found(const std::string& what, std::uint64_t row);

  StopCondition condition_;
  std::uint64_t last_round_ = 0;  // after which it does not stop yet
  std::uint64_t found_ = 0;       // matches so far
  std::uint64_t found_row_ = 0;
  std::string found_what_;
  std::uint64_t rows_ = 0;
  std::uint64_t count_ = 0;
  std::uint64_t row_ = 0;
  std::string why_ = "stopped before the first round";
};

}  // namespace move_base_abstract
