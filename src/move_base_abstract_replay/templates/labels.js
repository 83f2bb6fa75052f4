// Names on the map that do not cover one another. Those that are written first get the best places; a name without a
// free place is left out.
const LABEL_HEIGHT = 15, CELL = 64; // px

class Labels {
  constructor(context, width, height) {
    Object.assign(this, {context, width, height, cells: new Map()});
  }

  * cellsOf([left, top, right, bottom]) {
    for (let x = Math.floor(left / CELL); x <= Math.floor(right / CELL); x += 1) {
      for (let y = Math.floor(top / CELL); y <= Math.floor(bottom / CELL); y += 1) yield `${x} ${y}`;
    }
  }

  isFree(box) {
    if (box[0] < 2 || box[1] < 2 || box[2] > this.width - 2 || box[3] > this.height - 2) return false;
    for (const cell of this.cellsOf(box)) {
      for (const other of this.cells.get(cell) || []) {
        if (box[0] < other[2] && box[2] > other[0] && box[1] < other[3] && box[3] > other[1]) return false;
      }
    }
    return true;
  }

  // Keep names off a box [left, top, right, bottom].
  take(box) {
    for (const cell of this.cellsOf(box)) {
      if (!this.cells.has(cell)) this.cells.set(cell, []);
      this.cells.get(cell).push(box);
    }
  }

  // Write a text beside (x, y), `gap` from it; return whether there was room for it. `isKept`: write it in any case.
  write(text, x, y, {gap = 10, colour = COLOURS.ink, weight = '', size = 12, isKept = false} = {}) {
    const {context} = this;
    context.font = `${weight ? `${weight} ` : ''}${size}px ${FONT}`;
    const wide = context.measureText(text).width, half = LABEL_HEIGHT / 2;
    const places = [[gap, -gap], [gap, gap], [-gap - wide, -gap], [-gap - wide, gap], [gap + 3, 0],
                    [-gap - 3 - wide, 0], [-wide / 2, -gap - 6], [-wide / 2, gap + 6]];
    const boxes = places.map(([dx, dy]) => [x + dx - 1, y + dy - half, x + dx + wide + 1, y + dy + half]);
    const kept = isKept ? boxes.find((one) => one[2] < this.width) || boxes[2] : null;
    const box = boxes.find((one) => this.isFree(one)) || kept;
    if (!box) return false;
    this.take(box);
    context.textBaseline = 'middle';
    context.lineWidth = 3;
    context.lineJoin = 'round';
    context.strokeStyle = COLOURS.panel;
    context.strokeText(text, box[0] + 1, (box[1] + box[3]) / 2);
    context.fillStyle = colour;
    context.fillText(text, box[0] + 1, (box[1] + box[3]) / 2);
    return true;
  }
}

// The common beginning of all names, up to a last '_' or '/'. With many robots the map leaves it out.
function commonBeginning(names) {
  if (names.length < 2) return '';
  let shared = names[0];
  for (const name of names) {
    while (!name.startsWith(shared)) shared = shared.slice(0, -1);
  }
  shared = shared.slice(0, Math.max(shared.lastIndexOf('_'), shared.lastIndexOf('/')) + 1);
  return names.some((name) => name.length === shared.length) ? '' : shared;
}
