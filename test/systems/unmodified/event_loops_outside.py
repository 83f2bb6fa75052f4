#!/usr/bin/env python3
"""Have asyncio wait for events from outside (a child, a pipe, connections, signals), or for ever.

usage: event_loops_outside.py child | pipe | server | signal | early | forever
"""
import asyncio
import os
import signal
import sys
import time

import rospy
from std_msgs.msg import String


def say(*words):
    print(rospy.get_time(), *words, flush=True)


async def child():
    process = await asyncio.create_subprocess_exec('sh', '-c', 'sleep 0.3; echo done', stdout=asyncio.subprocess.PIPE)
    output, _error = await process.communicate()
    say(output.decode().strip(), process.returncode)


async def pipe():
    there, write = asyncio.Event(), os.pipe()
    asyncio.get_running_loop().add_reader(write[0], there.set)
    rospy.Timer(rospy.Duration(1.0), lambda event: os.write(write[1], b'x'), oneshot=True)
    while not there.is_set():
        await asyncio.sleep(0.125)
    say('read', os.read(write[0], 1))
    asyncio.get_running_loop().remove_reader(write[0])


async def server():
    async def answer(reader, writer):
        writer.write((await reader.readline()).upper())
        await writer.drain()
        writer.close()
    listening = await asyncio.start_server(answer, '127.0.0.1', 0)
    reader, writer = await asyncio.open_connection(*listening.sockets[0].getsockname())
    writer.write(b'hello\n')
    say((await reader.readline()).decode().strip())
    writer.close()
    listening.close()


async def handled():
    there = asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGUSR1, there.set)
    await asyncio.sleep(0.5)
    say('slept')
    rospy.Timer(rospy.Duration(0.25), lambda event: signal.raise_signal(signal.SIGUSR1), oneshot=True)
    while not there.is_set():
        await asyncio.sleep(0.5)
    say('caught')


async def early():
    loop = asyncio.get_running_loop()
    begin, there = loop.time(), loop.create_future()
    loop.call_later(0.5, there.set_result, True)
    await there
    print('waited %.3f %.3f' % (loop.time() - begin, loop.time() - time.monotonic()))
    rospy.init_node('early')
    say('joined')
    await asyncio.sleep(0.5)
    say('slept')


async def forever():
    try:
        while not rospy.is_shutdown():
            await asyncio.sleep(3.0)
            say('slept')
        await asyncio.Event().wait()
    finally:
        print('cleaned up')


def main():
    role = rospy.myargv()[1]
    if role != 'early':
        rospy.init_node('event_loops_outside')
        said = rospy.Publisher('~ticks', String, queue_size=10)
        rospy.Subscriber('~ticks', String, lambda text: None)
        rospy.Timer(rospy.Duration(0.1), lambda event: said.publish('tick'))
    asyncio.run({'child': child, 'pipe': pipe, 'server': server, 'signal': handled, 'early': early,
                 'forever': forever}[role]())


assert sys.argv
main()
