// The zones, lanes, nodes and places of the scenario: where they are, the number of robots in them, and which ones wait.
const INSIDE = 0, WAITS = 1;
const CRITICAL = 'critical', LOW = 'below good', GOOD = 'good'; // levels of charge

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

  // The speed limits of zones [m/s] that hold at a time: {thing: limit}.
  limitsAt(run, time) {
    const limits = new Map();
    this.things.forEach(({max_speed}, k) => max_speed && limits.set(k, max_speed));
    for (let k = 0; k < run.limit_time.length && run.limit_time[k] <= time; k += 1) {
      if (run.limit_speed[k]) limits.set(run.limit_thing[k], run.limit_speed[k]);
      else limits.delete(run.limit_thing[k]);
    }
    return limits;
  }

  // At which level of the scenario's dispatcher a state of charge is. Without a dispatcher it is for the colour only.
  levelOf(share) {
    const {critical = 0.2, good = 0.5} = this.levels;
    return share <= critical ? CRITICAL : share < good ? LOW : GOOD;
  }

  isFull(thing, use) {
    return thing.capacity !== null && use !== undefined && use.inside.length >= thing.capacity;
  }

  // The sign of a thing: 'gate 1/2 +3 ≤ 0.5 m/s' means one robot is in it, there is room for two, three wait, and robots
  // may drive at 0.5 m/s.
  sign(thing, use, withName, limit) {
    const inside = use ? use.inside.length : 0, waiting = use ? use.waiting.length : 0;
    const hasRoom = thing.capacity !== null && (inside || !thing.parking); // robots that park are no guests
    const counts = hasRoom ? `${inside}/${thing.capacity}` : inside ? `${inside}` : '';
    return [withName ? thing.name : '', counts, waiting ? `+${waiting}` : '',
            limit ? `≤ ${limit} m/s` : ''].filter(Boolean).join(' ');
  }

  // Whether the map is too small for its name: it is one of many.
  isOneOfMany({kind, capacity}) {
    return kind === 'lane' || (kind === 'node' && capacity === 1);
  }

  // The use of a thing in words, with the names of robots.
  words(thing, use, nameOf, limit) {
    const list = (robots) => robots.slice(0, 8).map(nameOf).join(', ') + (robots.length > 8 ? ', …' : '');
    const {inside, waiting} = use || {inside: [], waiting: []};
    const counts = thing.capacity === null ? `${inside.length} in it` : `${inside.length} of ${thing.capacity}`;
    return [`${thing.parking ? 'parking place' : thing.kind}${thing.charger ? ' with a charger' : ''} ${thing.name}`,
            ...(inside.length ? [`${counts}: ${list(inside)}`] : thing.parking ? [] : [counts]),
            ...(limit ? [`at most ${limit} m/s`] : []),
            ...(waiting.length ? [`${waiting.length} wait${waiting.length === 1 ? 's' : ''}: ${list(waiting)}`] : [])].join(' · ');
  }

  // The thing whose middle, or whose line, is nearest to (x, y), within `reach` [m]; a zone may be hit anywhere.
  nearest(x, y, reach) {
    let [found, least] = [null, reach];
    this.things.forEach((thing, number) => {
      const far = thing.kind === 'zone' ? (contains(thing.points, x, y) ? 0.9 * reach : Infinity)
                : thing.kind === 'lane' ? distanceToLine(thing.points, x, y)
                : thing.kind === 'node' ? 0.5 * Math.min(...thing.points.map(([a, b]) => Math.hypot(a - x, b - y)))
                : Math.max(0, Math.hypot(thing.points[0][0] - x, thing.points[0][1] - y) - thing.reach);
      if (far < least) [found, least] = [number, far];
    });
    return found;
  }
}

function middleOf({kind, points}) {
  if (kind === 'node') return points[0];
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
