// The library that this header belonged to is gone. This header stays for one release, to say so.
#error "lockstep::Participant is gone. Write an ordinary roscpp node (ros::NodeHandle, ros::Timer, ros::spin), \
and add to CMakeLists.txt: move_base_abstract_take_part(TARGET). See docs/lockstep_cpp.md of move_base_abstract"
