#!/usr/bin/env python3
"""Go through sets of threads and functions, whose order depends on addresses."""
import threading

import rospy
from slots import Slot

rospy.init_node('shifts')
threads = {threading.Thread(target=rospy.sleep, args=(number,)) for number in range(3)}
for thread in threads:
    thread.start()
first = {print, len, rospy.sleep}.pop()
slots = [slot.number for slot in {Slot(1), Slot(2)}]
said = []
any(said.append(bound()) for bound in {Slot(number).go for number in range(3)})
names = sorted(thread.name for thread in threads)
alone = [thread for thread in {threading.current_thread()}]
numbers = [number for number in {3, 2, 1}]
texts = list({'a', 'b', 'c'})
