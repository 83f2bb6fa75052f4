"""Properties of a run: statements of nodes, properties of every good run, and which of them a run has broken.

For nodes: ``from move_base_abstract.properties import always, never_again, sometimes``.
"""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'stating': 'always never_again sometimes', 'statements': 'Statements',
    'judgement': 'Broken Judgement Run judge judge_log judgement_on', 'gathering': 'Gathering'})
