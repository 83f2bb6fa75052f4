#!/usr/bin/python3
"""Draw maps/field.png anew, the map of the demo's field: the same bytes each time.

usage: tools/draw_field.py [OUTPUT.png]

A field of 330 m x 240 m, lower left corner at (0, 0), free everywhere, and a hedge around it, 5 m away.
"""
import sys
from pathlib import Path

from PIL import Image, ImageDraw

MARGIN, WIDTH, HEIGHT = 6, 330, 240  # m; a cell is 1 m
FREE, OCCUPIED = 254, 0  # grey, as map_saver writes them


def main():
    """Draw it."""
    size = (WIDTH + 2 * MARGIN, HEIGHT + 2 * MARGIN)
    image = Image.new('L', size, FREE)
    ImageDraw.Draw(image).rectangle((0, 0, size[0] - 1, size[1] - 1), outline=OCCUPIED, width=1)
    default = Path(__file__).resolve().parent.parent / 'maps' / 'field.png'
    image.save(sys.argv[1] if len(sys.argv) > 1 else default, optimize=True)


if __name__ == '__main__':
    main()
