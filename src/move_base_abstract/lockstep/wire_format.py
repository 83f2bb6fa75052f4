"""The wire format of lockstep: the one table of which both sides are made. Data only.

docs/lockstep_protocol.md explains it. Python's :mod:`.wire` reads it when it is imported. For C++ the build makes a
header of it (``src/lockstep/wire/make_wire_format.py``), with a structure for each frame and item. Numbers of
the frames of one direction, of items and of the values of a choice follow on each other.

A field is ``'TYPE name'`` or ``'TYPE name = DEFAULT'``. Types: ``u32``, ``u64``, ``i32``; ``flag``, a byte that is 0
or 1; ``instant``, an i64 [ns] that is not negative, NEVER = never; ``text``, a u32 length and as many bytes of UTF-8;
``bytes``, the same of any bytes; ``texts``, a u32 number and as many texts; the name of a choice, a byte;
``ReportItem`` and ``GrantItem``, items to the end of the frame.
"""
from collections import namedtuple

#: one frame or item: its number on the wire, its name, its fields in their order
Layout = namedtuple('Layout', 'number name fields')

PROTOCOL = 8
NEVER = 2 ** 63 - 1
#: of a frame without its length field [bytes]; what is longer is refused before it is stored
LARGEST_FRAME = 256 * 1024 * 1024
#: the same before HELLO, when anybody may be at the other end
LARGEST_HELLO = 4096

# Before WELCOME says anything: a participant waits for the time master as long as ROS is there.
CONNECT_RETRY_MS = 50  # wall
CONNECT_REMINDER_MS = 10000  # wall; it says so that often

#: what a byte may say: name of the choice, (number, name) of its values
CHOICES = {
    'NoteKind': ((1, 'WAITS_FOR'), (2, 'NOT_REPEATABLE'), (3, 'DEGRADED'), (4, 'STRICT'), (5, 'TELLS'),
                 (6, 'READS'), (7, 'WRITES')),
    # what has any effect on a subscriber: no message, one that says something new, all; all, but not before it does
    # something anyway (LATER): it only puts them by; all, but it looks at them at its own wake-ups only (UNREAD)
    'Hearing': ((0, 'NOTHING'), (1, 'NEWS'), (2, 'ALL'), (3, 'LATER'), (4, 'UNREAD')),
    # ERROR: the bytes are the server's text. OK: the response. NO_SERVER: no member serves it.
    # SERVER_GONE: it left, died or stopped serving before it answered.
    'CallStatus': ((0, 'ERROR'), (1, 'OK'), (2, 'NO_SERVER'), (3, 'SERVER_GONE')),
}

PARTICIPANT_FRAMES = (
    Layout(1, 'HELLO', ('u32 protocol = PROTOCOL', 'text name', 'text node_uri', 'i32 rank', 'flag rank_declared',
                        'u64 incarnation',
                        'bytes secret')),  # of the run; empty: none
    Layout(2, 'REPORT', ('u64 round',
                         'flag leaving',  # this report is the last
                         'instant next_ns = NEVER',  # simulated; not after the present: once more at this instant
                         'u32 open',  # application threads that wait without end
                         'ReportItem items')),  # in the order in which they were done
    Layout(3, 'KNOCK', ()),
    Layout(4, 'LEAVE', ('text reason',)),
    Layout(5, 'STOPPING', ('text reason',)),  # it is told to end, at some moment of the wall clock, and about to leave
    # Its work on a grant takes long: what the thread that has the turn is doing, the innermost function last.
    Layout(6, 'BUSY', ('u64 round', 'text where')),
)

MASTER_FRAMES = (
    Layout(16, 'WELCOME', ('u32 own_id',
                           'i32 rank',  # the one declared, or that of all who declare none
                           'instant leave_limit_ns',  # wall; for how long, at its end, it waits until all is taken
                           'instant busy_limit_ns',  # wall; who works longer on a grant says where; NEVER: nobody
                           'texts excluded_topics',  # that do not go through the time master
                           'flag radio')),  # there is one between hosts: it asks for MOTION
    Layout(17, 'MEMBER', ('u32 id', 'text name', 'text node_uri')),
    Layout(18, 'GONE', ('u32 id',)),
    Layout(19, 'GRANT', ('u64 round',
                         'instant time_ns',  # simulated
                         'u32 microstep',
                         'GrantItem items')),  # in the order in which they are to be handled
    Layout(20, 'END', ('text reason',
                       'flag as_wished')),  # the run is over, as its settings say; else the participant has lost it
)

#: what a report contains; `topic` and `service` are the participant's own numbers, one for each name, `sub` is the
#: index of the robot within a fleet (0 for others)
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
    Layout(13, 'AT', ('instant time_ns',)),  # simulated; of the turn in which what follows is sent, or done
    Layout(14, 'REST', ()),  # grant me again, once, when nobody has anything left to do at this instant
    Layout(15, 'HEARS', ('u32 topic',  # that it subscribes to
                         'Hearing what')),
    Layout(16, 'BACKGROUND', ()),  # my wake-up is for those only who take no part: time does not go on for it alone
    Layout(17, 'PARAMETER', ('text name',  # of ROS, resolved; set, or deleted, when the round is over
                             'flag is_set',
                             'text value')),  # as XML-RPC says it, <value>...</value>; empty where it is deleted
    Layout(18, 'ASKS', ('text name',)),  # I have asked for this parameter, or for what is below it
    Layout(19, 'IDLE', ('u32 count',)),  # so many of my threads wait without end for work that may come
    Layout(20, 'KEEP_UNTIL', ('instant time_ns',)),  # simulated; from then on what is unread is a reason for a grant
    Layout(21, 'MOTION', ('u32 sub', 'text robot',  # its name; only where WELCOME says that there is a radio
                          'bytes pieces')),  # how it moves from now on
)

#: what a grant contains; `topic` and `service` are the numbers of the participant that gets the grant
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
    Layout(9, 'HAPPENED', ('u32 count',)),  # so many of the turns that the latest report told beforehand
    Layout(10, 'HEARD', ('u32 topic',
                         'u32 receiver',  # its id
                         'Hearing what')),
    Layout(11, 'WINDOW', ('instant end_ns',  # simulated; what comes before it is this participant's own affair
                          'instant lookahead_ns')),  # simulated; what is sent takes so long
    Layout(12, 'ARRIVES', ('instant time_ns',)),  # simulated, in the window; what follows arrives then
    Layout(13, 'CAME', ('instant time_ns',)),  # simulated; what follows came then, and was unread
    Layout(14, 'CHANGED', ()),  # a parameter that it asks for has been set or deleted since its latest grant
)
