"""Robots that come near each other on their ways: when and how they do, and what it costs them."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .control import Encounters as Encounters
    from .nearness import closest as closest, first_beyond as first_beyond, first_within as first_within
    from .track import Track as Track
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
