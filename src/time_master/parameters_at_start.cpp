#include "parameters_at_start.h"

#include <algorithm>
#include <cstddef>

namespace move_base_abstract {

void ParametersAtStart::remember(const XmlRpc::XmlRpcValue& all) {
  all_ = std::make_unique<XmlRpc::XmlRpcValue>(all);
}

void ParametersAtStart::change(const std::string& name) { changed_.insert(name); }

/** @return whether a participant has changed the parameter, or one above or below it. */
bool ParametersAtStart::isChanged(const std::string& name) const {
  const auto is_at_or_below = [](const std::string& inner, const std::string& outer) {
    return inner.compare(0, outer.size(), outer) == 0 &&
           (inner.size() == outer.size() || outer == "/" || inner[outer.size()] == '/');
  };
  return std::any_of(changed_.begin(), changed_.end(), [&](const std::string& other) {
    return is_at_or_below(name, other) || is_at_or_below(other, name);
  });
}

bool ParametersAtStart::hold(const std::string& name, const XmlRpc::XmlRpcValue& value) const {
  using Value = XmlRpc::XmlRpcValue;
  if (!all_) {
    return true;
  }
  if (all_->getType() != Value::TypeStruct || isChanged(name)) {
    return false;
  }
  Value at = *all_;
  for (std::size_t begin = 1; begin < name.size();) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    const std::string part = name.substr(begin, end - begin);
    if (at.getType() != Value::TypeStruct || !at.hasMember(part)) {
      return value.getType() == Value::TypeStruct && value.size() == 0;  // it is deleted
    }
    const Value below = at[part];
    at = below;
    begin = end + 1;
  }
  return at == value;
}

}  // namespace move_base_abstract
