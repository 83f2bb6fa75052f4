#!/usr/bin/python3
"""Draw maps/field.png again, the map of the demo's field, with the same bytes each time.

usage: python3 tools/draw_field.py [OUTPUT.png]

The field is 330 m x 240 m and free, with its lower left corner at (0, 0) and a hedge around it, 5 m away.
"""
from output_file import output_file
from PIL import Image, ImageDraw

MARGIN, WIDTH, HEIGHT = 6, 330, 240  # m; a cell is 1 m
FREE, OCCUPIED = 254, 0  # grey, as map_saver writes them


def main():
    """Draw it."""
    size = (WIDTH + 2 * MARGIN, HEIGHT + 2 * MARGIN)
    image = Image.new('L', size, FREE)
    ImageDraw.Draw(image).rectangle((0, 0, size[0] - 1, size[1] - 1), outline=OCCUPIED, width=1)
    image.save(output_file('maps/field.png', __doc__), optimize=True)


if __name__ == '__main__':
    main()
