"""A module of a program: a partner that sends words."""
import threading

import rospy
from std_msgs.msg import String


class Partner:
    def __init__(self):
        self.last = None
        self.lock = threading.Lock()
        rospy.Subscriber('/partner', String, self.on_word)

    def on_word(self, message):
        with self.lock:
            self.last = message.data

    def ready(self):
        with self.lock:
            return self.last is not None

    def wait_for(self, word):
        while True:
            with self.lock:
                if self.last == word:
                    return self.last

    def wait(self):
        self.last = None
        while not self.ready():
            pass

    def has_spoken(self):
        return bool(str(self.last or '').strip())

    def wait_to_speak(self):
        self.last = None
        while not self.has_spoken():
            pass
