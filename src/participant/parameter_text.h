// Parameters of ROS as XML-RPC can say them.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_PARAMETER_TEXT_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_PARAMETER_TEXT_H

#include <xmlrpcpp/XmlRpcValue.h>

#include <string>

namespace move_base_abstract::lockstep::internal {

/**
 * @return @p value as XML-RPC says it; empty: it cannot. It has no type, or something in it has
 * none; a text in it is no UTF-8, or has control characters.
 */
std::string parameterText(const XmlRpc::XmlRpcValue& value);

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_PARAMETER_TEXT_H
