"""Maps from files: what the YAML may say, which images can be read, and what is said about those that cannot."""

import os
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.map_images import ImageRule, MapMode
from move_base_abstract.maps.map_check import Ground
from move_base_abstract.maps.map_files import (
    MapDescription,
    load_map,
    read_description,
    read_pixels,
)
from move_base_abstract.motion.geometry import Pose2D

GOOD = {'image': 'm.pgm', 'resolution': '0.05', 'origin': '[1, -2.5, 0.5]', 'negate': '0', 'occupied_thresh': '0.65',
        'free_thresh': '0.196'}
SHIPPED = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'maps', 'farm_yard.yaml')


@pytest.fixture
def describe(tmp_path):
    """Return a function: the description in a YAML file with ``changes``; None leaves a key out."""
    def read(text=None, **changes):
        pairs = dict(GOOD, **changes)
        path = tmp_path / 'm.yaml'
        path.write_text(text if text is not None else ''.join(
            '{}: {}\n'.format(*pair) for pair in pairs.items() if pair[1] is not None))
        return read_description(str(path))
    return read


@pytest.fixture
def pixels(tmp_path):
    """Return a function: the pixels of a file with these bytes, or of this image as PNG."""
    def read(content, **options):
        path = tmp_path / 'image'
        if isinstance(content, bytes):
            path.write_bytes(content)
        else:
            content.save(path, 'PNG', **options)
        return read_pixels(str(path)).tolist()
    return read


def refusal(function, *arguments, **keywords):
    with pytest.raises(ConfigurationError) as error:
        function(*arguments, **keywords)
    return str(error.value)


# ---- YAML

def test_a_description_with_all_that_it_needs(describe, tmp_path):
    assert describe() == MapDescription(str(tmp_path / 'm.pgm'), 0.05, Pose2D(1.0, -2.5, 0.5),
                                        ImageRule(MapMode.TRINARY, False, 0.65, 0.196))
    assert describe(mode='scale', negate='1').rule == ImageRule(MapMode.SCALE, True, 0.65, 0.196)
    assert describe(mode='raw', negate='true').rule == ImageRule(MapMode.RAW, True, 0.65, 0.196)
    assert describe(image='/maps/m.png').image == '/maps/m.png'


def test_numbers_in_the_form_that_only_yaml_1_2_knows(describe):
    assert describe(resolution='5e-2').resolution == 0.05


@pytest.mark.parametrize('key', sorted(GOOD))
def test_a_missing_key_is_named(describe, key, tmp_path):
    assert refusal(describe, **{key: None}) == (
        '{}: {}: missing; a map needs the keys image, resolution, origin, negate, occupied_thresh, free_thresh'.format(
            tmp_path / 'm.yaml', key))


@pytest.mark.parametrize('key, value, got, allowed', [
    ('resolution', '0', '0', 'a finite number > 0 [m/cell]'), ('resolution', '-0.1', '-0.1', 'a finite number > 0'),
    ('resolution', '.nan', 'nan', 'a finite number > 0'), ('resolution', 'fine', "'fine'", 'a finite number > 0'),
    ('resolution', 'true', 'True', 'a finite number > 0'), ('resolution', '[1]', '[1]', 'a finite number > 0'),
    ('occupied_thresh', 'high', "'high'", 'a finite number'), ('free_thresh', '.inf', 'inf', 'a finite number'),
    ('negate', '2', '2', '0 or 1'), ('negate', 'maybe', "'maybe'", '0 or 1'), ('negate', '[0]', '[0]', '0 or 1'),
    ('mode', 'binary', "'binary'", 'trinary, scale, raw'), ('mode', '', 'None', 'trinary, scale, raw'),
    ('origin', '[1, 2]', '[1, 2]', '[x, y, yaw] [m, m, rad]'), ('origin', '0', '0', '[x, y, yaw]'),
    ('origin', '[0, 0, 0, 0]', '[0, 0, 0, 0]', '[x, y, yaw]'), ('mode', '[raw]', "['raw']", 'trinary, scale, raw'),
    ('image', '""', "''", 'the path of an image'), ('image', '3', '3', 'the path of an image')])
def test_a_bad_value_is_named_with_what_is_allowed(describe, tmp_path, key, value, got, allowed):
    text = refusal(describe, **{key: value})
    assert text.startswith('{}: {}: got {}; allowed: {}'.format(tmp_path / 'm.yaml', key, got, allowed))


def test_a_bad_part_of_the_origin_is_named(describe):
    assert 'origin[2]: got None; allowed: a finite number' in refusal(describe, origin='[0, 0, ~]')
    assert 'm.yaml: origin: pose: x must be within +-1e9 m' in refusal(describe, origin='[1.0e+12, 0, 0]')


@pytest.mark.parametrize('text, words', [
    ('image: [', 'is not YAML of plain values: '), ('', 'got NoneType; allowed: a mapping'),
    ('- 1', 'got list; allowed'),
    ('!!python/object/apply:os.getcwd []', 'is not YAML of plain values: could not determine a constructor')])
def test_what_is_no_mapping_is_refused(describe, text, words):
    assert words in refusal(describe, text)


def test_files_that_are_not_there_or_not_text(tmp_path):
    assert refusal(read_description, '/no/m.yaml') == '/no/m.yaml: cannot be read: No such file or directory'
    assert refusal(read_description, str(tmp_path)) == '{}: is a folder; allowed: a file of YAML'.format(tmp_path)
    (tmp_path / 'm').write_bytes(b'P5\n1 1\n255\n\xff')
    assert 'm: is not YAML of plain values: ' in refusal(read_description, str(tmp_path / 'm'))


def test_unknown_keys_and_thresholds_the_wrong_way_round_are_warned_of(describe, tmp_path):
    where = str(tmp_path / 'm.yaml')
    assert describe(modes='scale', author='me', free_thresh='0.7').warnings == (
        where + ": modes: unknown key, not used; did you mean 'mode'?", where + ': author: unknown key, not used',
        where + ': free_thresh 0.7 is above occupied_thresh 0.65: all cells above the latter are occupied')


# ---- images

def test_pgm_in_bytes_and_in_text(pixels):
    wanted = [[[0], [100], [255]]]
    assert pixels(b'P5\n3 1\n255\n\x00\x64\xff') == wanted
    assert pixels(b'P2\n# made by hand: 1 2 3\n3 1 # width, height\n255\n0 100\n255') == wanted
    assert pixels(b'P2 3 1 15 0 10 15') == [[[0], [170], [255]]]
    assert pixels(b'P5\n# by a tool\n3 1 15\n\x00\x0a\x0f') == [[[0], [170], [255]]]
    assert pixels(b'P3\n1 2\n255\n1 2 3 # red\n4 5 6') == [[[1, 2, 3]], [[4, 5, 6]]]
    assert pixels(b'P6 1 1 255\n\x01\x02\x03') == [[[1, 2, 3]]]


def test_pgm_needs_nothing_of_pillow(pixels, monkeypatch):
    def refuse(*args, **kwargs):  # as Pillow before 9.2 does, where the file is text
        raise Image.UnidentifiedImageError

    monkeypatch.setattr(Image, 'open', refuse)
    assert pixels(b'P2 3 1 15 0 10 15') == pixels(b'P5 3 1 15\n\x00\x0a\x0f') == [[[0], [170], [255]]]


def test_png_of_all_kinds(pixels):
    def image(mode, values):
        return Image.fromarray(np.array([values], np.uint8), mode)

    assert pixels(image('L', [7, 200])) == [[[7], [200]]]
    assert pixels(image('LA', [[7, 255], [8, 0]])) == [[[7, 7, 7, 255], [8, 8, 8, 0]]]
    assert pixels(image('RGB', [[1, 2, 3]])) == [[[1, 2, 3]]]
    assert pixels(image('RGBA', [[1, 2, 3, 4]])) == [[[1, 2, 3, 4]]]
    assert pixels(image('L', [0, 255]).convert('1')) == [[[0], [255]]]
    palette = image('P', [0, 1])
    palette.putpalette([255, 254, 253, 0, 1, 2])
    assert pixels(palette) == [[[255, 254, 253], [0, 1, 2]]]
    assert pixels(palette, transparency=1) == [[[255, 254, 253, 255], [0, 1, 2, 0]]]


def png(bits, colour, row, chunks=b''):
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    head = struct.pack('>IIBBBBB', 8 * len(row) // bits, 1, bits, colour, 0, 0, 0)
    return b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', head) + b''.join(chunk(*one) for one in chunks) + chunk(
        b'IDAT', zlib.compress(b'\0' + row)) + chunk(b'IEND', b'')


@pytest.mark.parametrize('image, expected', [
    (png(1, 0, b'\xa5'), [[255], [0], [255], [0], [0], [255], [0], [255]]),
    (png(2, 0, b'\x1b'), [[0], [85], [170], [255]]), (png(4, 0, b'\x3f'), [[51], [255]]),
    (png(16, 0, b'\x01\xc8\xc8\x01'), [[1], [200]]),
    (png(8, 3, b'\0\1\2', [(b'PLTE', bytes([255] * 3 + [0] * 3 + [205, 206, 207])), (b'tRNS', b'\0\x80')]),
     [[255, 255, 255, 0], [0, 0, 0, 128], [205, 206, 207, 255]])])
def test_png_as_the_image_library_of_the_real_one_loads_it(pixels, image, expected):
    assert pixels(image) == [expected]


def test_16_bits_lose_the_lower_8_in_png_and_are_refused_in_pgm(pixels):
    assert pixels(Image.fromarray(np.array([[0, 255, 256, 65535]], np.uint16))) == [[[0], [0], [1], [255]]]
    text = refusal(pixels, b'P5\n1 1\n65535\n\x01\x00')
    assert 'got an image with more than 8 bits a value; allowed: grey, colour or palette images with 8 bits' in text


@pytest.mark.parametrize('content, words', [
    (b'P5\n2 2\n255\n\x00\x01\x02', 'is damaged or truncated: '), (b'P5\n2 2\n255\n', 'is damaged or truncated: '),
    (b'P2\n2 2\n255\n0 1 2', 'is truncated: got 3 values; its header announces 4'),
    (b'P2\n2 2\n255\n0 1 2 -3', 'damaged'), (b'P2\n2 2\n255\n0 1 2 ' + b'9' * 5001, 'damaged'),
    (b'P5 999999999 999999999 255\n', 'is too large: got 999999999 x 999999999 pixels'),
    (b'P2\n2 2\n255\n', 'truncated: '), (b'P2\n2 2\n255\n0 1 2 256', 'damaged'), (b'P5\n2', 'damaged'),
    (b'P5\n0 2\n255\n', 'not an image of a known kind'), (b'hello', 'not an image of a known kind'),
    (b'', 'not an image of a known kind')])
def test_a_damaged_image_is_refused(pixels, tmp_path, content, words):
    text = refusal(pixels, content)
    assert text.startswith(str(tmp_path / 'image')) and words in text


def test_a_png_that_ends_too_soon_is_refused(pixels, tmp_path):
    rows = np.random.default_rng(1).integers(0, 256, (100, 100), np.uint8)
    pixels(Image.fromarray(rows))
    assert 'truncated' in refusal(pixels, (tmp_path / 'image').read_bytes()[:3000])


def test_an_image_that_is_not_there(tmp_path):
    path = str(tmp_path / 'none.pgm')
    wanted = path + ': cannot be read: No such file or directory'
    assert refusal(load_map, MapDescription(path, 1.0)) == wanted


def test_an_image_that_lies_beside_the_description_is_named(describe, tmp_path):
    (tmp_path / 'm.pgm').write_bytes(b'P5\n1 1\n255\n\x00')
    found = describe(image='maps/m.pgm')
    assert refusal(load_map, found) == ('{0}/maps/m.pgm: cannot be read: No such file or directory; beside the YAML '
                                        'file there is {0}/m.pgm: correct the image there'.format(tmp_path))
    assert describe(image='gone.pgm').beside == ''


# ---- the whole

def test_a_map_from_its_files(describe, tmp_path):
    (tmp_path / 'm.pgm').write_bytes(b'P5\n2 2\n255\n\x00\xfe\xcd\x00')
    terrain = load_map(describe(origin='[1, 2, 0]'))
    assert (terrain.cells.tolist(), terrain.resolution, terrain.origin) == (
        [[-1, 100], [100, 0]], float(np.float32(0.05)), Pose2D(1, 2))


def test_what_the_page_says_of_the_differences_from_the_real_one(describe, pixels, tmp_path):
    for content in (b'P1\n2 1\n1 0\n', b'P4\n2 1\n\x80'):
        (tmp_path / 'm.pbm').write_bytes(content)
        assert read_pixels(str(tmp_path / 'm.pbm'))[:, :, 0].tolist() == [[0, 255]]
    palette = Image.new('P', (2, 1))
    palette.putpalette([250, 250, 250, 10, 10, 10] + [0] * 762)
    palette.putpixel((1, 0), 1)
    for end in ('png', 'gif', 'bmp'):
        palette.save(str(tmp_path / ('p.' + end)))
        assert read_pixels(str(tmp_path / ('p.' + end)))[0, :, 0].tolist() == [250, 10]
    for mode, white in (('1', 1), ('L', 255)):
        Image.new(mode, (1, 1), white).save(str(tmp_path / 'w.png'))
        assert read_pixels(str(tmp_path / 'w.png')).tolist() == [[[255]]]
    assert describe(origin='[0, 0, 7.0]').origin.yaw == pytest.approx(7.0 - 2.0 * np.pi)


def test_the_map_that_ships_has_free_streets_and_closed_walls():
    terrain = load_map(read_description(SHIPPED))
    assert terrain.size == pytest.approx((60.0, 40.0))
    assert {int(value) for value in np.unique(terrain.cells)} == {0, 100, -1}
    steps = np.arange(1.0, 59.0, 0.05)
    east_west = [(x, y) for y in (4.0, 20.0, 36.0) for x in steps]
    north_south = [(x, y) for x in (4.0, 30.0, 56.0) for y in steps if y < 39.0]
    assert {terrain.ground_at(*place) for place in east_west + north_south} == {Ground.FREE}
    assert {terrain.ground_at(x, y) for x in steps for y in (0.1, 39.9)} == {Ground.OCCUPIED}
    assert (terrain.ground_at(14.5, 28.0), terrain.ground_at(12.0, 12.0)) == (Ground.OCCUPIED, Ground.UNKNOWN)
