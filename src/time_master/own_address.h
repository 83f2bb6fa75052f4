// Makes this process listen only on the address that ROS announces.
#pragma once

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
