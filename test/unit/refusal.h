// What a call says that is refused.
#ifndef MOVE_BASE_ABSTRACT_TEST_UNIT_REFUSAL_H
#define MOVE_BASE_ABSTRACT_TEST_UNIT_REFUSAL_H

#include <stdexcept>
#include <string>

namespace move_base_abstract {

/** @return what the call says that is refused. */
template <typename Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "was not refused";
}

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TEST_UNIT_REFUSAL_H
