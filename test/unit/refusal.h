// What a call says that is refused.
#pragma once

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
