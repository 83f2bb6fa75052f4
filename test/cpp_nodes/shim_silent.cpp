// A program that never answers. ~what: it computes, or it reads a pipe to which nobody writes.
#include <ros/ros.h>
#include <unistd.h>

#include <string>

namespace shim_silent {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "silent");
  ros::NodeHandle own("~");
  int ends[2];
  char byte = 0;
  if (own.param<std::string>("what", "computes") == "reads" && pipe(ends) == 0) {
    return static_cast<int>(read(ends[0], &byte, 1));
  }
  for (volatile int thoughts = 0;; thoughts = 1 - thoughts) {
  }
}

}  // namespace shim_silent
