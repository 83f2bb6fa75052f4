"""Start a thread before this program takes part, and one while it begins to: labels know no participant yet."""
import threading
from types import SimpleNamespace

from move_base_abstract_ros.lockstep.code.labels import told
from move_base_abstract_ros.lockstep.waiting import threads


def start():
    thread = threading.Thread(target=print, args=('ran',))
    thread.start()
    thread.join()


def take_part(_what):
    print('asked')
    return False


threads.watch_start(take_part)
start()
threads.install(SimpleNamespace(scheduler=SimpleNamespace(is_mine=lambda: False)), own_threads=False)
start()
print(len(told._texts))
