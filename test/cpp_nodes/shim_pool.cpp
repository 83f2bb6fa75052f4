// A timer whose callback has a library do a loop by ~threads threads, as programs do by OpenCV and
// TBB: ~library is the path of test/native_libraries' tbb_stand_in. What it did is told on "told".
#include <dlfcn.h>
#include <ros/ros.h>

#include <string>

#include "teller.h"

namespace shim_pool {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "pool");
  ros::NodeHandle node;
  ros::NodeHandle own("~");
  const Teller teller("told");
  void* const library = dlopen(own.param<std::string>("library", "").c_str(), RTLD_NOW);
  auto* const loop = reinterpret_cast<int (*)(int)>(dlsym(library, "tbb_stand_in_loop"));
  const int threads = own.param("threads", 0);
  int left = 3;
  const ros::TimerCallback work = [&](const ros::TimerEvent&) {
    teller.tell("threads: " + std::to_string(loop(threads)));
    if (--left == 0) {
      ros::shutdown();
    }
  };
  const ros::Timer timer = node.createTimer(ros::Duration(1.0), work);
  ros::spin();
  return 0;
}

}  // namespace shim_pool
