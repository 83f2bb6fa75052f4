#!/usr/bin/python3
"""Draw the picture of docs/routes.md: the ways of `make demo ROUTES=1`, computed with the fleet in plain Python.

usage: python3 tools/draw_routes.py [OUTPUT.png]     (default: docs/images/routes.png), in the built environment
"""
import math
import os

from output_file import output_file
from PIL import Image, ImageDraw

from move_base_abstract import mission
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.scenario import make_scenario
from move_base_abstract_ros.nodes.demo_run.nodes import robot_settings, shipped

PIXELS = 2  # of the picture for each pixel of the map; drawn at twice that and scaled down, for smooth lines
SMOOTH = 2
COLOURS = ('#d62728', '#1f77b4', '#2ca02c', '#9467bd', '#ff7f0e')
RADIUS = 0.6  # m, of the discs where robots start


def begun(**world):
    """Return a fleet that has begun the mission, its plan, and the map; ``world``: more keys of the scenario."""
    plan = mission.read_mission(shipped('config', 'demo_routes_mission.yaml'))
    occupancy = load_map(read_description(shipped('maps', 'farm_yard.yaml')))
    robots = [{'name': robot.name, 'start_x': robot.start.x, 'start_y': robot.start.y} for robot in plan.robots]
    goals = {robot.name: list(robot.goals) for robot in plan.robots}

    def send(name, *_details):
        if goals[name]:
            goal = goals[name].pop(0)
            fleet.robot(name).send(goal.x, goal.y, goal.yaw)
    settings = robot_settings(2.0, True, routes=True, rviz=False)
    fleet = Fleet(make_scenario({'defaults': settings, 'robots': robots, **world}), on_end=send, occupancy=occupancy)
    for name in fleet.names:
        send(name)
    return fleet, plan, occupancy


def ways():
    """Return {robot: [(x, y), ...]} of the whole mission, and the map."""
    fleet, plan, occupancy = begun()
    fleet.run()
    points = {robot.name: [(robot.start.x, robot.start.y)] for robot in plan.robots}
    for entry in fleet.trace:
        if entry.kind == 'route':
            points[entry.robot] += zip(entry.values[::2], entry.values[1::2])
        elif entry.kind == 'stands':
            points[entry.robot].append(entry.values[:2])
    return points, occupancy


def draw():
    """Return the picture."""
    points, occupancy = ways()
    scale = PIXELS * SMOOTH / occupancy.resolution
    yard = Image.open(shipped('maps', 'farm_yard.png')).convert('L').point(lambda grey: 96 + grey * 159 // 255)
    image = yard.resize([side * PIXELS * SMOOTH for side in yard.size], Image.NEAREST).convert('RGB')
    pen = ImageDraw.Draw(image)
    for number, (colour, way) in enumerate(zip(COLOURS, points.values())):
        shift = (number - 2) * 0.18  # m: ways are side by side if robots share a street
        places = [((x + shift) * scale, image.height - (y + shift) * scale) for x, y in way]
        pen.line(places, fill=colour, width=round(0.2 * scale), joint='curve')
        radius = RADIUS * scale
        x, y = places[0]
        pen.ellipse([x - radius, y - radius, x + radius, y + radius], fill=colour)
    width, height = (math.ceil(side / SMOOTH) for side in image.size)
    return image.resize((width, height), Image.LANCZOS).quantize(64)


if __name__ == '__main__':
    OUTPUT = output_file('docs/images/routes.png', __doc__)
    draw().save(OUTPUT, optimize=True)
    print(f'{OUTPUT}: {os.path.getsize(OUTPUT) // 1024} KB')
