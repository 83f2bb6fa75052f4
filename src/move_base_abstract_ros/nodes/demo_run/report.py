"""The output of the demo: a progress bar (plain lines if the output is not a terminal), a table and a closing line."""

import time

from tqdm import tqdm

PLAIN_PERIOD = 2.0  # s, wall, between two plain progress lines
COLUMNS = ('robot', 'goals', 'distance [m]', 'moving [s]', 'idle [s]')


class BarProgress:
    """A progress bar on a terminal."""

    def __init__(self, count, what, stream):
        self._bar = tqdm(total=count, file=stream, unit=what, dynamic_ncols=True,
                         bar_format='{l_bar}{bar}| {n_fmt}/{total_fmt} ' + what + '{postfix}')

    def show(self, done, simulated_s, wall_s):
        """Show the present state."""
        self._bar.set_postfix_str(f'{simulated_s:.1f} s simulated, {speed_up(simulated_s, wall_s):.1f}x', refresh=False)
        self._bar.n = done
        self._bar.refresh()

    def close(self):
        """Leave the bar as it is and end its line."""
        self._bar.close()


class PlainProgress:
    """A line every PLAIN_PERIOD seconds of wall time, without control characters, for logs and pipes."""

    def __init__(self, count, what, stream):
        self._count = count
        self._what = what
        self._stream = stream
        self._next = 0.0

    def show(self, done, simulated_s, wall_s):
        """Print the present state if a line is due, or if all is done."""
        now = time.monotonic()
        if now < self._next and done < self._count:
            return
        self._next = now + PLAIN_PERIOD
        print(f'{done}/{self._count} {self._what}, {simulated_s:.1f} s simulated, '
              f'{speed_up(simulated_s, wall_s):.1f}x', file=self._stream, flush=True)

    def close(self):
        """Do nothing: nothing is left open."""


def make_progress(count, what, stream):
    """Return the progress display for ``count`` things that fits the stream. ``what``: their name, such as 'goals'."""
    return (BarProgress if stream.isatty() else PlainProgress)(count, what, stream)


def speed_up(simulated_s, wall_s):
    """Return simulated seconds per wall second; 0 if no wall time has passed."""
    return simulated_s / wall_s if wall_s > 0.0 else 0.0


def table(robots, mission_s):
    """Return the text table of ``robots``, [(name, goals done, goals, distance [m], moving [s])].

    ``mission_s``: the time from the mission's first goal to its last result [s]. A robot is idle while it does not move
    in this time. All times are simulated.
    """
    rows = [(name, f'{done}/{goals}', f'{distance_m:.1f}', f'{moving_s:.2f}', f'{max(0.0, mission_s - moving_s):.2f}')
            for name, done, goals, distance_m, moving_s in robots]
    return aligned(COLUMNS, rows)


def aligned(columns, rows):
    """Return a text table of ``rows`` of texts with the headings ``columns``. Only the first column is aligned left."""
    widths = [max(len(row[i]) for row in [columns, *rows]) for i in range(len(columns))]
    lines = [columns, tuple('-' * width for width in widths), *rows]
    return '\n'.join('  '.join([line[0].ljust(widths[0])] + [cell.rjust(width) for cell, width
                                                             in zip(line[1:], widths[1:])]) for line in lines)


def closing_line(simulated_s, wall_s, messages):
    """Return the demo's last line. ``messages``: how many were delivered, or None: unknown."""
    density = '' if messages is None else f', with {messages / simulated_s:.1f} messages per simulated second'
    return (f'{simulated_s:.2f} s simulated in {wall_s:.2f} s of wall time: '
            f'{speed_up(simulated_s, wall_s):.1f}x real time{density}')
