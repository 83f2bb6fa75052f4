"""Shorten the sleeps of roslaunch's process monitor, which looks ten times a second, when a run ends."""
import threading
import time

import roslaunch.nodeprocess
import roslaunch.pmon

_SHORT_S = 0.01  # wall, between two looks while a run ends


class Sleeps:
    """Takes the place of the module time in roslaunch's monitor. After a call of hurry() all sleeps are short.

    Otherwise the end of a run would wait for a tenth of a second three times in a row.
    """

    def __init__(self):
        self._hurries = threading.Event()
        roslaunch.pmon.time = roslaunch.nodeprocess.time = self

    def hurry(self):
        """End all sleeps that go on, and make all later ones short. May be called from any thread."""
        self._hurries.set()

    def hurry_when(self, popen):
        """Call hurry() when the process ``popen`` has ended."""
        def wait():
            popen.wait()
            self.hurry()
        threading.Thread(target=wait, daemon=True).start()

    def sleep(self, seconds):
        """Sleep for ``seconds`` of wall time, or shorter after hurry()."""
        if self._hurries.is_set():
            time.sleep(min(seconds, _SHORT_S))
        else:
            self._hurries.wait(seconds)

    time = staticmethod(time.time)
