// Makes this process listen only on the address that ROS announces.
#ifndef MOVE_BASE_ABSTRACT_TIME_MASTER_OWN_ADDRESS_H
#define MOVE_BASE_ABSTRACT_TIME_MASTER_OWN_ADDRESS_H

namespace move_base_abstract {

/**
 * @brief Set ROS_IP to 127.0.0.1, if neither it nor ROS_HOSTNAME is set, and ROS_MASTER_URI names
 * this computer or is not set. Call this before ros::init.
 *
 * The file that defines this also replaces bind() for the whole process. By itself, roscpp's
 * XML-RPC server listens on all addresses, so anybody who reaches the computer could shut the node
 * down.
 */
void setDefaultAddress();

}  // namespace move_base_abstract

#endif  // MOVE_BASE_ABSTRACT_TIME_MASTER_OWN_ADDRESS_H
