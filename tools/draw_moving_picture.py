#!/usr/bin/python3
"""Draw the moving picture of the README: five robots go around buildings, and wait while a crossing is full.

usage: python3 tools/draw_moving_picture.py [OUTPUT.gif]     (default: docs/images/run.gif), in the built environment
"""
from output_file import output_file
from PIL import Image, ImageDraw

from move_base_abstract import mission
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.scenario import make_scenario
from move_base_abstract_ros.nodes.demo_run.nodes import robot_settings, shipped

COLOURS = ('#d62728', '#1f77b4', '#2ca02c', '#9467bd', '#ff7f0e')
ZONE = (26.0, 16.0, 34.0, 24.0)  # m: the crossing in the middle, with room for one robot
SECONDS, FRAMES_PER_SECOND = 90, 2  # of simulated time
FRAME_MS = 50  # on the screen, which is ten times real time
RADIUS = 0.8  # m
METRE = 10  # pixels, as in the map


def begun():
    """Return a fleet that has begun the mission, and the picture of its map."""
    plan = mission.read_mission(shipped('config', 'demo_routes_mission.yaml'))
    description = read_description(shipped('maps', 'farm_yard.yaml'))
    robots = [{'name': robot.name, 'start_x': robot.start.x, 'start_y': robot.start.y} for robot in plan.robots]
    goals = {robot.name: list(robot.goals) for robot in plan.robots}

    def send(name, *_details):
        if goals[name]:
            goal = goals[name].pop(0)
            fleet.robot(name).send(goal.x, goal.y, goal.yaw)
    settings = robot_settings(2.0, True, routes=True, rviz=False)
    scenario = make_scenario({'defaults': settings, 'robots': robots,
                              'zones': [{'name': 'crossing', 'rectangle': list(ZONE), 'capacity': 1}]})
    fleet = Fleet(scenario, on_end=send, occupancy=load_map(description))
    for name in fleet.names:
        send(name)
    return fleet, Image.open(shipped('maps', 'farm_yard.png')).convert('RGB')


def frame(background, fleet, now_s):
    """Return the picture of one instant: the map, the zone, the robots, and the time."""
    picture = background.copy()
    draw, height = ImageDraw.Draw(picture), background.height
    west, south, east, north = (METRE * value for value in ZONE)
    draw.rectangle((west, height - north, east, height - south), outline='#e0a000', width=2)
    for name, colour in zip(fleet.names, COLOURS):
        pose = fleet.robot(name).pose
        x, y, radius = METRE * pose.x, height - METRE * pose.y, METRE * RADIUS
        draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour, outline='black')
    draw.text((8, 6), f'{now_s:5.1f} s', fill='black')
    return picture.quantize(32)


def main():
    """Draw a picture every half second of simulated time."""
    path = output_file('docs/images/run.gif', __doc__)
    fleet, background = begun()
    frames = []
    for number in range(SECONDS * FRAMES_PER_SECOND):
        fleet.run_for(1.0 / FRAMES_PER_SECOND)
        frames.append(frame(background, fleet, (number + 1) / FRAMES_PER_SECOND))
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=FRAME_MS, loop=0, optimize=True)
    print(path)


if __name__ == '__main__':
    main()
