// The data that page_data.py has packed, and functions that look things up in it. They use binary search, so that none
// walks through a whole run.
const NS_PER_S = 1e9;
const ROUND = 0.1; // rad, between two points of an arc

// Return {about, columns} from a text that packed.py has made.
async function unpack(text) {
  const letters = atob(text.trim());
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i += 1) bytes[i] = letters.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  const data = await new Response(stream).arrayBuffer();
  const length = new DataView(data).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
  const kinds = {f8: Float64Array, u4: Uint32Array, u2: Uint16Array, u1: Uint8Array, text: Uint8Array};
  const columns = {};
  for (const [name, [kind, begin, count]] of Object.entries(head.columns)) {
    columns[name] = new kinds[kind](data, 4 + length + begin, count);
    if (kind === 'text') columns[name] = count ? new TextDecoder().decode(columns[name]).split('\n') : [];
  }
  return {about: head.about, columns};
}

// Return the first index from begin to end at which values[index] > wanted; end if there is none. Values ascend.
function upperBound(values, wanted, begin, end) {
  while (begin < end) {
    const middle = (begin + end) >>> 1;
    if (values[middle] > wanted) end = middle;
    else begin = middle + 1;
  }
  return begin;
}

// One log. Times are in ns. Rows are those of the timeline; the first `robots` rows are robots.
class Run {
  constructor({about, columns}) {
    Object.assign(this, columns, about);
    this.stays = new Present(this.stay_change_time, this.stay_change_is_begin, this.stay_change_of);
    this.phases = new Present(this.phase_change_time, this.phase_change_is_begin, this.phase_change_of);
    const fixed = this.links.flatMap(({ends}) => ends).filter((end) => end.robot === undefined);
    this.hosts = [...new Map(fixed.map((host) => [host.name, host])).values()]; // of the radio
    this.robots = about.rows.filter((row) => row.robot).length;
    this.events = this.event_time.length;
  }

  // The pose in a piece at a time: the formula of move_base_abstract/motion/pieces.py. A test holds both to one table.
  poseIn(piece, time) {
    const of = (name) => this[`piece_${name}`][piece];
    const e = (time - of('begin_ns')) / NS_PER_S, k = of('k'), g = k <= 0 ? e : (1 - Math.exp(-k * e)) / k;
    const s = of('v') * g + 0.5 * of('a') * e * e, yaw = of('yaw') + of('w') * g;
    const half = k < 0 ? 0.5 * of('w') * e : 0, chord = half === 0 ? s : s * (Math.sin(half) / half); // of an arc
    const sine = Math.sin(half), cosine = Math.cos(half);
    return {
      x: of('x') + chord * (of('ux') * cosine - of('uy') * sine),
      y: of('y') + chord * (of('uy') * cosine + of('ux') * sine),
      yaw: Math.atan2(Math.sin(yaw), Math.cos(yaw)),
    };
  }

  // Points within an arc up to a time, so that lines between them look round; none if the piece is straight.
  pointsIn(piece, until) {
    const begin = this.piece_begin_ns[piece], isArc = this.piece_k[piece] < 0 && this.piece_v[piece] !== 0;
    const parts = isArc ? Math.ceil((Math.abs(this.piece_w[piece]) * (until - begin)) / NS_PER_S / ROUND) : 0;
    return Array.from({length: Math.max(0, parts - 1)},
      (_, part) => this.poseIn(piece, begin + ((part + 1) / parts) * (until - begin)));
  }

  // The present piece of a motion at a time.
  pieceAt(motion, time) {
    return upperBound(this.piece_begin_ns, time, this.piece_first[motion] + 1, this.piece_first[motion + 1]) - 1;
  }

  // The present motion of a robot, or its last one; -1 before the log says where the robot is.
  motionAt(robot, time) {
    const first = this.motion_first[robot];
    const found = upperBound(this.motion_begin, time, first, this.motion_first[robot + 1]) - 1;
    return found < first ? -1 : found;
  }

  // {x, y, yaw, motion, piece} of a robot, or null before the log says where it is.
  poseAt(robot, time) {
    const motion = this.motionAt(robot, time);
    if (motion < 0) return null;
    const until = Math.min(time, this.motion_end[motion]), piece = this.pieceAt(motion, until);
    return {...this.poseIn(piece, until), motion, piece};
  }

  // The links that are up, each as its two ends {x, y}; links with an end that is not known are left out.
  linksAt(time, poses) {
    const place = (end) => (end.robot === undefined ? end : poses[end.robot]);
    const isUp = ({times, up}) => {
      const count = upperBound(times, time, 0, times.length);
      return count > 0 && up[count - 1];
    };
    return this.links.filter(isUp).map(({ends}) => ends.map(place)).filter(([one, other]) => one && other);
  }

  isUnderWay(motion, time) {
    return time < this.motion_end[motion];
  }

  // The place of a row's state among STATES; without a span the robot is idle.
  stateAt(row, time) {
    const first = this.span_first[row];
    const span = upperBound(this.span_begin, time, first, this.span_first[row + 1]) - 1;
    return span >= first && time < this.span_end[span] ? this.span_state[span] : IDLE;
  }

  // The state of charge of a robot, 0 to 1; null without a battery. Between known values it is interpolated linearly.
  chargeAt(robot, time) {
    const first = this.charge_first[robot], end = this.charge_first[robot + 1];
    if (first === end) return null;
    const next = upperBound(this.charge_time, time, first, end);
    if (next === first || next === end) return this.charge_share[next === end ? end - 1 : first];
    const [begin, until] = [this.charge_time[next - 1], this.charge_time[next]];
    const [from, to] = [this.charge_share[next - 1], this.charge_share[next]];
    return from + (to - from) * (time - begin) / (until - begin);
  }

  // The numbers of orders that are open, under way and over, in words.
  ordersAt(time) {
    const row = upperBound(this.count_time, time, 0, this.count_time.length) - 1;
    if (row < 0) return '';
    const [open, assigned, ...over] = this.count.subarray(6 * row, 6 * row + 6);
    const endings = ['done', 'late', 'failed', 'refused'].map((name, k) => [name, over[k]]);
    const shown = [['open', open], ['assigned', assigned], ...endings].filter(([, count], k) => count || k < 3);
    return `Orders: ${shown.map(([name, count]) => `${grouped(String(count))} ${name}`).join(' · ')}`;
  }

  // The number of events up to and at a time.
  eventsUntil(time) {
    return upperBound(this.event_time, time, 0, this.events);
  }

  // The command that leads to a time in the debugger, and at an event to the row before it; '' if it has none.
  debugCommand(time) {
    if (!this.debug || time <= this.begin) return this.debug;
    const count = this.eventsUntil(time), isEvent = count > 0 && this.event_time[count - 1] === time;
    const before = isEvent ? this.eventsUntil(time - 1) : count;
    if (isEvent && this.is_whole) return before ? `${this.debug} --row ${before}` : this.debug;
    const from = isEvent ? Math.max(time - NS_PER_S / 10, this.begin) : time;
    return from > this.begin ? `${this.debug} --at ${+(from / NS_PER_S).toFixed(9)}` : this.debug;
  }
}
