// Labels of a run: the reasons why it is not repeatable, or is degraded.
#pragma once

#include <string>
#include <vector>

#include "message.h"

namespace move_base_abstract {

/**
 * @brief The labels of a run. Each is kept and reported once. There are at most a hundred of each
 * kind.
 */
class RunLabels {
 public:
  /** @param messages gets a message for each new label; it must outlive this object. */
  explicit RunLabels(MessageList& messages) : messages_(messages) {}

  void addNotRepeatable(const std::string& why);
  /** @brief Add a label, unless @p why is ''. */
  void addIfAny(const std::string& why) {
    if (!why.empty()) {
      addNotRepeatable(why);
    }
  }
  void addDegraded(const std::string& why);

  /**
   * @return the first label of all, as "not repeatable: why" or "degraded: why"; '' if there is
   * none. Of labels of the second kind the first one as they are sorted.
   */
  const std::string& first() const { return first_; }
  const std::vector<std::string>& notRepeatable() const { return not_repeatable_; }
  /** @return the labels of this kind, sorted: their order does not depend on the wall clock. */
  const std::vector<std::string>& degraded() const { return degraded_; }

 private:
  MessageList& messages_;
  std::string first_;
  std::vector<std::string> not_repeatable_;
  std::vector<std::string> degraded_;
};

}  // namespace move_base_abstract
