"""Who takes part in a run, as far as this process has been told."""
from move_base_abstract.lockstep import wire


class Members:
    """``names``: of each by its number, this process's own one by 0, too; ``uris``: where each is, by its name."""

    def __init__(self):
        self.names = {}
        self.uris = {}
        self.gone = set()  # names of those that took part

    @property
    def own_name(self):
        """The name of this process's node."""
        return self.names[0]

    @property
    def there(self):
        """The names of all that take part."""
        return set(self.names.values()) - self.gone

    def is_member(self, name):
        """Return whether the node ``name`` takes part."""
        return name in self.uris

    def came(self, body):
        """Take in the ``body`` of a MEMBER; return the name."""
        number, name, uri = wire.read_frame(wire.MEMBER, body)
        self.names[number] = name
        self.uris[name] = uri
        self.gone.discard(name)
        return name

    def left(self, body):
        """Take in the ``body`` of a GONE.

        What there is to do comes in a grant. Until its process has ended, at some moment of the wall clock, it is
        still to be told from nodes that do not take part.
        """
        number, = wire.read_frame(wire.GONE, body)
        self.gone.add(self.names.get(number, ''))
