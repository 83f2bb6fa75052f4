"""Dispatchers of small worlds for tests, and what they have told."""
from move_base_abstract.fleet import Dispatch
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.orders.order import Order, Stop
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000
KINDS = ('order_arrived', 'order_refused', 'order_assigned', 'order_stop', 'order_returned', 'order_done',
         'charge_assigned', 'charge_awaited', 'charge_over')


def dispatch_of(*orders, robots=2, policy=None, places=(), zones=(), dispatcher=None, each=None, **defaults):
    """Return a Dispatch of robots r_0, r_1, ... at 1 m/s, 10 m apart on the x axis; ``orders`` are keys of entries."""
    return Dispatch(make_scenario({
        'seed': 2, 'defaults': {'max_speed': 1.0, **defaults}, 'dispatcher': dispatcher or {}, 'zones': list(zones),
        'robots': [{'name': 'r_{}'.format(k), 'start_x': 10.0 * k, **((each or {}).get(k, {}))} for k in range(robots)],
        'places': list(places), 'orders': list(orders)}), policy, start_ns=0)


def told(dispatch, *kinds):
    return [(entry.time_ns / S, entry.robot, entry.kind, *entry.values) for entry in dispatch.fleet.trace
            if entry.kind in (kinds or KINDS)]


def order(order_id, *points, seconds=0.0, **more):
    return Order(order_id, 0, tuple(Stop(Pose2D(*point), duration_ns=int(seconds * S)) for point in points), **more)
