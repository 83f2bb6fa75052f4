#include "launcher.h"

#include <XmlRpc.h>
#include <dlfcn.h>
#include <ros/network.h>
#include <sys/personality.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "libc/preload.h"
#include "node.h"
#include "turn.h"

namespace move_base_abstract::shim {
namespace {

// The launcher (lockstep.programs.binary) sets the first four.
const char* const kChance = "MOVE_BASE_ABSTRACT_LOCKSTEP_CHANCE";
const char* const kSleep = "MOVE_BASE_ABSTRACT_LOCKSTEP_SLEEP";
const char* const kRank = "MOVE_BASE_ABSTRACT_LOCKSTEP_RANK";
const char* const kStrict = "MOVE_BASE_ABSTRACT_LOCKSTEP_STRICT";
const char* const kLooksOn = "MOVE_BASE_ABSTRACT_LOOKS_ON";
const char* const kLayout = "MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT";
constexpr unsigned long kAsk = 0xffffffff;

[[noreturn]] void refuse(const std::string& why) {
  std::fprintf(stderr, "lockstep: %s\n", why.c_str());
  std::_Exit(1);
}

/** @return whether the time master is in lockstep; false if the ROS master cannot be asked. */
bool isLockstep() {
  struct Silent : XmlRpc::XmlRpcErrorHandler {
    void error(const char*) override {}  // without a ROS master, roscpp says so itself
  } silent;
  const char* const uri = std::getenv("ROS_MASTER_URI");
  std::string host;
  std::uint32_t port = 0;
  if (uri == nullptr || !ros::network::splitURI(uri, host, port)) {
    return false;
  }
  XmlRpc::XmlRpcErrorHandler* const before = XmlRpc::XmlRpcErrorHandler::getErrorHandler();
  XmlRpc::XmlRpcErrorHandler::setErrorHandler(&silent);
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue request;
  XmlRpc::XmlRpcValue answer;
  request[0] = "/lockstep";
  request[1] = lockstep::internal::kModeParameter;
  const bool is_so = client.execute("getParam", request, answer) && !client.isFault() &&
                     static_cast<int>(answer[0]) == 1 &&
                     answer[2].getType() == XmlRpc::XmlRpcValue::TypeString &&
                     static_cast<std::string>(answer[2]) == lockstep::internal::kLockstepMode;
  XmlRpc::XmlRpcErrorHandler::setErrorHandler(before);
  return is_so;
}

/** @return the node's name as the command line has it, as the launcher reads it. */
std::string nodeName(const std::string& path, char** arguments) {
  const auto value_of = [arguments](const char* key, std::string value) {
    for (char** word = arguments; *word != nullptr; ++word) {
      value = std::strncmp(*word, key, std::strlen(key)) == 0 ? *word + std::strlen(key) : value;
    }
    return value;
  };
  const char* const set = std::getenv("ROS_NAMESPACE");
  std::string space = value_of("__ns:=", set == nullptr ? "" : set);
  space.erase(0, space.find_first_not_of('/'));
  space.erase(space.find_last_not_of('/') + 1);
  return (space.empty() ? "/" : "/" + space + "/") +
         value_of("__name:=", path.substr(path.rfind('/') + 1));
}

/** @brief Set what common.processes.for_one_thread gives other programs. */
void useOneThread() {
  for (const char* name : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"}) {
    ::setenv(name, "1", 0);
  }
  if (std::strcmp(std::getenv("OMP_NUM_THREADS"), "1") == 0) {
    ::setenv("OMP_THREAD_LIMIT", "1", 0);
  }
}

/** @brief Become this program anew, with the seed 0 and the same addresses in each run. */
[[noreturn]] void startAgain(char** arguments) {
  std::error_code error;
  const std::string path = std::filesystem::read_symlink("/proc/self/exe", error);
  if (std::strcmp(told().layout == nullptr ? "" : told().layout, "random") != 0) {
    ::personality(static_cast<unsigned long>(::personality(kAsk)) | ADDR_NO_RANDOMIZE);
  }
  ::setenv(kSleep, "wall", 1);
  useOneThread();
  ::setenv(kChance, ("0 " + nodeName(path, arguments)).c_str(), 1);
  ::execv(path.c_str(), arguments);
  refuse("cannot start " + path + " again: " + std::strerror(errno));
}

/** End the process if roscpp's functions come before this library's. */
void checkOrder() {
  Dl_info info{};
  void* const start = ::dlsym(RTLD_DEFAULT, "_ZN3ros5startEv");
  if (::dladdr(start, &info) == 0 || std::strstr(info.dli_fname, "roscpp_shim") == nullptr) {
    refuse(std::string("the program finds ros::start() in ") + info.dli_fname +
           ", before libmove_base_abstract_roscpp_shim.so; in CMakeLists.txt, "
           "move_base_abstract_take_part(TARGET) puts that library first");
  }
}

__attribute__((constructor)) void begin(int /*count*/, char** arguments) {
  const Inside inside;
  const bool is_linked = !leavePreload("roscpp_shim");
  if (is_linked && told().sleep == nullptr && told().looks_on == nullptr && isLockstep()) {
    checkOrder();
    startAgain(arguments);
  }
  for (const char* name : {kChance, kSleep, kRank, kStrict}) {
    unsetenv(name);  // programs that this one starts may be linked, too
  }
}

}  // namespace

const Told& told() {
  static const Told instance{std::getenv(kChance), std::getenv(kSleep),   std::getenv(kRank),
                             std::getenv(kStrict), std::getenv(kLooksOn), std::getenv(kLayout)};
  return instance;
}

}  // namespace move_base_abstract::shim
