"""The radio between hosts, from its description in a file, and robots' motions in the form for the time master."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .motion_pieces import pieces_of as pieces_of
    from .network import read_network as read_network, resolve as resolve
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
