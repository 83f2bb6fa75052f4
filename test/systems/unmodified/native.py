#!/usr/bin/env python3
"""Ask libraries in C what they see: by ctypes, which releases Python's lock, or by a module, which keeps it."""
import ctypes
import sys
import time

import rospy
from std_msgs.msg import String


def by_ctypes(path):
    library = ctypes.CDLL(path)

    def ask(topic):
        text = ctypes.create_string_buffer(10000)
        library.ask_text(topic.encode(), text, ctypes.c_size_t(len(text)))
        return text.value.decode()
    return ask


def main():
    path, *topics = rospy.myargv()[1:]
    if path.endswith('native_module.so'):
        sys.path.insert(0, path.rpartition('/')[0])
        import native_module
        ask = native_module.ask
    else:
        ask = by_ctypes(path)
    print('early', ask(topics[0]))
    rospy.init_node('native')
    said = rospy.Publisher('said', String, queue_size=100)
    for pause in (0.0, 1.5):
        rospy.sleep(pause)
        for topic in topics:
            text = '{} {} {} {}'.format(topic, ask(topic), time.time_ns(), rospy.get_time())
            said.publish(text)
            print(text)


main()
