#!/usr/bin/env python3
"""Offers tasks to robots by radio, one auction after the other for each, until somebody says that the task is done.

It announces a task, takes bids for a second, awards the task to the least one, and waits for the winner's word.
Whatever gets lost on the way is offered again; after some auctions it gives up. Any of it may come twice, or late.

On /outcome: [tasks done, auctions, mean time from the first announcement to the word that it is done [s]].
"""
import json
import random

import rospy
from std_msgs.msg import Float64MultiArray, String

BIDDING = 1.0  # s
MOST_AUCTIONS = 12  # of a task


class Auctioneer:
    """Gives one task after the other."""

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
        """Keep a bid for the auction that is open; a late one counts for nothing."""
        number, auction, robot, cost = json.loads(message.data)
        self.bids.setdefault((number, auction), []).append((cost, robot))

    def on_taken(self, message):
        """Remember that a robot has taken a task."""
        number, _robot = json.loads(message.data)
        self.taken[number] = rospy.get_time()

    def on_done(self, message):
        """Remember the first word that a task is done."""
        number, _robot = json.loads(message.data)
        self.done.setdefault(number, rospy.get_time())

    def offer(self, number):
        """Hold one auction of a task; return whether somebody has taken it."""
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
        """Offer all tasks, then those again that nobody has taken; wait until those taken are done, as far as known."""
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
