"""A debugger in a participant's process: breakpoints and pdb, on behalf of the program `debug`."""

#: the environment variable that names the socket of `debug`
VARIABLE = 'MOVE_BASE_ABSTRACT_DEBUG'
