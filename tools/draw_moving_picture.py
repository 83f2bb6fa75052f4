#!/usr/bin/python3
"""Draw the moving picture of the README: five robots go around buildings, and wait while a crossing is full.

usage: python3 tools/draw_moving_picture.py [OUTPUT.gif]     (default: docs/images/run.gif), in the built environment
"""
import draw_routes
from output_file import output_file
from PIL import Image, ImageDraw

from move_base_abstract_ros.nodes.demo_run.nodes import shipped

ZONE = (26.0, 16.0, 34.0, 24.0)  # m: the crossing in the middle, with room for one robot
SECONDS, FRAMES_PER_SECOND = 90, 2  # of simulated time
FRAME_MS = 50  # on the screen, which is ten times real time
RADIUS = 0.8  # m
METRE = 10  # pixels, as in the map


def frame(background, fleet, now_s):
    """Return the picture of one instant: the map, the zone, the robots, and the time."""
    picture = background.copy()
    draw, height = ImageDraw.Draw(picture), background.height
    west, south, east, north = (METRE * value for value in ZONE)
    draw.rectangle((west, height - north, east, height - south), outline='#e0a000', width=2)
    for name, colour in zip(fleet.names, draw_routes.COLOURS):
        pose = fleet.robot(name).pose
        x, y, radius = METRE * pose.x, height - METRE * pose.y, METRE * RADIUS
        draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour, outline='black')
    draw.text((8, 6), f'{now_s:5.1f} s', fill='black')
    return picture.quantize(32)


def main():
    """Draw a picture every half second of simulated time."""
    path = output_file('docs/images/run.gif', __doc__)
    fleet, *_ = draw_routes.begun(zones=[{'name': 'crossing', 'rectangle': list(ZONE), 'capacity': 1}])
    background, frames = Image.open(shipped('maps', 'farm_yard.png')).convert('RGB'), []
    for number in range(SECONDS * FRAMES_PER_SECOND):
        fleet.run_for(1.0 / FRAMES_PER_SECOND)
        frames.append(frame(background, fleet, (number + 1) / FRAMES_PER_SECOND))
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=FRAME_MS, loop=0, optimize=True)
    print(path)


if __name__ == '__main__':
    main()
