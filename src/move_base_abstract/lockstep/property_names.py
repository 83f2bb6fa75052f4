"""The names of the properties of a run: the built-in ones, and the kinds of statements of nodes."""

#: {property: the sentence that holds in every good run}
BUILT_IN = {
    'no_crash': 'no node crashes',
    'no_exception': 'every exception is caught',
    'no_standstill': 'no node and no robot waits for ever',
    'no_zero_delay_loop': 'simulated time goes on',
    'every_goal_ends': 'no goal is open when nothing is left that could happen',
    'capacities_kept': 'no zone, lane or place holds more robots than it has room for',
    'charged': 'no robot stands with an empty battery away from a charger'}
ALWAYS, SOMETIMES, NEVER_AGAIN = 'always', 'sometimes', 'never_again'
ALL = 'all'
NAMES = (ALL, *BUILT_IN, ALWAYS, NEVER_AGAIN)  # the names that may be asked for
