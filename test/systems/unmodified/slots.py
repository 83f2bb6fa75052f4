"""A module of a program, whose objects are hashed by their address."""


class Slot:
    __slots__ = ('number',)

    def __init__(self, number):
        self.number = number

    def go(self):
        return self.number
