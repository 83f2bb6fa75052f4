// A participant by the library that makes statements about properties.
#include <move_base_abstract/lockstep_participant.h>
#include <ros/ros.h>

#include "statements.h"

namespace lockstep_statements {

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "statements");
  move_base_abstract::lockstep::Participant participant;
  for (int k = 0; k < 5 && participant.sleep(ros::Duration(1.0)); ++k) {
    stateAll(k);
  }
  return 0;
}

}  // namespace lockstep_statements
