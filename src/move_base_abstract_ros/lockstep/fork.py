"""A process that a participant forks (multiprocessing, os.fork) takes no part, and must not speak for its parent."""
import os


def install(participant):
    """Have a child let go of the connection; its parent's goes on."""
    def let_go():
        participant.scheduler.abandon()
        participant.connection.forget()

    os.register_at_fork(after_in_child=let_go)
