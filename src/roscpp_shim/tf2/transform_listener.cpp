// Replaces functions of tf2, whose listener only puts transforms into a buffer.
//
// tf2_ros::TransformListener does so in a thread of its own. A thread looks for transforms only
// when it has something else to do. So all waiting transforms are delivered together at that
// moment, and no round is spent on each. If the program asks the buffer to call it back, each
// transform is delivered at once again.
#include <ros/time.h>

#include <boost/function.hpp>
#include <boost/signals2/connection.hpp>
#include <cstdint>
#include <string>

#include "roscpp_shim/delivery.h"
#include "roscpp_shim/followed.h"
#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/waits.h"

namespace move_base_abstract::shim {
namespace {

/** @return whether @p caller is the listener's loop. The thread that ends the loop then joins it.
 */
bool isListenersLoop(const void* caller) {
  static __thread const void* t_caller = nullptr;  // the latest caller
  static __thread bool t_is_listeners = false;
  if (t_caller != caller) {
    t_caller = caller;
    t_is_listeners = isIn(caller, {"libtf2_ros.so"});
  }
  return t_is_listeners;
}

__attribute__((constructor)) void followListeners() { setStoringLoops(&isListenersLoop); }

}  // namespace
}  // namespace move_base_abstract::shim

#pragma GCC visibility push(default)

namespace tf2 {

enum TransformableResult { TransformAvailable, TransformFailure };
using TransformableCallback = boost::function<void(
    std::uint64_t, const std::string&, const std::string&, ros::Time, TransformableResult)>;

/** @brief The members of tf2's class that are needed. This library is built without tf2. */
class BufferCore {
 public:
  std::uint32_t addTransformableCallback(const TransformableCallback& callback);
  boost::signals2::connection _addTransformsChangedListener(boost::function<void(void)> callback);
};

std::uint32_t BufferCore::addTransformableCallback(const TransformableCallback& callback) {
  static auto* const function = shim::real(&BufferCore::addTransformableCallback,
                                           "tf2::BufferCore::addTransformableCallback");
  shim::storeNoMore();
  return function(this, callback);
}

boost::signals2::connection BufferCore::_addTransformsChangedListener(
    boost::function<void(void)> callback) {
  static auto* const function = shim::real(&BufferCore::_addTransformsChangedListener,
                                           "tf2::BufferCore::_addTransformsChangedListener");
  shim::storeNoMore();
  return function(this, callback);
}

}  // namespace tf2

#pragma GCC visibility pop
