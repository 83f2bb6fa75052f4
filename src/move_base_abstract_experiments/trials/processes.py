"""Processes of a run, for who runs experiments: see `launching.processes`."""
from move_base_abstract_ros.launching.processes import (
    adopt_orphans,
    await_ends,
    block_child_signal,
    code_of,
    end,
    end_all_children,
    finish,
    fork,
    importing,
    keep_memory,
)

__all__ = ['adopt_orphans', 'await_ends', 'block_child_signal', 'code_of', 'end', 'end_all_children', 'finish', 'fork',
           'importing', 'keep_memory']
