"""The participants of a run, as far as the time master has told this process."""
from move_base_abstract.lockstep import wire


class Members:
    """The participants: ``names`` {number: name}, with this process's own name also at 0, and ``uris`` {name: URI}."""

    def __init__(self):
        self.names = {}
        self.uris = {}
        self.gone = set()  # names of participants that have left

    @property
    def own_name(self):
        """The name of this process's node."""
        return self.names[0]

    @property
    def there(self):
        """The names of all present participants."""
        return set(self.names.values()) - self.gone

    def is_member(self, name):
        """Return whether the node ``name`` takes part, or has taken part."""
        return name in self.uris

    def came(self, body):
        """Note the new participant in the ``body`` of a MEMBER frame; return its name."""
        number, name, uri = wire.read_frame(wire.MEMBER, body)
        self.names[number] = name
        self.uris[name] = uri
        self.gone.discard(name)
        return name

    def left(self, body):
        """Note that the participant in the ``body`` of a GONE frame has left.

        Its connections are closed by items of a grant. Its name and URI are kept: its process ends at some moment of
        the wall clock, and until then must not be taken for a node that never took part.
        """
        number, = wire.read_frame(wire.GONE, body)
        self.gone.add(self.names.get(number, ''))
