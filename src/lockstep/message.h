// What a session has to say to the user.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_MESSAGE_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_MESSAGE_H

#include <string>
#include <utility>
#include <vector>

#include "clock/shown_text.h"

namespace move_base_abstract {

/** @brief Something for the user to read. */
struct LockstepMessage {
  enum class Level { kDebug, kInfo, kWarn, kError };
  Level level;
  std::string text;
};

/** @brief Messages that nobody has read yet. */
class MessageList {
 public:
  /** @brief Add a message; of what others have written in it, only what is fit for a terminal. */
  void say(LockstepMessage::Level level, const std::string& text) {
    messages_.push_back({level, shown(text)});
  }

  std::vector<LockstepMessage> take() { return std::exchange(messages_, {}); }

 private:
  std::vector<LockstepMessage> messages_;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_MESSAGE_H
