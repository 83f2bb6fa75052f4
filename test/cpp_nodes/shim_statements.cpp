// A program that makes statements about properties and knows nothing of lockstep: each second some
// that are broken, kept, and never true.
#include <move_base_abstract/properties.h>
#include <ros/ros.h>

namespace shim_statements {

int nodeMain(int argc, char** argv) {
  using namespace move_base_abstract::properties;
  ros::init(argc, argv, "statements");
  const ros::NodeHandle node;
  for (int k = 0; k < 5 && ros::Duration(1.0).sleep(); ++k) {
    always(k < 3, "k stays small", {detail("k", k), detail("a\n\"b\"", 0.5)});
    sometimes(k > 10, "k gets large");
    sometimes(k > 1, "k gets past 1");
    never_again(k % 2 == 1, "k is odd once");
  }
  return 0;
}

}  // namespace shim_statements
