#!/usr/bin/env python3
"""Runs a mission that it has as text, and a plugin that it loads from a file; each waits in a loop without sleep."""
import email.utils
import importlib.util
import logging
import os
import sys

import rospy
from std_msgs.msg import String

MISSION = '''
import datetime
def go():
    while not heard:
        pass
    print('mission %.9f %s' % (rospy.get_time(), datetime.datetime.now()))
    print([f() for f in {lambda: 1, lambda: 2}] != [])
go()
'''


class Shown(logging.Handler):
    def emit(self, record):
        print('log', self.format(record))


def load(path):
    spec = importlib.util.spec_from_file_location('plugin', path)
    plugin = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(plugin)
    return plugin


rospy.init_node('mission_texts')
heard = []
log = logging.getLogger('mission')
log.propagate = False
shown = Shown()
shown.setFormatter(logging.Formatter('%(asctime)s %(message)s'))
log.addHandler(shown)
subscriber = rospy.Subscriber('greeting', String, lambda message: (log.warning('heard'), heard.append(message)))
exec(compile(MISSION, 'mission.txt', 'exec'))
subscriber.unregister()
del heard[:]
again = rospy.Subscriber('greeting', String, heard.append)
load(os.path.join(os.path.dirname(os.path.abspath(__file__)), 'mission_plugin.py')).wait_for(heard)
print('plugin %.9f' % rospy.get_time())
print(eval('1 + n', {'n': 2, '__builtins__': {}}), eval(' len(names)', {'names': 'ab'}), eval('len(heard) > 0'))
bare = {'': {'__builtins__': {}}}
TEXT = '[one for one in {1}]'
print(eval(TEXT, bare['']), eval(compile(TEXT, 'bare', 'eval'), bare['']), eval(*(TEXT, {'__builtins__': None})),
      eval(TEXT, dict(__builtins__={})))
print(email.utils.make_msgid() != '', file=sys.stderr)
