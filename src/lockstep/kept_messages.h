// Keeps the latest messages between participants, for those who look at a run in a debugger.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lockstep/routing/router.h"

namespace move_base_abstract {

/** @brief The latest messages on each topic and service: at most so many, and so many bytes. */
class KeptMessages {
 public:
  /** @brief A message, call or response that was delivered, or lost. */
  struct One {
    Nanoseconds time;  // simulated
    std::string kind;  // as in the event log
    std::string name;  // of the topic or service
    std::string type;  // of a message
    std::string md5;   // of its type; '' if its sender has gone meanwhile
    std::string sender;
    std::vector<std::string> receivers;
    std::string bytes;
    std::uint64_t number = 0;  // in the order of all that was kept
  };

  static constexpr std::size_t kMostBytes = 16U << 20;  // of each name; the latest one always

  /** @param most how many of each name; 0: none. */
  explicit KeptMessages(std::size_t most) : most_(most) {}

  bool areKept() const { return most_ > 0; }
  void add(One message);
  /**
   * @return the latest ones, in their order.
   * @param name of the topic or service; '' = any.
   * @param node who sent them or got them; '' = anybody.
   * @param most how many; 0: all.
   */
  std::vector<One> recent(std::string_view name, const std::string& node, std::size_t most) const;

 private:
  struct OfName {
    std::deque<One> messages;
    std::size_t bytes = 0;
  };

  const std::size_t most_;
  std::uint64_t count_ = 0;
  std::map<std::string, OfName, std::less<>> names_;
};

}  // namespace move_base_abstract
