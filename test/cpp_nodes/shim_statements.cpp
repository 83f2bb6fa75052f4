// A program that makes statements about properties and knows nothing of lockstep.
#include <ros/ros.h>

#include "statements.h"

namespace shim_statements {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "statements");
  const ros::NodeHandle node;
  for (int k = 0; k < 5 && ros::Duration(1.0).sleep(); ++k) {
    stateAll(k);
  }
  return 0;
}

}  // namespace shim_statements
