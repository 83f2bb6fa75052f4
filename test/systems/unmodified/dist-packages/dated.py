"""A library that asks for the present."""
from datetime import datetime


def present():
    return str(datetime.now())
