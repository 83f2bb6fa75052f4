#!/usr/bin/python3
"""Draw maps/farm_yard.png again, the map that ships with the package, with the same bytes each time.

usage: python3 tools/draw_farm_yard.py [OUTPUT.png]

The map is 60 m x 40 m in cells of 0.1 m, with its lower left corner at (0, 0). It has four blocks of buildings between
free streets: east-west at y = 4, 20 and 36 m, north-south at x = 4, 30 and 56 m. So every straight leg along a street
is free.
"""
from output_file import output_file
from PIL import Image, ImageDraw

RESOLUTION = 0.1  # m
WIDTH, HEIGHT = 60.0, 40.0  # m
WALL = 0.4  # m
FREE, UNKNOWN, OCCUPIED = 254, 205, 0  # grey, as map_saver writes them


class Plan:
    """A drawing in metres, y upwards."""

    def __init__(self):
        self.image = Image.new('L', (round(WIDTH / RESOLUTION), round(HEIGHT / RESOLUTION)), FREE)
        self._draw = ImageDraw.Draw(self.image)

    def _corners(self, x0, y0, x1, y1):
        return [round(x0 / RESOLUTION), round((HEIGHT - y1) / RESOLUTION),
                round(x1 / RESOLUTION) - 1, round((HEIGHT - y0) / RESOLUTION) - 1]

    def block(self, x0, y0, x1, y1, shade=OCCUPIED):
        """Fill a rectangle."""
        self._draw.rectangle(self._corners(x0, y0, x1, y1), fill=shade)

    def house(self, x0, y0, x1, y1):
        """Draw walls around an unknown inside."""
        self.block(x0, y0, x1, y1)
        self.block(x0 + WALL, y0 + WALL, x1 - WALL, y1 - WALL, UNKNOWN)

    def silo(self, x, y, radius):
        """Fill a circle."""
        self._draw.ellipse(self._corners(x - radius, y - radius, x + radius, y + radius), fill=OCCUPIED)


def draw():
    """Return the image."""
    plan = Plan()
    plan.block(0.0, 0.0, WIDTH, HEIGHT)
    plan.block(WALL, WALL, WIDTH - WALL, HEIGHT - WALL, FREE)
    # south-west: a barn with a lean-to
    plan.house(8.0, 8.0, 20.0, 16.0)
    plan.house(20.0, 8.0, 26.0, 12.0)
    # south-east: a paddock, open to the north
    plan.block(34.0, 8.0, 52.0, 16.0)
    plan.block(34.3, 8.3, 51.7, 15.7, FREE)
    plan.block(41.0, 15.0, 45.0, 16.0, FREE)
    # north-west: silos and a shed
    for x in (10.0, 14.5, 19.0):
        plan.silo(x, 28.0, 2.0)
    plan.house(22.0, 24.0, 26.0, 32.0)
    # north-east: three greenhouses
    for y in (24.0, 27.0, 30.0):
        plan.house(34.0, y, 52.0, y + 2.0)
    return plan.image


def main():
    """Write the image."""
    draw().save(output_file('maps/farm_yard.png', __doc__), optimize=True)


if __name__ == '__main__':
    main()
