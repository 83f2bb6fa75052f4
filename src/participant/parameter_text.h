// Values of ROS parameters as XML-RPC.
#ifndef MOVE_BASE_ABSTRACT_PARTICIPANT_PARAMETER_TEXT_H
#define MOVE_BASE_ABSTRACT_PARTICIPANT_PARAMETER_TEXT_H

#include <xmlrpcpp/XmlRpcValue.h>

#include <string>

namespace move_base_abstract::lockstep::internal {

/**
 * @return @p value as XML-RPC; empty if XML-RPC cannot express it: it, or a part of it, has no
 * type, or a text in it is not UTF-8 or has control characters.
 */
std::string parameterText(const XmlRpc::XmlRpcValue& value);

}  // namespace move_base_abstract::lockstep::internal

#endif  // MOVE_BASE_ABSTRACT_PARTICIPANT_PARAMETER_TEXT_H
