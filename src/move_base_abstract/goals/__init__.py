"""The life of a goal: the ledger of goals, the navigator that works on them, recovery and endings."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'goal_pose': 'BadFramePolicy GoalPose', 'ledger': 'GoalLedger GoalRecord',
    'navigator': 'Navigator', 'outcome': 'GoalState Outcome', 'recovery': 'RecoveryBehavior RecoveryPolicy'})
