#include "parameter_text.h"

#include <algorithm>

#include "lockstep/wire/utf8.h"

namespace move_base_abstract::lockstep::internal {
namespace {

/** @return whether @p text is allowed in XML 1.0, where xmlrpcpp puts it unchanged. */
bool canStand(const std::string& text) {
  const auto is_control = [](char letter) {
    return static_cast<unsigned char>(letter) < ' ' && letter != '\t' && letter != '\n' &&
           letter != '\r';
  };
  return isUtf8(text) && std::none_of(text.begin(), text.end(), is_control);
}

}  // namespace

std::string parameterText(const XmlRpc::XmlRpcValue& value) {
  const std::string text = value.toXml();
  int offset = 0;
  const bool is_whole = canStand(text) && XmlRpc::XmlRpcValue(text, &offset).valid();
  return is_whole ? text : "";
}

}  // namespace move_base_abstract::lockstep::internal
