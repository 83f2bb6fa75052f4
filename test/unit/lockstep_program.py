"""Threads of an application in lockstep, without ROS, sockets or wall clock; the time master is played by a script."""

import threading

from move_base_abstract.lockstep.scheduler import Scheduler
from move_base_abstract.lockstep.task import TurnLost
from move_base_abstract.lockstep.wire import NEVER

GUARD = 20.0  # s, wall


class Master:
    """A channel: grants the mail of a script at its time, and what the scheduler asks for; ends when nothing is left.

    script: list of (time, [actions]), in the order of time.
    """

    def __init__(self, *script):
        self.script = list(script)
        self.asked = []
        self.knocks = 0
        self.is_at_rest = False
        self.scheduler = Scheduler(self)

    def knock(self):
        self.knocks += 1

    def exchange(self):
        scheduler = self.scheduler
        self.asked.append(scheduler.next_ns())
        if self.knocks:
            self.knocks = 0
            return []
        self.is_at_rest = scheduler.is_resting and scheduler.now_ns < min(
            [scheduler.next_ns()] + [time_ns for time_ns, _ in self.script[:1]])
        if self.is_at_rest:
            return []
        time_ns = min([scheduler.next_ns()] + [time_ns for time_ns, _ in self.script[:1]])
        if time_ns == NEVER:
            scheduler.close()
            raise TurnLost()
        scheduler.now_ns = max(time_ns, scheduler.now_ns)
        return self.script.pop(0)[1] if self.script and self.script[0][0] <= scheduler.now_ns else []


class Program:
    """Threads of an application under a Master; ``trace`` has what they say, in order."""

    def __init__(self, *script):
        self.master = Master(*script)
        self.scheduler = self.master.scheduler
        self.trace = []
        self.threads = []

    def say(self, *what):
        assert self.scheduler.is_mine()
        self.trace.append((*what, self.scheduler.now_ns))

    def sayer(self, *what):
        return lambda: self.say(*what)

    def sleep(self, pause):
        self.scheduler.wait(self.scheduler.now_ns + pause)

    def thread(self, name, function, *arguments):
        """Start a thread; the caller has the turn."""
        task = self.scheduler.spawn(name)

        def live():
            self.scheduler.begin(task)
            try:
                function(*arguments)
            except TurnLost:
                pass
            finally:
                self.scheduler.finish()
        thread = threading.Thread(target=live, daemon=True)
        self._start(thread)
        return task

    def _start(self, thread):
        """Start a thread; while Python itself waits for it, the caller is none of the application's."""
        self.threads.append(thread)
        mine, self.scheduler.turn_ident = self.scheduler.turn_ident, 0
        thread.start()
        self.scheduler.turn_ident = mine

    def run(self, main):
        """Run main as the first thread until nothing is left to happen, and all threads have ended."""
        errors = []

        def live():
            self.scheduler.adopt_caller('main')
            try:
                main()
            except TurnLost:
                pass
            except BaseException as error:
                errors.append(error)
                self.scheduler.close()
            finally:
                self.scheduler.finish()
        thread = threading.Thread(target=live, daemon=True)
        self.threads.append(thread)
        thread.start()
        while not self._is_over():
            for thread in self.threads + workers():
                thread.join(GUARD)
                assert not thread.is_alive()
        if errors:
            raise errors[0]
        return self.trace

    def _is_over(self):
        """Whether all threads have ended; one that has just ended may have started another after it was listed."""
        threads = self.threads + workers()
        return not any(thread.is_alive() for thread in threads) and len(threads) == len(self.threads + workers())


def workers():
    return [thread for thread in threading.enumerate() if thread.name == 'lockstep_worker']
