"""Telling whether another simulator goes by the same clock: the stamps of what it says against the present."""
from .units import NS_PER_S


class StampCheck:
    """Compares stamps with the present, within ``tolerance`` [s, simulated].

    Only stamps that are off for ``patience`` [s, wall] count as a lapse. Wall times are arguments [s, of one clock
    that never goes back].
    """

    def __init__(self, tolerance=1.0, patience=2.0):
        self._tolerance = tolerance
        self._patience = patience
        self._off_since = None
        self._told = False

    @property
    def is_alike(self):
        """Whether the latest stamp was of the present."""
        return self._off_since is None

    def reported(self, stamp_ns, now_ns, wall):
        """Take a stamp in; return by how much it lies in the past [s], once for each lapse, else None."""
        gap = (now_ns - stamp_ns) / NS_PER_S
        if abs(gap) <= self._tolerance:
            self._off_since, self._told = None, False
            return None
        if self._off_since is None:
            self._off_since = wall
        if self._told or wall - self._off_since < self._patience:
            return None
        self._told = True
        return gap
