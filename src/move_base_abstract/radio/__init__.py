"""The radio between hosts, from its description in a file."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .network import read_network as read_network, resolve as resolve
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
