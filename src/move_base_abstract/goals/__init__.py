"""The life of a goal: the ledger of goals, the navigator that works on them, recovery and endings."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .goal_pose import BadFramePolicy as BadFramePolicy, GoalPose as GoalPose
    from .ledger import GoalLedger as GoalLedger, GoalRecord as GoalRecord
    from .navigator import Navigator as Navigator
    from .outcome import GoalState as GoalState, Outcome as Outcome
    from .recovery import RecoveryBehavior as RecoveryBehavior, RecoveryPolicy as RecoveryPolicy
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
