"""The metrics of the auction by radio: what its auctioneer says at the end."""


def outcome(trial):
    """Return how many tasks are done, how many auctions that took, and how long a task took [s]."""
    for _time_ns, _topic, message in trial.messages('/outcome'):
        done, auctions, seconds = message['data']
        return {'tasks_done': done, 'auctions': auctions, 'task_time': seconds if done else None}
    return {'tasks_done': None, 'auctions': None, 'task_time': None}
