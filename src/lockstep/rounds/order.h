// The stated order of participants, and of what they do in one round.
#ifndef MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ORDER_H
#define MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ORDER_H

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace move_base_abstract {

/** @brief A participant's number: from 1 on, never reused. */
using MemberId = std::uint32_t;

/** @brief Whether @p a comes before @p b where runs of digits count as numbers (2 before 10). */
bool naturalLess(std::string_view a, std::string_view b);

/** @brief Where a thing comes among those of its round: rank, robot, name, the sender's count. */
struct MailOrder {
  std::int32_t rank = 0;
  std::uint32_t sub = 0;
  std::uint32_t place = 0;   // of the sender's name among all members' names in natural order
  std::uint64_t number = 0;  // of the action among all those of its sender
};

/** @brief Whether @p a comes before @p b. */
bool isBefore(const MailOrder& a, const MailOrder& b);

/** @brief The place of each member's name among all of them, found out when it is asked for. */
class NamePlaces {
 public:
  void add(MemberId id, const std::string& name);
  void remove(MemberId id);
  /** @return 0 for one that is not there. */
  std::uint32_t of(MemberId id) const;

 private:
  void arrange() const;

  std::map<MemberId, std::string> names_;
  mutable std::map<MemberId, std::uint32_t> places_;
  mutable bool changed_ = false;
};

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_LOCKSTEP_ROUNDS_ORDER_H
