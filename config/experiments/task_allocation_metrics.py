"""The metrics of the task allocation experiment, from the response times that its coordinator publishes."""


def response(trial):
    """Return the mean and the worst response time of a trial's tasks [s]; None if there are none."""
    times = [message['data'] for _time_ns, _topic, message in trial.messages('/response_time')]
    return {'response_mean': sum(times) / len(times) if times else None, 'response_worst': max(times, default=None)}
