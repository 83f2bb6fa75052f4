"""The sleeps of roslaunch's process monitor, which looks ten times a second: they end when a run does."""
import threading
import time

import roslaunch.nodeprocess
import roslaunch.pmon

_SHORT_S = 0.01  # wall, between two looks while a run ends


class Sleeps:
    """Stands for the module time in roslaunch's monitor from now on: its sleeps are short ones once hurry() was called.

    A run's end otherwise waits for a tenth of a second three times in a row.
    """

    def __init__(self):
        self._hurries = threading.Event()
        roslaunch.pmon.time = roslaunch.nodeprocess.time = self

    def hurry(self):
        """Have who sleeps wake up, and sleep for moments only from now on; from any thread."""
        self._hurries.set()

    def hurry_when(self, popen):
        """Do so when a process has ended."""
        def wait():
            popen.wait()
            self.hurry()
        threading.Thread(target=wait, daemon=True).start()

    def sleep(self, seconds):
        """Sleep [s, wall]."""
        if self._hurries.is_set():
            time.sleep(min(seconds, _SHORT_S))
        else:
            self._hurries.wait(seconds)

    time = staticmethod(time.time)
