#include "stops.h"

#include <algorithm>

#include "clock/argument_check.h"
#include "clock/shown_text.h"

namespace move_base_abstract {
namespace {

bool fits(const std::string& wanted, std::string_view got) {
  return wanted.empty() || wanted == got;
}

}  // namespace

void Stops::check(const StopCondition& condition) const {
  const bool has_texts =
      !condition.kind.empty() || !condition.robot.empty() || !condition.topic.empty();
  if (condition.what == StopCondition::What::kRound && (has_texts || condition.row != 0)) {
    refuse("stop_when: with ROUND, kind, robot and topic must be '' and row 0; they are for ROW");
  }
  if (condition.row != 0 && (has_texts || condition.count > 1)) {
    refuse("stop_when: with a row, kind, robot and topic must be '' and count 0, got row " +
           std::to_string(condition.row));
  }
  if (condition.row != 0 && condition.row <= rows_) {
    refuse("stop_when: row must be more than the rows that the log has, " + std::to_string(rows_) +
           ", got " + std::to_string(condition.row));
  }
  if (!condition.topic.empty() && !condition.robot.empty()) {
    refuse("stop_when: topic and robot must not be given both, got " + quote(condition.topic) +
           " and " + quote(condition.robot) + ": a row of a message has its topic for a robot");
  }
}

void Stops::await(const StopCondition& condition, std::uint64_t round, bool is_between) {
  condition_ = condition;
  condition_.count = std::max<std::uint64_t>(condition.count, 1);
  last_round_ = round - (is_between || round == 0 ? 0 : 1);
  found_ = found_row_ = 0;
  found_what_.clear();
}

void Stops::sees(const LockstepLogEntry& row) {
  ++rows_;
  if (condition_.what != StopCondition::What::kRow || !condition_.topic.empty()) {
    return;
  }
  if (condition_.row != 0 ? rows_ == condition_.row
                          : fits(condition_.kind, row.kind) && fits(condition_.robot, row.robot)) {
    found(shown(row.kind) + (row.robot.empty() ? "" : " of " + shown(row.robot)), rows_);
  }
}

void Stops::sees(const MessageRouter::Delivery& delivery, const RoundLog::NameOf& name_of) {
  if (condition_.what == StopCondition::What::kRow && condition_.topic == delivery.name &&
      fits(condition_.kind, delivery.kindName())) {
    found("a " + std::string(delivery.kindName()) + " of " + quote(delivery.from(name_of)) +
              " on " + condition_.topic,
          0);
  }
}

void Stops::found(const std::string& what, std::uint64_t row) {
  if (++found_ == condition_.count || condition_.row != 0) {
    found_what_ = what;
    found_row_ = row;
  }
}

bool Stops::isDueAfter(std::uint64_t round) const {
  if (condition_.what == StopCondition::What::kRound) {
    return round >= last_round_ + condition_.count;
  }
  return condition_.row != 0 ? rows_ >= condition_.row : found_ >= condition_.count;
}

void Stops::stopped(std::uint64_t round, const std::string& at) {
  ++count_;
  row_ = condition_.what == StopCondition::What::kRow ? found_row_ : 0;
  why_ = "stopped" + at + " after round " + std::to_string(round) +
         (row_ == 0 ? "" : ", at row " + std::to_string(row_)) +
         (condition_.what == StopCondition::What::kRow ? ": " + found_what_ : "");
}

}  // namespace move_base_abstract
