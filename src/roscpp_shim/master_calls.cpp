// Calls of the ROS master and look-ups of names: they take wall time, while simulated time stands.
#include <XmlRpc.h>
#include <netdb.h>
#include <ros/master.h>

#include <string>

#include "real.h"
#include "turn.h"

namespace shim = move_base_abstract::shim;

namespace {

/** @brief What one of the program's threads does not do while another one runs: it has the turn. */
class Standing {
 public:
  Standing() : has_turn_(shim::turn().holds()) {}

 private:
  [[maybe_unused]] bool has_turn_;  // got back, where it ran beside the others
  shim::Blocking blocking_;
};

}  // namespace

namespace ros::master {

bool execute(const std::string& method, const XmlRpc::XmlRpcValue& request,
             XmlRpc::XmlRpcValue& response, XmlRpc::XmlRpcValue& payload, bool wait_for_master) {
  using Execute = bool(const std::string&, const XmlRpc::XmlRpcValue&, XmlRpc::XmlRpcValue&,
                       XmlRpc::XmlRpcValue&, bool);
  static Execute* const function = shim::real<Execute>(
      "_ZN3ros6master7executeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKN6XmlRpc11"
      "XmlRpcValueERSA_SD_b");
  const Standing standing;
  return function(method, request, response, payload, wait_for_master);
}

}  // namespace ros::master

namespace XmlRpc {

bool XmlRpcClient::execute(const char* method, const XmlRpcValue& parameters, XmlRpcValue& result) {
  using Execute = bool(XmlRpcClient*, const char*, const XmlRpcValue&, XmlRpcValue&);
  static Execute* const function =
      shim::real<Execute>("_ZN6XmlRpc12XmlRpcClient7executeEPKcRKNS_11XmlRpcValueERS3_");
  const Standing standing;
  return function(this, method, parameters, result);
}

}  // namespace XmlRpc

#pragma GCC visibility push(default)
extern "C" {

int getaddrinfo(const char* node, const char* service, const addrinfo* hints, addrinfo** result) {
  using GetAddresses = int(const char*, const char*, const addrinfo*, addrinfo**);
  static GetAddresses* const function = shim::real<GetAddresses>("getaddrinfo");
  const Standing standing;
  return function(node, service, hints, result);
}

hostent* gethostbyname(const char* name) {
  using GetHost = hostent*(const char*);
  static GetHost* const function = shim::real<GetHost>("gethostbyname");
  const Standing standing;
  return function(name);
}

}  // extern "C"
#pragma GCC visibility pop
