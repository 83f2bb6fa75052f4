#!/usr/bin/env python3
"""Use asyncio as programs do: a loop in the main thread, or a loop in a thread that rospy's callbacks call.

usage: event_loops.py main | thread | cancel
"""
import asyncio
import concurrent.futures
import threading
import time

import rospy
from std_msgs.msg import String


def say(*words):
    text = '%g %s' % (rospy.get_time(), ' '.join(str(word) for word in words))
    print(text, flush=True)
    said.publish(text)


def compute(number):
    rospy.sleep(0.25)
    return number * number


class Room:
    """The objects that the coroutines share."""

    def __init__(self):
        self.jobs = asyncio.Queue(maxsize=2)
        self.done = asyncio.Event()

    async def worker(self, name):
        while True:
            job = await self.jobs.get()
            await asyncio.sleep(0.1 * (job % 3))
            say(name, job)
            self.jobs.task_done()


async def nap(number):
    await asyncio.sleep(1.0)
    say('nap', number)
    return number


async def main():
    loop = asyncio.get_running_loop()
    begin = loop.time()
    say('begins', begin - time.monotonic())
    rospy.Subscriber('~ticks', String, lambda text: loop.call_soon_threadsafe(say, 'heard', text.data))
    room = Room()
    workers = [loop.create_task(room.worker(name)) for name in 'abc']
    for number in range(7):
        await room.jobs.put(number)
    await room.jobs.join()
    for one in workers:
        one.cancel()
    say(*[type(result).__name__ for result in await asyncio.gather(*workers, return_exceptions=True)])
    handles = [loop.call_later(0.3, say, 'later', number) for number in range(6)]
    handles[2].cancel()
    loop.call_at(loop.time() + 0.125, say, 'at')
    try:
        await asyncio.wait_for(room.done.wait(), 0.5)
    except asyncio.TimeoutError:
        say('timeout')
    say(*await asyncio.gather(*[loop.run_in_executor(None, compute, number) for number in range(4)]))
    say(*[await one for one in asyncio.as_completed([nap(number) for number in range(8)])])
    done, _pending = await asyncio.wait([loop.create_task(nap(number)) for number in range(8)], timeout=2.0)
    say('set', *[one.result() for one in done])
    futures = [loop.create_future() for _ in range(8)]
    for number, future in enumerate(futures):
        loop.call_soon(future.set_result, number)
    done, _pending = await asyncio.wait(futures)
    say('futures', *[one.result() for one in done])
    flags = []
    loop.call_later(0.0625, flags.append, True)
    while not flags:
        await asyncio.sleep(0)
    say('flag')
    say('ends', round(loop.time() - begin, 6), round(rospy.get_time(), 6))


class Agent:
    """An event loop in a thread of its own, for use from callbacks."""

    def __init__(self):
        self.loop = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self.thread.start()
        self.turns = 0
        rospy.Subscriber('~ticks', String, self.on_tick)

    async def work(self, text):
        self.turns += 1
        await asyncio.sleep(0.0625 * self.turns)
        say('worked', text)
        return self.turns

    def on_tick(self, text):
        future = asyncio.run_coroutine_threadsafe(self.work(text.data), self.loop)
        try:
            say('result', future.result(timeout=0.2))
        except concurrent.futures.TimeoutError:
            say('timeout', future.cancel())

    def end(self):
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join()
        say('joined')


async def sleeper(number):
    try:
        await asyncio.sleep(60.0)
    finally:
        say('cleans up', number)


async def cancelled():
    tasks = [asyncio.get_running_loop().create_task(sleeper(number)) for number in range(12)]
    await asyncio.wait(tasks, timeout=0.5)


rospy.init_node('event_loops')
said = rospy.Publisher('~said', String, queue_size=100)
role = rospy.myargv()[1]
ticks = rospy.Publisher('~ticks', String, queue_size=10)
rospy.Subscriber('~said', String, lambda text: None)
timer = rospy.Timer(rospy.Duration(0.4), lambda event: ticks.publish('tick'))
if role == 'main':
    asyncio.run(main())
elif role == 'cancel':
    asyncio.run(cancelled())
else:
    agent = Agent()
    rospy.sleep(3.0)
    agent.end()
timer.shutdown()
rospy.sleep(0.1)
