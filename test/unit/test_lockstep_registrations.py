"""What participants are shown of the ROS master's books: one order, and nobody who is there by chance."""
from move_base_abstract.lockstep.registrations import Registrations

STATE = [
    [['/z', ['/two', '/one']], ['/rosout', ['/looker', '/one', '/left', '/map_server']], ['/map', ['/map_server']],
     ['/of_left', ['/left']], ['/clock', ['/time_master']]],
    [['/z', ['/looker', '/one']], ['/only_looked_at', ['/looker']], ['/rosout', ['/rosout']]],
    [['/looker/get_loggers', ['/looker']], ['/one/get_loggers', ['/one']], ['/serve', ['/left']]],
]


def there():
    return Registrations(STATE, ['/one', '/two'], ['/left'])


def test_names_come_in_one_order_without_those_who_have_left_or_only_look_on():
    assert there().state() == [
        [['/clock', ['/time_master']], ['/map', ['/map_server']], ['/rosout', ['/map_server', '/one']],
         ['/z', ['/one', '/two']]],
        [['/rosout', ['/rosout']], ['/z', ['/one']]],
        [['/one/get_loggers', ['/one']]],
    ]


def test_only_topics_of_those_who_are_shown_are_named():
    pairs = [['/z', 't'], ['/only_looked_at', 't'], ['/of_left', 't'], ['/map', 't']]
    assert there().published(pairs) == [['/map', 't'], ['/z', 't']]
    assert there().topics(pairs) == [['/map', 't'], ['/z', 't']]


def test_who_takes_no_part_and_is_shown_is_told():
    assert there().strangers() == ['/map_server']
    assert there().strangers({'/z'}) == []
    assert there().strangers({'/rosout', '/map'}) == ['/map_server']


def test_who_comes_back_is_there():
    back = Registrations(STATE, ['/one', '/two', '/left'], ['/left'])
    assert ['/of_left', ['/left']] in back.state()[0]
    assert not back.only_gone_serve('/serve')
    assert there().only_gone_serve('/serve') and not there().only_gone_serve('/nobodys')
