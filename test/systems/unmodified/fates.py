#!/usr/bin/env python3
"""A program that ends in the way that its argument names, or does not end although something went wrong."""
import _thread
from _thread import start_new_thread
import asyncio
import atexit
import ctypes
import os
import signal
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.pool import ThreadPool

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from std_msgs.msg import Int32
from std_srvs.srv import SetBool, Trigger

DAY = 86400.0


def at(tick, action):
    """Call ``action`` in a callback, at a tick of the clock node."""
    rospy.Subscriber('/ticks', Int32, lambda message: action() if message.data == tick else None)


def fail():
    raise KeyError('robot_7')


def client():
    """Send two goals; the callback at the end of the second one fails."""
    goals = actionlib.SimpleActionClient('/robot/move_base', MoveBaseAction)
    goals.wait_for_server()
    results = []

    def done(status, result):
        results.append(result)
        if len(results) == 2:
            rospy.loginfo('took %s', results[1].duration)
    for x in (0.5, 1.0):
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.pose.position.x = x
        goal.target_pose.pose.orientation.w = 1.0
        goals.send_goal(goal, done_cb=done)
        goals.wait_for_result()
    rospy.spin()


def server():
    executed = actionlib.SimpleActionServer('failing', MoveBaseAction, lambda goal: fail(), False)
    executed.start()
    own = actionlib.SimpleActionClient('failing', MoveBaseAction)
    own.wait_for_server()
    own.send_goal_and_wait(MoveBaseGoal())
    rospy.spin()


def service():
    rospy.Service('~ask', Trigger, lambda request: fail())
    rospy.sleep(2.0)
    try:
        rospy.ServiceProxy('~ask', Trigger)()
    except rospy.ServiceException:
        rospy.spin()


def called_back():
    """Serve an action whose goal and preempt callbacks fail; actionlib itself catches the exception of the first."""
    failing = actionlib.SimpleActionServer('called_back', MoveBaseAction, auto_start=False)
    failing.register_goal_callback(lambda: (failing.accept_new_goal(), fail()))
    failing.register_preempt_callback(fail)
    failing.start()
    own = actionlib.SimpleActionClient('called_back', MoveBaseAction)
    own.wait_for_server()
    own.send_goal(MoveBaseGoal())
    rospy.sleep(1.0)
    own.cancel_goal()
    return failing, own


def job():
    rospy.sleep(1.0)
    fail()


async def task():
    await asyncio.sleep(1.0)
    fail()


async def awaits(one):
    await one


def jobs():
    """Raise fourteen exceptions: in callbacks, and in jobs whose outcome is never asked for."""
    executor = ThreadPoolExecutor(2)
    kept = [executor.submit(job)]  # the first job; its future is kept to the end
    rospy.sleep(3.0)
    executor.submit(job)
    executor.submit(rospy.sleep, 0.5).add_done_callback(lambda future: fail())
    pool = ThreadPool(1)
    pool.apply_async(job)
    pool.map_async(rospy.sleep, ['long'])
    start_new_thread(job, ())  # imported before the program is a node
    at(9, lambda: sys.exit(1))
    rospy.Service('~leave', Trigger, lambda request: sys.exit(1))
    try:
        rospy.ServiceProxy('~leave', Trigger)()
    except rospy.ServiceException:
        pass  # the caller does not wait for ever
    kept.append(called_back())

    async def main():
        kept.append(asyncio.ensure_future(task()))
        asyncio.ensure_future(awaits(asyncio.ensure_future(task())))
        asyncio.get_running_loop().call_later(0.5, fail)
        kept.append(asyncio.gather(task(), asyncio.sleep(DAY)))
        await asyncio.sleep(DAY)
    asyncio.run(main())


def derived():
    """Raise three exceptions that are not of class Exception, and one in a callback of a C library."""
    class Stop(BaseException):
        pass

    def stop(*_):
        raise Stop
    at(2, stop)
    rospy.Timer(rospy.Duration(2.5), stop)
    compare = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(lambda *_: fail())
    rospy.sleep(3.0)
    ctypes.CDLL(None).qsort((ctypes.c_int * 2)(2, 1), 2, 4, compare)
    threading.Thread(target=stop).start()
    rospy.spin()


def items():
    """Take one of three items of pools whose jobs fail."""
    pool, other = ThreadPool(1), ThreadPool(1)
    kept = pool.imap(lambda _: fail(), [1, 2]), other.imap_unordered(lambda _: fail(), [1])
    rospy.sleep(1.0)
    try:
        next(kept[0])
    except KeyError:
        rospy.spin()


def taken():
    """Take all items of pools whose jobs fail, after a while."""
    pool = ThreadPool(1)
    for results in (pool.imap(lambda _: job(), [1, 2]), pool.imap_unordered(lambda _: job(), [1])):
        rospy.sleep(5.0)
        while True:
            try:
                results.next()
            except StopIteration:
                break
            except KeyError:
                continue
    rospy.spin()


def interrupts():
    """Raise KeyboardInterrupt, as a program may that reads a key; no signal has come."""
    rospy.sleep(2.0)
    raise KeyboardInterrupt


def saves():
    """Shut the node down, then fail while the results are saved."""
    at(2, lambda: rospy.signal_shutdown('all is done'))
    try:
        rospy.sleep(DAY)
    except rospy.ROSInterruptException:
        fail()


def odd():
    """Subscribe with a callback that takes no message."""
    rospy.Subscriber('/ticks', Int32, lambda: None)
    rospy.spin()


def asked():
    """Run jobs that fail, and ask for the outcome of each after a while."""
    executor, pool, answers = ThreadPoolExecutor(3), ThreadPool(1), []
    first, second, third = (executor.submit(job) for _ in range(3))
    third.add_done_callback(lambda future: answers.append(future.exception()))
    results = pool.apply_async(job), pool.apply_async(job, error_callback=answers.append)
    _thread.start_new_thread(sys.exit, ())
    rospy.sleep(5.0)
    for ask in (first.result, results[0].get):
        try:
            ask()
        except KeyError as error:
            answers.append(error)
    assert isinstance(second.exception(), KeyError) and len(answers) == 4

    async def main():
        one, other = asyncio.ensure_future(task()), asyncio.ensure_future(awaits(asyncio.ensure_future(task())))
        await asyncio.sleep(3.0)
        try:
            await one
        except KeyError:
            pass
        del one
        await asyncio.gather(task(), task(), return_exceptions=True)
        try:
            await asyncio.gather(task(), asyncio.sleep(1.0))
        except KeyError:
            pass
        await asyncio.wait([other])
        assert isinstance(other.exception(), KeyError)
        asyncio.get_running_loop().set_exception_handler(lambda loop, context: answers.append(context))
        asyncio.get_running_loop().call_soon(fail)
        answers.append(asyncio.ensure_future(task()))
        await asyncio.sleep(DAY)
    asyncio.run(main())


def unsaved():
    """End with exit code 0, although the functions that are called at the end fail."""
    atexit.register(fail)
    rospy.on_shutdown(lambda: {}['results'])
    at(2, lambda: rospy.signal_shutdown('all is done'))
    rospy.spin()


def asks():
    rospy.wait_for_service('/refuse')
    try:
        rospy.ServiceProxy('/refuse', SetBool)(True)
    except rospy.ServiceException:
        rospy.spin()


def ended_thread(**options):
    threading.Thread(target=lambda: (rospy.sleep(3.0), fail()), **options).start()
    rospy.spin()


def shut_down():
    at(3, lambda: rospy.signal_shutdown('all is done'))
    rospy.sleep(DAY)


def looks_on():
    """Look on without taking part; publish a message after the error."""
    said = rospy.Publisher('/seen', Int32, queue_size=1)
    heard = []

    def hear(message):
        heard.append(message)
        said.publish(message if len(heard) > 1 else fail())
    rospy.Subscriber('/ticks', Int32, hear)
    rospy.spin()


def last_round():
    """End the run with an error that is its last event."""
    rospy.sleep(30.0)
    rospy.wait_for_message('/seen', Int32)
    fail()


FATES = {
    'callback': lambda: (at(2, fail), rospy.spin()), 'client': client, 'server': server, 'service': service,
    'asks': asks, 'timer': lambda: (rospy.Timer(rospy.Duration(2.5), lambda event: fail()), rospy.spin()),
    'thread': lambda: ended_thread(), 'daemon': lambda: ended_thread(name='pump', daemon=True),
    'raises': lambda: (rospy.sleep(2.0), fail()), 'exits': lambda: (rospy.sleep(2.0), sys.exit(3)),
    'interrupts': interrupts,
    'vanishes': lambda: (rospy.sleep(2.0), os._exit(4)), 'faults': lambda: (
        rospy.sleep(2.0), os.kill(os.getpid(), signal.SIGSEGV)),
    'killed': lambda: (rospy.sleep(2.0), os.kill(os.getpid(), signal.SIGKILL)),
    'derived': derived, 'items': items, 'taken': taken, 'saves': saves, 'odd': odd, 'jobs': jobs, 'asked': asked, 'unsaved': unsaved, 'last_round': last_round, 'looks_on': looks_on, 'shut_down': shut_down, 'ends': lambda: rospy.sleep(2.0), 'waits': lambda: rospy.sleep(DAY)}


def main():
    words = rospy.myargv()
    rospy.init_node('fate')
    FATES[words[1]]()


if __name__ == '__main__':
    main()
