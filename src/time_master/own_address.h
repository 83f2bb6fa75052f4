// On which address this process listens: the one that ROS announces, and no other.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_OWN_ADDRESS_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_OWN_ADDRESS_H

namespace move_base_abstract {

/**
 * @brief Set ROS_IP to 127.0.0.1 where nothing says what it is, and the ROS master is named as one
 * of this computer. To be called before ros::init.
 *
 * The file that defines it also stands in front of bind(), for the whole process: roscpp's XML-RPC
 * server listens on all addresses, so that whoever reaches the computer could shut the node down.
 */
void setDefaultAddress();

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_OWN_ADDRESS_H
