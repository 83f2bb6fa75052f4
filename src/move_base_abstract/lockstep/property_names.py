"""What properties of a run are called: those that are built in, and the kinds of statements of nodes."""

#: property: what holds in every good run
BUILT_IN = {
    'no_crash': 'no node crashes',
    'no_exception': 'no exception is left that nobody catches',
    'no_standstill': 'nobody waits for ever',
    'no_zero_delay_loop': 'time goes on',
    'every_goal_ends': 'no goal is open when nothing is left that could happen',
    'capacities_kept': 'no zone, lane or place holds more robots than it has room for',
    'charged': 'no robot stands with an empty battery away from a charger'}
ALWAYS, SOMETIMES, NEVER_AGAIN = 'always', 'sometimes', 'never_again'
ALL = 'all'
NAMES = (ALL, *BUILT_IN, ALWAYS, NEVER_AGAIN)  # that may be asked for
