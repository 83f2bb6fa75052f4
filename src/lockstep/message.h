// The messages of a session to the user.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "clock/shown_text.h"

namespace move_base_abstract {

/** @brief A message for the user. */
struct LockstepMessage {
  enum class Level { kDebug, kInfo, kWarn, kError };
  Level level;
  std::string text;
};

/** @brief The messages that have not been taken yet. */
class MessageList {
 public:
  /**
   * @brief Add a message. Parts that other programs have written are made fit for a terminal, see
   * shown().
   */
  void say(LockstepMessage::Level level, const std::string& text) {
    messages_.push_back({level, shown(text)});
  }

  std::vector<LockstepMessage> take() { return std::exchange(messages_, {}); }

 private:
  std::vector<LockstepMessage> messages_;
};

}  // namespace move_base_abstract
