"""Prints the records: as lines of JSON, and as tables for people."""
import json
import sys

COLUMNS = {
    'reference': ('what', 'median_us', 'p90_us'),
    'clock': ('factor', 'robots', 'achieved_factor', 'largest_step_s', 'largest_step_wall_ms', 'rate_hz'),
    'leg': ('length_m', 'factor', 'robots', 'legs', 'error_percent', 'client_hop_percent', 'out_s', 'back_s',
            'published_percent', 'wanted_percent', 'published_over_ours'),
    'stamps': ('factor', 'robots', 'legs', 'legs_with_departure', 'largest_travel_error_ns', 'poses',
               'largest_pose_error_ns'),
    'scale': ('robots', 'processes', 'first_s', 'last_s', 'wanted_s', 'memory_mb', 'wanted_mb', 'threads',
              'idle_cpu_percent'),
    'lockstep': ('client', 'rates', 'robots', 'events_per_s', 'wanted_per_s', 'over_reference', 'speed_up',
                 'wanted_speed_up'),
    'sequence': ('clock', 'robots', 'goals', 'same_order', 'earliest_s', 'latest_s'),
    'experiments': ('what', 'wall_s', 'wanted_s', 'cpu_s', 'load', 'memory_mb_early', 'memory_mb_late'),
    'launcher': ('what', 'per_s', 'wanted_per_s', 'exact'),
    'launcher_start': ('plain_s', 'launched_s', 'added_s', 'wanted_added_s'),
    'launcher_end': ('nodes', 'runs', 'start_s', 'wanted_start_s', 'end_s', 'longest_s', 'wanted_end_s', 'cpu_s'),
    'system': ('name', 'runs', 'simulated_s', 'start_s', 'run_s', 'end_s', 'speed_up', 'cpu_s_per_simulated_s',
               'over_roslaunch', 'rounds_per_s', 'messages_per_s', 'repeatable', 'same'),
    'dense': ('cores', 'lookahead', 'agent', 'agents', 'rates', 'speed_up', 'wanted_speed_up', 'rounds_per_s',
              'deliveries_per_s', 'switches_per_tick', 'us_per_delivery_time_master',
              'us_per_delivery_fleet', 'us_per_delivery_agents', 'repeatable'),
    'lockstep_ticks': ('ticks_per_s', 'wanted_per_s', 'over_reference', 'exact'),
    'plain': ('what', 'tree', 'robots', 'goals', 'per_s', 'wanted_per_s', 'of_simpy', 'reading_us'),
    'world_part': ('part', 'robots', 'events', 'us_per_event', 'us_per_goal', 'over_none'),
    'world_plan': ('cells', 'new_ms', 'wanted_new_ms', 'known_ms', 'wanted_known_ms'),
    'world_fleet': ('part', 'robots', 'events_per_s', 'wanted_per_s', 'speed_up'),
    'traffic': ('policy', 'work', 'orders', 'aborted', 'circles', 'gave_way', 'cpu_s'),
    'cpu': ('factor', 'robots', 'time_master_percent', 'move_base_percent', 'client_percent'),
}


def show(records):
    """Print each record as a line of JSON once it is there; then all as tables, one a kind, on standard error."""
    shown = []
    for record in records:
        shown.append(record)
        print(json.dumps(record), flush=True)
    print('\n' + '\n\n'.join(_table(kind, of_kind) for kind in COLUMNS for of_kind in [
        [record for record in shown if record['kind'] == kind]] if of_kind), file=sys.stderr)


def _table(kind, records):
    columns = COLUMNS[kind]
    rows = [columns] + [tuple(_cell(record.get(column)) for column in columns) for record in records]
    widths = [max(len(row[i]) for row in rows) for i in range(len(columns))]
    lines = ['  '.join(cell.rjust(width) for cell, width in zip(row, widths)) for row in rows]
    return '\n'.join([f'-- {kind}', *lines])


def _cell(value):
    if value is None:
        return '-'
    return f'{value:.4g}' if isinstance(value, float) else str(value)
