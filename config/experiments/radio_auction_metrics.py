"""The metrics of the radio auction, from the message that its auctioneer publishes at the end."""


def outcome(trial):
    """Return the numbers of done tasks and of auctions, and the mean time of a task [s]; None if it is not known."""
    for _time_ns, _topic, message in trial.messages('/outcome'):
        done, auctions, seconds = message['data']
        return {'tasks_done': done, 'auctions': auctions, 'task_time': seconds if done else None}
    return {'tasks_done': None, 'auctions': None, 'task_time': None}
