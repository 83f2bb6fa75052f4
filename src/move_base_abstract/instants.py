"""The instant at which something that never takes itself back comes to be, to the nanosecond."""


def first_ns(begin_ns, end_ns, is_so):
    """Return the first instant [ns] in ``begin_ns`` .. ``end_ns`` [ns] at which ``is_so(instant)`` is true.

    It must stay true from there on, and be true at ``end_ns``, which is not asked. By bisection: at most 62 calls.
    """
    while begin_ns < end_ns:
        middle_ns = (begin_ns + end_ns) // 2
        if is_so(middle_ns):
            end_ns = middle_ns
        else:
            begin_ns = middle_ns + 1
    return end_ns
