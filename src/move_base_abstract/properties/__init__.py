"""Properties of a run: statements of nodes, properties of every good run, and which of them a run has broken.

For nodes: ``from move_base_abstract.properties import always, never_again, sometimes``.
"""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..runs.built_in import Broken as Broken
    from .gathering import Gathering as Gathering
    from .judgement import (
        Judgement as Judgement,
        Run as Run,
        judge as judge,
        judge_log as judge_log,
        judgement_on as judgement_on,
    )
    from .statements import Statements as Statements
    from .stating import always as always, never_again as never_again, sometimes as sometimes
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
