#include "goals.h"

#include <cstdint>
#include <iterator>
#include <optional>

#include "clock/little_endian.h"

namespace move_base_abstract {
namespace {

constexpr std::string_view kGoal = "/goal";
constexpr std::string_view kResult = "/result";
constexpr std::size_t kWord = 4;  // bytes of a number, or of the length before a text

bool endsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

/**
 * @brief Take a little-endian number from the beginning of @p bytes. @return nothing if there are
 * too few bytes.
 */
std::optional<std::uint32_t> takeNumber(std::string_view* bytes) {
  if (bytes->size() < kWord) {
    return std::nullopt;
  }
  const auto number = numberAt<std::uint32_t>(bytes->data());
  bytes->remove_prefix(kWord);
  return number;
}

std::optional<std::string_view> takeText(std::string_view* bytes) {
  const auto length = takeNumber(bytes);
  if (!length || *length > bytes->size()) {
    return std::nullopt;
  }
  const std::string_view text = bytes->substr(0, *length);
  bytes->remove_prefix(*length);
  return text;
}

/**
 * @return the goal's id in an action's goal or result, which follows a header and a stamp; '' if
 * there is none.
 */
std::string idOf(std::string_view message) {
  constexpr std::size_t kBefore = 3 * kWord;  // sequence number and stamp
  if (message.size() < kBefore) {
    return "";
  }
  message.remove_prefix(kBefore);
  if (!takeText(&message) || message.size() < 2 * kWord) {
    return "";
  }
  message.remove_prefix(2 * kWord);
  return std::string(takeText(&message).value_or(""));
}

std::string actionOf(std::string_view topic, std::string_view end) {
  return std::string(topic.substr(0, topic.size() - end.size()));
}

}  // namespace

OpenGoals::Part OpenGoals::partOf(std::string_view topic, std::string_view type) {
  if (endsWith(topic, kGoal) && endsWith(type, "ActionGoal")) {
    return Part::kGoal;
  }
  return endsWith(topic, kResult) && endsWith(type, "ActionResult") ? Part::kResult : Part::kNone;
}

std::string OpenGoals::resultTopic(std::string_view goal_topic) {
  return actionOf(goal_topic, kGoal) + std::string(kResult);
}

void OpenGoals::sent(MemberId client, std::string_view goal_topic, std::string_view goal) {
  std::string id = idOf(goal);
  if (!id.empty()) {
    clients_[{actionOf(goal_topic, kGoal), std::move(id)}] = client;
  }
}

void OpenGoals::answered(std::string_view result_topic, std::string_view result) {
  clients_.erase({actionOf(result_topic, kResult), idOf(result)});
}

void OpenGoals::lost(std::string_view goal_topic, std::string_view goal) {
  clients_.erase({actionOf(goal_topic, kGoal), idOf(goal)});
}

MemberId OpenGoals::clientOf(std::string_view result_topic, std::string_view result) const {
  const auto goal = clients_.find({actionOf(result_topic, kResult), idOf(result)});
  return goal == clients_.end() ? 0 : goal->second;
}

void OpenGoals::remove(MemberId client) {
  for (auto goal = clients_.begin(); goal != clients_.end();) {
    goal = goal->second == client ? clients_.erase(goal) : std::next(goal);
  }
}

std::map<std::pair<MemberId, std::string>, std::size_t> OpenGoals::byAction() const {
  std::map<std::pair<MemberId, std::string>, std::size_t> counts;
  for (const auto& [goal, client] : clients_) {
    ++counts[{client, goal.first}];
  }
  return counts;
}

}  // namespace move_base_abstract
