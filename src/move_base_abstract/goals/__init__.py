"""The life of a goal: the book of goals, the navigator that works on them, recovery and endings."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'ledger': 'GoalLedger GoalRecord', 'listener': 'BadFramePolicy GoalPose NavigatorListener',
    'navigator': 'Navigator', 'outcome': 'GoalState Outcome', 'recovery': 'RecoveryBehavior RecoveryPolicy'})
