// Topics of which the user says that nodes only store their messages.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace move_base_abstract {

/**
 * @return the entries, "TOPIC" or "NODE=TOPIC", with resolved names. A name without a '/' at its
 * beginning is below the root.
 * @throws std::invalid_argument if an entry is neither.
 */
std::vector<std::string> checkedStoredTopics(const std::vector<std::string>& entries);

class StoredTopics {
 public:
  StoredTopics() = default;
  /** @param entries from checkedStoredTopics(); "TOPIC" stands for all nodes. */
  explicit StoredTopics(const std::vector<std::string>& entries)
      : entries_(entries.begin(), entries.end()) {}

  bool has(std::string_view node, std::string_view topic) const {
    return !entries_.empty() && (entries_.count(topic) > 0 ||
                                 entries_.count(std::string(node) + '=' + std::string(topic)) > 0);
  }

 private:
  std::set<std::string, std::less<>> entries_;
};

}  // namespace move_base_abstract
