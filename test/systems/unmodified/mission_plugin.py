"""A plugin of mission_texts.py, which loads it from this file."""


def wait_for(heard):
    while not heard:
        pass
