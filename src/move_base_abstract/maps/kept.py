"""Keeps what was found last, up to a size: a way of a hundred thousand corners counts as much as a thousand others."""
from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Any, Callable, Generic, Tuple, TypeVar

if TYPE_CHECKING:
    from typing import OrderedDict as Ordered

Found = TypeVar('Found')
#: the most corners of ways that one planner keeps, about 20 MB; a way counts as :data:`LEAST` corners at least
MOST_CORNERS = 50_000
LEAST = 8
_NONE = object()


class Kept(Generic[Found]):
    """What ``find(*key)`` returned for the latest keys, of ``most`` in all; ``size(found)``: what a result counts.

    What was asked for least recently goes first.
    """

    def __init__(self, find: Callable[..., Found], size: Callable[[Found], int], most: int = MOST_CORNERS) -> None:
        self._find, self._size_of, self._most = find, size, most
        self._found: Ordered[Tuple[Any, ...], Any] = OrderedDict()
        #: how much all that is kept counts
        self.size = 0

    def __len__(self) -> int:
        return len(self._found)

    def __call__(self, *key: Any) -> Found:
        """Return ``find(*key)``, as it was found before if it is still kept."""
        found: Any = self._found.get(key, _NONE)
        if found is not _NONE:
            self._found.move_to_end(key)
            return found  # type: ignore[no-any-return]
        found = self._found[key] = self._find(*key)
        self.size += max(LEAST, self._size_of(found))
        while self.size > self._most and len(self._found) > 1:
            self.size -= max(LEAST, self._size_of(self._found.popitem(last=False)[1]))
        return found  # type: ignore[no-any-return]


def corners_of(way: Any) -> int:
    """Return the number of corners of a way, 0 if there is none."""
    return 0 if way is None else len(way)
