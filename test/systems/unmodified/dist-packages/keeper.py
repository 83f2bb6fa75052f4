"""A library that keeps sets of its own objects and of the program's."""


class Entry:
    """What is kept of a member."""

    def __init__(self, of):
        self.of = of


class Keeper:
    """Keeps members."""

    class Place:
        """The place of a member."""

    def __init__(self):
        self.entries, self.members, self.places = set(), set(), {}

    def add(self, one):
        """Keep a member."""
        self.entries.add(Entry(one))
        self.members.add(one)
        self.places[Keeper.Place()] = one

    def orders(self):
        """Return what depends on hashes."""
        return ([entry.of.number for entry in self.entries], [one.number for one in self.members],
                [hash(place) % 7 for place in self.places], [str(place) for place in self.places])


def names(members):
    """Return the names of members of a set, or of what their methods belong to, in the order of the set."""
    members = [getattr(one, '__self__', one) for one in members]
    return [getattr(one, 'name', None) or one.action_client.ns for one in members]
