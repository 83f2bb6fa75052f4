#!/usr/bin/env python3
"""Write parameters at 10 Hz and read them again; delete them now and then."""
import sys

import rospy

rospy.init_node('writer')
name = rospy.get_name()
rate = rospy.Rate(10.0)
for count in range(1, int(sys.argv[1]) + 1):
    rospy.set_param('/board/latest', '{} {}'.format(name, count))
    assert rospy.get_param('/board/latest') == '{} {}'.format(name, count)
    rospy.set_param('/board' + name, {'count': count, 'odds': [1, 2.5, 'x<&>', True, '', [], {}], 'small': -1e-12})
    assert rospy.get_param('/board{}/odds'.format(name)) == [1, 2.5, 'x<&>', True, '', [], {}]
    if count % 5 == 0:
        rospy.delete_param('/board' + name)
        assert not rospy.has_param('/board{}/count'.format(name)) and rospy.search_param('board' + name) is None
        try:
            rospy.delete_param('/board' + name)
        except KeyError:
            pass
        else:
            raise AssertionError('it is still there')
    rate.sleep()
rospy.spin()
