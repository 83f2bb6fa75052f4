"""Reads maps from files: the YAML description and its image, in the format of map_server.

There are no nodes and topics here: the input is a file, and the result is a description or pixels, or a
ConfigurationError that names the file.
"""
from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Iterator, Mapping, Optional, Tuple, TypeVar

import numpy as np
from PIL import Image

from .bounded_yaml import load_yaml_file
from .errors import ConfigurationError
from .geometry import Pose2D, pose_of
from .input_files import open_input
from .kinds import as_number, error, similar
from .map_images import ImageRule, MapMode
from .pnm_files import BYTES_MAX, check_size, is_pnm, read_pnm
from .shown import shown_text

if TYPE_CHECKING:
    from .type_names import StrPath

_REQUIRED = ('image', 'resolution', 'origin', 'negate', 'occupied_thresh', 'free_thresh')
_KEYS = _REQUIRED + ('mode',)
_FLAGS = {0: False, 1: True}  # this allows false and true, too, which are equal to 0 and 1
_CONVERSIONS = {'1': 'L', 'L': 'L', 'LA': 'RGBA', 'La': 'RGBA', 'P': 'RGB', 'PA': 'RGBA', 'RGB': 'RGB',
                'RGBA': 'RGBA', 'RGBX': 'RGB', 'CMYK': 'RGB', 'YCbCr': 'RGB'}
_GREY_16 = ('I', 'I;16', 'I;16B', 'I;16L')
_STRIP = 256  # rows
_Chosen = TypeVar('_Chosen')


@dataclass(frozen=True)
class MapDescription:
    """The content of a map's YAML file.

    ``image``: the path of the image, absolute or relative to the working directory; ``resolution``: the side of a cell
    [m]; ``origin``: the pose of the south-west corner; ``rule``: how the image is read; ``warnings``: texts about
    strange keys and values; ``beside``: if the image is not there, the path of a file of its name that lies beside the
    YAML file, or ''.
    """

    image: str
    resolution: float
    origin: Pose2D = Pose2D()
    rule: ImageRule = ImageRule()
    warnings: Tuple[str, ...] = ()
    beside: str = ''


def read_description(path: StrPath) -> MapDescription:
    """Return the :class:`MapDescription` in the YAML file ``path``.

    :raises ConfigurationError: if it cannot be used; the text names the file, the key, what was got and what is
        allowed.
    """
    document = load_yaml_file(path)
    if not isinstance(document, dict):
        raise ConfigurationError('{}: got {}; allowed: a mapping with the keys {}'.format(
            path, type(document).__name__, ', '.join(_REQUIRED)))
    for key in _REQUIRED:
        if key not in document:
            raise ConfigurationError('{}: {}: missing; a map needs the keys {}'.format(path, key, ', '.join(_REQUIRED)))
    resolution = _number(document['resolution'], path, 'resolution', above=0.0, unit=' [m/cell]')
    modes = {mode.value: mode for mode in MapMode}
    rule = ImageRule(_choice(document.get('mode', MapMode.TRINARY.value), path, 'mode', modes, ', '.join(modes)),
                     _choice(document['negate'], path, 'negate', _FLAGS, '0 or 1'),
                     _number(document['occupied_thresh'], path, 'occupied_thresh'),
                     _number(document['free_thresh'], path, 'free_thresh'))
    image = _image_path(document['image'], path)
    beside = os.path.join(os.path.dirname(path), re.split(r'[/\\]', image)[-1])
    return MapDescription(image, resolution, _origin(document['origin'], path), rule, tuple(
        _warnings(document, rule, path)), beside if not os.path.exists(image) and os.path.isfile(beside) else '')


def _number(raw: Any, path: StrPath, key: str, above: Optional[float] = None, unit: str = '') -> float:
    """Return ``raw`` as a finite float. A text is allowed, since YAML 1.1 reads 5e-2 as one, unlike other readers."""
    try:
        if isinstance(raw, bool):
            raise ValueError
        value = as_number(raw)
        if not math.isfinite(value) or (above is not None and not value > above):
            raise ValueError
    except (TypeError, ValueError, OverflowError):
        raise error(f'{path}: {key}', raw, 'a finite number{}{}'.format(
            '' if above is None else ' > {:g}'.format(above), unit)) from None
    return value


def _choice(raw: Any, path: StrPath, key: str, choices: Mapping[Any, _Chosen], allowed: str) -> _Chosen:
    if not isinstance(raw, (bool, int, str)) or raw not in choices:
        raise error(f'{path}: {key}', raw, allowed)
    return choices[raw]


def _origin(raw: Any, path: StrPath) -> Pose2D:
    if not isinstance(raw, list) or len(raw) != 3:
        raise error(f'{path}: origin', raw, '[x, y, yaw] [m, m, rad], the pose of the lower left corner')
    numbers = [_number(part, path, 'origin[{}]'.format(index)) for index, part in enumerate(raw)]
    return pose_of(numbers, '{}: origin'.format(path))


def _image_path(raw: Any, path: StrPath) -> str:
    if not isinstance(raw, str) or not raw:
        raise error(f'{path}: image', raw, 'the path of an image, relative to this file or absolute')
    return os.path.join(os.path.dirname(path), raw)


def _warnings(document: Dict[Any, Any], rule: ImageRule, path: StrPath) -> Iterator[str]:
    for key in document:
        if key not in _KEYS:
            yield '{}: {}: unknown key, not used{}'.format(path, shown_text(key), similar(key, _KEYS))
    if rule.free_thresh > rule.occupied_thresh:
        yield '{}: free_thresh {:g} is above occupied_thresh {:g}: all cells above the latter are occupied'.format(
            path, rule.free_thresh, rule.occupied_thresh)


def read_pixels(path: StrPath) -> Any:
    """Return the pixels of the image file ``path``: uint8 (rows from the top, columns, channels).

    Channels: 1 = grey, 3 = colour, 4 = colour and alpha.

    :raises ConfigurationError: if there is no such file, if it is damaged, or if its pixels have another format.
    """
    try:
        with open_input(path, BYTES_MAX, what='file of an image') as stream:
            if is_pnm(stream):
                return read_pnm(path, stream)
            with Image.open(stream) as image:
                check_size(path, image.height, image.width)
                image.load()
                return _to_channels(path, image)
    except Image.UnidentifiedImageError:
        raise ConfigurationError('{}: is not an image of a known kind, or its header is damaged; allowed: PGM, PNG and '
                                 'other common formats'.format(path)) from None
    except ConfigurationError:
        raise
    except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as fault:
        raise ConfigurationError('{}: the image is damaged or truncated: {}'.format(path, fault)) from None


def _to_channels(path: StrPath, image: Any) -> Any:
    if image.mode not in _GREY_16 and image.mode not in _CONVERSIONS:
        raise ConfigurationError("{}: got an image with the mode '{}'; allowed: grey, colour or palette images with 8 "
                                 'bits a value, with or without alpha'.format(path, image.mode))
    mode = None if image.mode in _GREY_16 else 'RGBA' if 'transparency' in image.info else _CONVERSIONS[image.mode]
    pixels: Any = np.empty((image.height, image.width, len(mode or 'L')), np.uint8)
    # In strips, since a conversion of the whole takes several times the memory of the pixels.
    for top in range(0, image.height, _STRIP):
        strip = image.crop((0, top, image.width, min(top + _STRIP, image.height)))
        shades = np.asarray(strip).astype(np.uint16) >> 8 if mode is None else np.asarray(strip.convert(mode))
        pixels[top:top + _STRIP] = shades.reshape(pixels[top:top + _STRIP].shape)
    return pixels
