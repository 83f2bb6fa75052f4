"""The program that replaced_probe.py launches."""
import replaced_probe
import rospy

rospy.init_node('probe')
replaced_probe.tell()
