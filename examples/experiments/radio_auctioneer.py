#!/usr/bin/env python3
"""Offers tasks to robots by radio: for each task it holds one auction after the other until a robot has taken it.

It announces a task, takes bids for one second, awards the task to the lowest bid, and waits one second for the winner's
answer. If a message is lost, it offers the task again, up to MOST_AUCTIONS times. Messages may also come twice or late.

It publishes on /outcome: [tasks done, auctions, mean time from a task's first announcement to the report that it is
done [s]]. The mean is -1 if no task is done.
"""
import json
import random

import rospy
from std_msgs.msg import Float64MultiArray, String

BIDDING = 1.0  # s
MOST_AUCTIONS = 12  # for one task


class Auctioneer:
    """Offers the tasks one after the other."""

    def __init__(self):
        chance = random.Random(rospy.get_param('~seed', 0))
        size = rospy.get_param('~size', 40.0)
        count = rospy.get_param('~tasks', 9)
        self.tasks = [(chance.uniform(0.0, size), chance.uniform(0.0, size)) for _ in range(count)]
        self.bids, self.taken, self.done = {}, {}, {}
        self.auctions, self.begun = 0, {}
        self.announce = rospy.Publisher('/auction/task', String, queue_size=100)
        self.award = rospy.Publisher('/auction/award', String, queue_size=100)
        self.outcome = rospy.Publisher('/outcome', Float64MultiArray, queue_size=1, latch=True)
        rospy.Subscriber('/auction/bid', String, self.on_bid)
        rospy.Subscriber('/auction/taken', String, self.on_taken)
        rospy.Subscriber('/auction/done', String, self.on_done)

    def on_bid(self, message):
        """Keep a bid under its task and auction; a bid that comes after its auction is never read."""
        number, auction, robot, cost = json.loads(message.data)
        self.bids.setdefault((number, auction), []).append((cost, robot))

    def on_taken(self, message):
        """Remember that a robot has taken a task."""
        number, _robot = json.loads(message.data)
        self.taken[number] = rospy.get_time()

    def on_done(self, message):
        """Remember the time of the first report that a task is done."""
        number, _robot = json.loads(message.data)
        self.done.setdefault(number, rospy.get_time())

    def offer(self, number):
        """Hold one auction for a task; return whether a robot has taken the task."""
        x, y = self.tasks[number]
        self.auctions += 1
        auction = self.auctions
        self.announce.publish(json.dumps([number, auction, x, y]))
        rospy.sleep(BIDDING)
        bids = self.bids.get((number, auction))
        if bids:
            self.award.publish(json.dumps([number, min(bids)[1], x, y]))
            rospy.sleep(BIDDING)
        return number in self.taken or number in self.done

    def run(self):
        """Offer each task until a robot takes it, wait up to 300 s for the taken tasks, publish the outcome."""
        rospy.sleep(1.0)
        for number in range(len(self.tasks)):
            self.begun[number] = rospy.get_time()
            for _ in range(MOST_AUCTIONS):
                if self.offer(number):
                    break
        waits_until = rospy.get_time() + 300.0
        while set(self.taken) - set(self.done) and rospy.get_time() < waits_until:
            rospy.sleep(1.0)
        times = [self.done[number] - self.begun[number] for number in sorted(self.done)]
        self.outcome.publish(Float64MultiArray(data=[
            len(times), self.auctions, sum(times) / len(times) if times else -1.0]))
        rospy.sleep(1.0)


if __name__ == '__main__':
    rospy.init_node('auctioneer')
    Auctioneer().run()
