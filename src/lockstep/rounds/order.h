// The stated order of participants, and of their actions in one round.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace move_base_abstract {

/** @brief A participant's number, from 1 on. It is never reused. */
using MemberId = std::uint32_t;

/** @brief Whether @p a comes before @p b if runs of digits count as numbers (2 before 10). */
bool naturalLess(std::string_view a, std::string_view b);

/**
 * @brief The place of an action among those of its round: by rank, robot, name, and the sender's
 * count.
 */
struct MailOrder {
  std::int32_t rank = 0;
  std::uint32_t sub = 0;
  std::uint32_t place = 0;   // of the sender's name among all members' names in natural order
  std::uint64_t number = 0;  // of the action among all of its sender's
};

/** @brief Whether @p a comes before @p b. */
bool isBefore(const MailOrder& a, const MailOrder& b);

/** @brief The place of each member's name among all names, which is computed when it is needed. */
class NamePlaces {
 public:
  void add(MemberId id, const std::string& name);
  void remove(MemberId id);
  /** @return the place of the member's name; 0 if it is not there. */
  std::uint32_t of(MemberId id) const;

 private:
  void arrange() const;

  std::map<MemberId, std::string> names_;
  mutable std::map<MemberId, std::uint32_t> places_;
  mutable bool changed_ = false;
};

}  // namespace move_base_abstract
