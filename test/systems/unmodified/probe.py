#!/usr/bin/env python3
"""Prints how it was started."""
import inspect
import pickle
import sys

import rospy


class Thing:
    def __init__(self, value):
        self.value = value


def main():
    rospy.init_node('probe')
    print('argv %s, without remaps %s' % (sys.argv, rospy.myargv()))
    print('file %s' % __file__)
    print('path %s' % sys.path[0])
    print('doc %s, package %r, spec %s, builtins %s, loader %s' % (
        __doc__, __package__, __spec__ and __spec__.name, type(__builtins__).__name__, type(__loader__).__name__))
    print('main is here: %s' % (sys.modules['__main__'].__dict__ is globals()))
    try:
        print('pickle %d' % pickle.loads(pickle.dumps(Thing(7))).value)
    except pickle.PicklingError as e:
        print('pickle %s' % e)
    print('source %s' % inspect.getsource(main).splitlines()[0])
    print('name %s, topic %s, parameters %s %s' % (
        rospy.get_name(), rospy.resolve_name('topic'), rospy.get_param('~x', None), rospy.get_param('~y', None)))
    print('time is simulated: %s' % (rospy.get_time() < 1000.0))
    sys.exit(3)


if __name__ == '__main__':
    main()
