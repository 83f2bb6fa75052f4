"""Robots that come near each other on their ways: when and how they do, and what it costs them."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'control': 'Encounters', 'nearness': 'closest first_beyond first_within', 'track': 'Track'})
