// The zones, lanes and places of the scenario: where they are, the number of robots in them, and which ones wait.
const INSIDE = 0, WAITS = 1;

// The spans, of many, that hold at a time. It steps forwards and back from change to change, never from the beginning.
class Present {
  constructor(times, isBegin, of) {
    Object.assign(this, {times, isBegin, of, done: 0, held: new Set()});
  }

  at(time) {
    const {times, isBegin, of, held} = this, wanted = upperBound(times, time, 0, times.length);
    for (; this.done < wanted; this.done += 1) {
      if (isBegin[this.done]) held.add(of[this.done]);
      else held.delete(of[this.done]);
    }
    for (; this.done > wanted; this.done -= 1) {
      if (isBegin[this.done - 1]) held.delete(of[this.done - 1]);
      else held.add(of[this.done - 1]);
    }
    return held;
  }
}

class World {
  constructor({about}) {
    Object.assign(this, about);
    this.things.forEach((thing) => { thing.middle = middleOf(thing); });
    this.hasUse = this.things.some(({kind, capacity}) => kind === 'place' || capacity !== null);
  }

  // For each thing in use at a time: {inside: [robot], waiting: [robot]}, in the order in which the robots came.
  usesAt(run, time) {
    const uses = new Map();
    for (const stay of [...run.stays.at(time)].sort((one, other) => one - other)) {
      const thing = run.stay_thing[stay];
      if (!uses.has(thing)) uses.set(thing, {inside: [], waiting: []});
      uses.get(thing)[run.stay_kind[stay] === WAITS ? 'waiting' : 'inside'].push(run.stay_robot[stay]);
    }
    return uses;
  }

  isFull(thing, use) {
    return thing.capacity !== null && use !== undefined && use.inside.length >= thing.capacity;
  }

  // The sign of a thing: 'gate 1/2 +3' means one robot is in it, there is room for two, and three wait.
  sign(thing, use, withName) {
    const inside = use ? use.inside.length : 0, waiting = use ? use.waiting.length : 0;
    const counts = thing.capacity === null ? (inside ? `${inside}` : '') : `${inside}/${thing.capacity}`;
    return [withName ? thing.name : '', counts, waiting ? `+${waiting}` : ''].filter(Boolean).join(' ');
  }

  // The use of a thing in words, with the names of robots.
  words(thing, use, nameOf) {
    const list = (robots) => robots.slice(0, 8).map(nameOf).join(', ') + (robots.length > 8 ? ', …' : '');
    const {inside, waiting} = use || {inside: [], waiting: []};
    const counts = thing.capacity === null ? `${inside.length} in it` : `${inside.length} of ${thing.capacity}`;
    return [`${thing.kind}${thing.charger ? ' with a charger' : ''} ${thing.name}`,
            inside.length ? `${counts}: ${list(inside)}` : counts,
            ...(waiting.length ? [`${waiting.length} wait${waiting.length === 1 ? 's' : ''}: ${list(waiting)}`] : [])].join(' · ');
  }

  // The thing whose middle, or whose line, is nearest to (x, y), within `reach` [m]; a zone may be hit anywhere.
  nearest(x, y, reach) {
    let [found, least] = [null, reach];
    this.things.forEach((thing, number) => {
      const far = thing.kind === 'zone' ? (contains(thing.points, x, y) ? 0.9 * reach : Infinity)
                : thing.kind === 'lane' ? distanceToLine(thing.points, x, y)
                : Math.max(0, Math.hypot(thing.points[0][0] - x, thing.points[0][1] - y) - thing.reach);
      if (far < least) [found, least] = [number, far];
    });
    return found;
  }
}

function middleOf({kind, points}) {
  if (kind !== 'lane') return [0, 1].map((k) => points.reduce((sum, point) => sum + point[k], 0) / points.length);
  const {at: [a, b]} = longestPiece(points);
  return [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
}

function longestPiece(points) {
  const pieces = points.slice(1).map((point, k) => [points[k], point]);
  const length = ([a, b]) => Math.hypot(b[0] - a[0], b[1] - a[1]);
  const at = pieces.reduce((best, piece) => (length(piece) > length(best) ? piece : best), pieces[0]);
  return {at, length: length(at)};
}

function contains(points, x, y) {
  let isInside = false;
  points.forEach(([ax, ay], k) => {
    const [bx, by] = points[(k + 1) % points.length];
    if ((ay > y) !== (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)) isInside = !isInside;
  });
  return isInside;
}

function distanceToLine(points, x, y) {
  let least = Infinity;
  for (let k = 1; k < points.length; k += 1) {
    const [[ax, ay], [bx, by]] = [points[k - 1], points[k]], square = (bx - ax) ** 2 + (by - ay) ** 2;
    const share = square ? Math.min(1, Math.max(0, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / square)) : 0;
    least = Math.min(least, Math.hypot(ax + share * (bx - ax) - x, ay + share * (by - ay) - y));
  }
  return least;
}
