// Threads that wait in read(), again and again, for what another one writes.
#include <ros/ros.h>
#include <unistd.h>

#include <array>
#include <string>
#include <thread>
#include <vector>

#include "teller.h"

namespace shim_readers {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "readers");
  ros::NodeHandle node;
  const Teller teller("told");
  std::array<int[2], 4> ends;
  std::vector<std::thread> threads;
  for (auto& pair : ends) {
    if (::pipe(pair) != 0) {
      return 1;
    }
    threads.emplace_back([&teller, from = pair[0]] {
      for (char letter = 0; ::read(from, &letter, 1) == 1;) {
        teller.tell(std::string("got ") + letter);
      }
    });
  }
  for (const char letter : {'a', 'b', 'c'}) {
    ros::Duration(0.1).sleep();
    for (const auto& pair : ends) {
      if (::write(pair[1], &letter, 1) != 1) {
        return 1;
      }
    }
  }
  ros::Duration(0.1).sleep();
  for (const auto& pair : ends) {
    ::close(pair[1]);
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  teller.tell("goes on");
  return 0;
}

}  // namespace shim_readers
