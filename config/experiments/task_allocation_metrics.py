"""The metrics of the task allocation experiment: what its coordinator says of each task."""


def response(trial):
    """Return the mean and the worst response time of a trial's tasks [s]."""
    times = [message['data'] for _time_ns, _topic, message in trial.messages('/response_time')]
    return {'response_mean': sum(times) / len(times) if times else None, 'response_worst': max(times, default=None)}
