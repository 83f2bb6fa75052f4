"""The wire format of lockstep: the table from which both sides are made. This module has data only.

docs/lockstep_protocol.md explains the format. Python's :mod:`.wire` reads this table when it is imported. For C++, the
build makes a header from it (``src/lockstep/wire/make_wire_format.py``), with a structure for each frame and item. The
numbers of the frames of one direction, of the items, and of the values of a choice have no gaps.

A field is ``'TYPE name'`` or ``'TYPE name = DEFAULT'``. The types are ``u32``, ``u64``, ``i32``; ``flag``, a byte that
is 0 or 1; ``instant``, an i64 [ns] that is not negative, with NEVER for never; ``text``, a u32 length and as many bytes
of UTF-8; ``bytes``, the same with any bytes; ``texts``, a u32 number and as many texts; the name of a choice, a byte;
``ReportItem`` and ``GrantItem``, items up to the end of the frame.
"""
from collections import namedtuple

#: one frame or item: its number on the wire, its name, its fields in their order
Layout = namedtuple('Layout', 'number name fields')

PROTOCOL = 12
NEVER = 2 ** 63 - 1
#: added to the index of a robot: the motion of its odometry, instead of its own
ODOMETRY = 2 ** 31
#: the largest frame, without its length field [bytes]; a longer one is refused before it is stored
LARGEST_FRAME = 256 * 1024 * 1024
#: the same for HELLO, before which any program may be at the other end
LARGEST_HELLO = 4096

# Before WELCOME, a participant waits for the time master as long as ROS runs.
CONNECT_RETRY_MS = 50  # wall
CONNECT_REMINDER_MS = 10000  # wall; the interval of its messages that it waits

#: the choices, each a byte: {name of the choice: ((number, name of the value), ...)}
CHOICES = {
    'NoteKind': ((1, 'WAITS_FOR'), (2, 'NOT_REPEATABLE'), (3, 'DEGRADED'), (4, 'STRICT'), (5, 'TELLS'),
                 (6, 'READS'), (7, 'WRITES')),
    # Which messages have any effect on a subscriber: none (NOTHING); those that say something new (NEWS); all (ALL);
    # all, but not before it does something anyway, because it only stores them (LATER); all, but it looks at them only
    # at its own wake-ups (UNREAD).
    'Delivery': ((0, 'NOTHING'), (1, 'NEWS'), (2, 'ALL'), (3, 'LATER'), (4, 'UNREAD')),
    # What differs in the later messages of PLAY: its number (u32), its stamp (two u32), the x, y and heading of a
    # geometry_msgs/Pose, the speeds of a geometry_msgs/Twist; the last two of the robot's odometry.
    'Slot': ((0, 'NUMBER'), (1, 'STAMP'), (2, 'POSE'), (3, 'TWIST'), (4, 'ODOM_POSE'), (5, 'ODOM_TWIST')),
    # ERROR: the bytes are the server's text. OK: they are the response. NO_SERVER: no member has this service.
    # SERVER_GONE: the server left, died or stopped serving before it answered.
    'CallStatus': ((0, 'ERROR'), (1, 'OK'), (2, 'NO_SERVER'), (3, 'SERVER_GONE')),
}

PARTICIPANT_FRAMES = (
    Layout(1, 'HELLO', ('u32 protocol = PROTOCOL', 'text name', 'text node_uri', 'i32 rank', 'flag rank_declared',
                        'u64 incarnation',
                        'bytes secret')),  # the secret of the run; empty: none
    Layout(2, 'REPORT', ('u64 round',
                         'flag leaving',  # whether this report is the last
                         'instant next_ns = NEVER',  # simulated; not after the present: once more at this instant
                         'u32 open',  # the number of application threads that wait without end
                         'ReportItem items')),  # in the order in which they were done
    Layout(3, 'KNOCK', ()),
    Layout(4, 'LEAVE', ('text reason',)),
    Layout(5, 'STOPPING', ('text reason',)),  # it was told to end, at some moment of the wall clock, and will leave
    # The work on a grant takes long. where: what the thread that has the turn is doing, the innermost function last.
    Layout(6, 'BUSY', ('u64 round', 'text where')),
    Layout(7, 'CRASHING', ()),  # it ends now, by its own doing, and says no more
    # Somebody looks at it in a debugger from now on, or no more: its work on a grant has no limits meanwhile.
    Layout(8, 'LOOKED', ('flag is_looked_at',)),
)

MASTER_FRAMES = (
    Layout(16, 'WELCOME', ('u32 own_id',
                           'i32 rank',  # the declared one, or that of all participants that declare none
                           'instant leave_limit_ns',  # wall; how long it waits, at its end, until all is taken
                           'instant busy_limit_ns',  # wall; if it works longer on a grant, it sends BUSY; NEVER: never
                           'texts excluded_topics',  # topics that do not go through the time master
                           'flag radio')),  # whether there is a radio between hosts, so that MOTION is sent
    Layout(17, 'MEMBER', ('u32 id', 'text name', 'text node_uri')),
    Layout(18, 'GONE', ('u32 id',)),
    Layout(19, 'GRANT', ('u64 round',
                         'instant time_ns',  # simulated
                         'u32 microstep',
                         'GrantItem items')),  # in the order in which they are to be handled
    Layout(20, 'END', ('text reason',
                       'flag as_wished')),  # the run is over as its settings say; otherwise the participant has lost it
)

#: the items of a report; `topic` and `service` are the participant's own numbers, one for each name; `sub` is the index
#: of the robot within a fleet (0 for other nodes)
REPORT_ITEMS = (
    Layout(1, 'ADVERTISE', ('u32 topic', 'u32 sub', 'text name', 'text type', 'text md5', 'flag latched',
                            'text definition')),
    Layout(2, 'UNADVERTISE', ('u32 topic',)),
    Layout(3, 'SUBSCRIBE', ('u32 topic', 'u32 sub', 'text name',
                            'text md5')),  # '*' takes any type
    Layout(4, 'UNSUBSCRIBE', ('u32 topic',)),
    Layout(5, 'SEND', ('u32 topic', 'u32 sub',
                       'u32 target',  # id of the only receiver, or 0: all members that subscribe
                       'bytes payload')),
    Layout(6, 'SERVE', ('u32 service', 'u32 sub', 'text name')),
    Layout(7, 'UNSERVE', ('u32 service',)),
    Layout(8, 'CALL', ('u32 number',  # the caller's own, counts up
                       'u32 sub',
                       'text service',  # its name
                       'bytes request')),
    Layout(9, 'RESPONSE', ('u32 caller',  # its id
                           'u32 number',  # the caller's
                           'flag ok',
                           'bytes bytes')),  # the response, or the text of the error
    Layout(10, 'LOG', ('u32 sub', 'text robot', 'text kind',
                       'text values')),  # a JSON array
    Layout(11, 'NOTE', ('NoteKind what', 'text text')),
    Layout(12, 'WATCH', ('text service',)),  # its name
    Layout(13, 'AT', ('instant time_ns',)),  # simulated, in a window; the turn to which the items that follow belong
    Layout(14, 'REST', ()),  # asks for another grant, once, when no participant has anything left to do at this instant
    Layout(15, 'CHOOSE_DELIVERY', ('u32 topic',  # a topic to which it subscribes
                         'Delivery what')),
    Layout(16, 'BACKGROUND', ()),  # the wake-up is only for nodes that take no part: time does not go on for it alone
    Layout(17, 'PARAMETER', ('text name',  # a resolved name of ROS; it is set or deleted at the end of the round
                             'flag is_set',
                             'text value')),  # as in XML-RPC, <value>...</value>; empty if it is deleted
    Layout(18, 'ASKS', ('text name',)),  # the participant has asked for this parameter, or for one below it
    Layout(19, 'IDLE', ('u32 count',)),  # the number of its threads that wait without end for work that may come
    Layout(20, 'KEEP_UNTIL', ('instant time_ns',)),  # simulated; from then on unread messages are a reason for a grant
    Layout(21, 'MOTION', ('u32 sub',  # with ODOMETRY added: of the robot's odometry, and without a name
                          'text robot',  # its name
                          'bytes pieces')),  # how it moves from now on
    # Messages that the time master makes and sends in the participant's place, until its next turn.
    Layout(22, 'PLAY', ('u32 topic', 'u32 sub', 'u32 target',  # as in SEND
                        'flag once',  # not if one of its topic and sub has been played at the same instant
                        'u32 number',  # of the first message; it is counted on
                        'instant first_ns', 'instant period_ns',  # simulated
                        'bytes payload',  # of the first message
                        'bytes slots')),  # what differs in the others: a byte, its kind, and a u32, its place, each
)

#: the items of a grant; `topic` and `service` are the numbers of the participant that gets the grant
GRANT_ITEMS = (
    Layout(1, 'PUBLISHER', ('u32 topic',
                            'u32 sender',  # its id
                            'text type', 'text md5', 'flag latched', 'text definition')),
    Layout(2, 'NO_PUBLISHER', ('u32 topic', 'u32 sender')),
    Layout(3, 'SUBSCRIBER', ('u32 topic',
                             'u32 receiver')),  # its id
    Layout(4, 'NO_SUBSCRIBER', ('u32 topic', 'u32 receiver')),
    Layout(5, 'DELIVER', ('u32 topic', 'u32 sender', 'bytes payload')),
    Layout(6, 'CALL_IN', ('u32 service',
                          'u32 caller',  # its id
                          'u32 number',  # the caller's
                          'bytes request')),
    Layout(7, 'ANSWER', ('u32 number', 'CallStatus status', 'bytes bytes')),
    Layout(8, 'FOUND', ('text service',)),  # its name
    Layout(9, 'HAPPENED', ('instant until_ns',)),  # what the latest report had played was, up to and including it
    Layout(10, 'DELIVERY_CHOSEN', ('u32 topic',
                         'u32 receiver',  # its id
                         'Delivery what')),
    Layout(11, 'WINDOW', ('instant end_ns',  # simulated; up to it this participant goes on by itself
                          'instant lookahead_ns')),  # simulated; the time that each message takes
    Layout(12, 'ARRIVES', ('instant time_ns',)),  # simulated, in the window; the items that follow arrive then
    Layout(13, 'CAME', ('instant time_ns',)),  # simulated; the items that follow came then, and were unread
    Layout(14, 'CHANGED', ()),  # a parameter for which it has asked was set or deleted since its latest grant
)
