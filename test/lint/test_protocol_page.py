"""The page of the protocol says what the one table of the wire format says."""
import re
from pathlib import Path

from move_base_abstract.lockstep import wire_format

ROOT = Path(__file__).resolve().parents[2]
LAYOUTS = [layout for name in ('PARTICIPANT_FRAMES', 'MASTER_FRAMES', 'REPORT_ITEMS', 'GRANT_ITEMS')
           for layout in getattr(wire_format, name)]


def columns():
    """Return the rows of the page's tables of frames and items, as (number, name, rest)."""
    text = (ROOT / 'docs/lockstep_protocol.md').read_text(encoding='utf-8')
    return re.findall(r'^\| (\d+) \| ([A-Z_]+) \|(.*)\|$', text, re.MULTILINE)


def test_the_page_of_the_protocol_lists_every_frame_and_item_with_its_fields():
    told = []
    for number, name, rest in columns():
        fields = re.sub(r' ?\([^)]*\)', '', rest).split(';')[0].strip()
        told.append((int(number), name, [field for field in fields.split(', ') if field]))
    assert sorted(told) == sorted(
        (layout.number, layout.name, ['items to the end' if field.endswith('Item items') else field.partition(' =')[0]
                                      for field in layout.fields]) for layout in LAYOUTS)


def test_the_page_names_the_protocol_and_the_choices():
    text = (ROOT / 'docs/lockstep_protocol.md').read_text(encoding='utf-8')
    assert f'u32 protocol ({wire_format.PROTOCOL})' in text
    for name, values in wire_format.CHOICES.items():
        told = re.search(name + r' \w+ \(([^)]*)\)', text).group(1)
        assert sorted(map(int, re.findall(r'\b\d\b', told))) == [number for number, _ in values]
