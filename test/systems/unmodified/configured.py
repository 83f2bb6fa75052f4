#!/usr/bin/env python3
"""A dynamic_reconfigure server for a speed, without a .cfg file, or a client that changes the speed."""
import rospy
from dynamic_reconfigure import client
from dynamic_reconfigure.server import Server


class Speed:
    """The class that a .cfg file with one parameter makes."""
    min = {'speed': 0.0}
    max = {'speed': 10.0}
    defaults = {'speed': 1.0}
    level = {'speed': 1}
    type = {'speed': 'double'}
    all_level = 1
    config_description = {
        'name': 'Default', 'type': '', 'state': True, 'cstate': 'true', 'id': 0, 'parent': 0, 'parameters': [
            {'name': 'speed', 'type': 'double', 'default': 1.0, 'level': 1, 'description': 'm/s', 'min': 0.0, 'max': 10.0,
             'srcline': 0, 'srcfile': '', 'edit_method': '', 'cconsttype': '', 'ctype': 'double'}], 'groups': [],
        'class': 'DEFAULT', 'parentclass': '', 'parentname': 'Default', 'field': 'default', 'upper': 'DEFAULT',
        'lower': 'groups'}


def on_change(config, level):
    print('%.9f speed %.1f level %d' % (rospy.get_time(), config['speed'], level))
    return config


rospy.init_node('configured')
if rospy.get_param('~serve', False):
    server = Server(Speed, on_change)
    rospy.sleep(4.0)
    server.update_configuration({'speed': 7.5})
    rospy.spin()
else:
    other = client.Client('/server', timeout=3.0, config_callback=lambda config: print(
        '%.9f heard of %.1f' % (rospy.get_time(), config['speed'])))
    for speed in (2.5, 20.0):
        rospy.sleep(1.0)
        config = other.update_configuration({'speed': speed})
        print('%.9f got %.1f' % (rospy.get_time(), config['speed']))
    print('%.9f has %.1f' % (rospy.get_time(), other.get_configuration(timeout=1.0)['speed']))
    rospy.sleep(3.0)
    print('%.9f has %.1f' % (rospy.get_time(), other.get_configuration(timeout=1.0)['speed']))
