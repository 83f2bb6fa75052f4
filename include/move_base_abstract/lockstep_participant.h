// lockstep::Participant has gone, and with it its library. Write an ordinary roscpp node with
// ros::NodeHandle, ros::Timer and ros::spin, and add to its CMakeLists.txt:
//   move_base_abstract_take_part(TARGET)
// docs/lockstep_cpp.md has a table of what to write. This header stays for one release to say so.
#error "lockstep::Participant has gone: use plain roscpp and move_base_abstract_take_part(TARGET)"
