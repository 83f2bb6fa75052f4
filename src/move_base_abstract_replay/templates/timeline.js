// The rows of the timeline: what each robot does, and when. They are drawn again only when the time window, the scroll
// position or the size changes. The line of the present is on a canvas above. Spans that are narrower than a pixel
// share the pixel in proportion to their lengths.
const ROW = 24, AXIS = 26, NARROW = 1.5; // px

class Timeline {
  constructor(element, player) {
    [this.canvas, this.above] = element.querySelectorAll('canvas');
    this.spacer = element.querySelector('.spacer');
    Object.assign(this, {element, player, isDirty: true, width: 0});
    const names = new Map();
    player.runs.forEach((run, place) => run.rows.forEach(({name}, row) => {
      if (!names.has(name)) names.set(name, new Array(player.runs.length).fill(-1));
      names.get(name)[place] = row;
    }));
    this.rows = [...names].map(([name, places]) => ({name, places}));
    this.rows.sort((a, b) => this.isRobot(b) - this.isRobot(a)); // stable
    this.spacer.style.height = `${AXIS + ROW * this.rows.length + 6}px`;
    this.showAll();
    element.addEventListener('scroll', () => { this.isDirty = true; player.redraw(); });
    this.above.addEventListener('pointerdown', (event) => this.take(event));
    this.above.addEventListener('pointermove', (event) => this.isHeld && this.seek(event));
    for (const name of ['pointerup', 'pointercancel']) this.above.addEventListener(name, () => { this.isHeld = false; });
    this.above.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
  }

  isRobot({places}) {
    return this.player.runs.some((run, k) => places[k] >= 0 && run.rows[places[k]].robot);
  }

  get labels() {
    return Math.min(150, Math.max(64, Math.round(this.width * 0.16)));
  }

  toX(time) {
    return this.labels + (time - this.from) / (this.to - this.from) * (this.width - this.labels - 12);
  }

  toTime(x) {
    return this.from + (x - this.labels) / (this.width - this.labels - 12) * (this.to - this.from);
  }

  showAll() {
    [this.from, this.to] = [this.player.begin, Math.max(this.player.end, this.player.begin + 1)];
    this.isDirty = true;
  }

  // Show `factor` times as much time; `time` stays where it is on the screen.
  zoom(factor, time) {
    const {begin, end} = this.player, all = Math.max(end - begin, 1);
    const length = Math.min(Math.max((this.to - this.from) * factor, 1000), all);
    const share = (time - this.from) / (this.to - this.from);
    this.from = Math.min(Math.max(time - share * length, begin), begin + all - length);
    this.to = this.from + length;
    this.isDirty = true;
    this.player.redraw();
  }

  // Move the window so that it contains a time. So a zoomed timeline follows the present.
  follow(time) {
    if (time >= this.from && time <= this.to) return;
    const length = this.to - this.from, {begin, end} = this.player;
    this.from = Math.min(Math.max(time - 0.1 * length, begin), Math.max(begin, end - length));
    this.to = this.from + length;
    this.isDirty = true;
  }

  wheel(event) {
    const box = this.above.getBoundingClientRect();
    if (event.ctrlKey || event.metaKey) {
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * 0.003), this.toTime(event.clientX - box.left));
    } else if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      event.preventDefault();
      const shift = (event.deltaX || event.deltaY) / (this.width - this.labels) * (this.to - this.from);
      const room = shift < 0 ? this.player.begin - this.from : this.player.end - this.to;
      const by = shift < 0 ? Math.max(shift, Math.min(room, 0)) : Math.min(shift, Math.max(room, 0));
      this.from += by;
      this.to += by;
      this.isDirty = true;
      this.player.redraw();
    }
  }

  take(event) {
    const x = event.clientX - this.above.getBoundingClientRect().left;
    const y = event.clientY - this.above.getBoundingClientRect().top;
    if (x < this.labels) {
      const row = this.rows[Math.floor((y - AXIS + this.element.scrollTop) / ROW)];
      if (row && y >= AXIS) this.player.choose(row.name === this.player.chosen ? null : row.name);
      return;
    }
    this.above.setPointerCapture(event.pointerId);
    this.isHeld = true;
    this.seek(event);
  }

  seek(event) {
    const time = this.toTime(event.clientX - this.above.getBoundingClientRect().left);
    this.player.seek(Math.min(Math.max(time, this.from), this.to));
  }

  draw() {
    const width = this.element.clientWidth, isPrint = document.documentElement.classList.contains('print');
    const height = isPrint ? AXIS + ROW * this.rows.length + 6 : this.element.clientHeight; // paper has no scroll bar
    if (width !== this.width || height !== this.height) this.isDirty = true;
    Object.assign(this, {width, height});
    for (const canvas of [this.canvas, this.above]) Object.assign(canvas.style, {width: `${width}px`, height: `${height}px`});
    this.above.style.marginTop = `-${height}px`;
    if (this.isDirty) this.drawRows();
    this.drawPresent();
  }

  drawRows() {
    const context = prepare(this.canvas, this.width, this.height);
    if (!context) return;
    this.isDirty = false;
    context.clearRect(0, 0, this.width, this.height);
    const top = this.element.scrollTop, first = Math.max(0, Math.floor((top - AXIS) / ROW));
    const last = Math.min(this.rows.length, Math.ceil((top + this.height - AXIS) / ROW));
    this.drawLines(context);
    for (let k = first; k < last; k += 1) this.drawRow(context, this.rows[k], AXIS + k * ROW - top);
    this.drawAxis(context);
  }

  drawRow(context, row, y) {
    const {runs, chosen} = this.player, height = (ROW - 8) / runs.length;
    if (row.name === chosen) {
      context.fillStyle = COLOURS.line;
      context.fillRect(0, y, this.width, ROW);
    }
    context.font = `${row.name === chosen ? '600 ' : ''}12px ${FONT}`;
    context.textBaseline = 'middle';
    context.fillStyle = COLOURS.ink;
    context.fillText(cut(context, row.name, this.labels - 18), 10, y + ROW / 2);
    runs.forEach((run, k) => {
      if (row.places[k] < 0) return;
      const at = y + 4 + k * height, high = height - (runs.length > 1 ? 1 : 0);
      if (run.rows[row.places[k]].robot) this.drawSpans(context, run, row.places[k], at, high);
      else this.drawTicks(context, run, row.places[k], at, high);
    });
  }

  drawSpans(context, run, row, y, height) {
    const [x0, x1] = [this.toX(Math.max(run.begin, this.from)), this.toX(Math.min(run.end, this.to))];
    context.fillStyle = COLOURS.idle;
    if (x1 > x0) context.fillRect(x0, y + height / 2 - 1, x1 - x0, 2);
    const end = run.span_first[row + 1];
    const shares = new Map(); // pixel: share of each state
    for (let k = upperBound(run.span_end, this.from, run.span_first[row], end);
      k < end && run.span_begin[k] < this.to; k += 1) {
      const left = Math.max(this.toX(run.span_begin[k]), this.labels);
      const right = Math.min(this.toX(run.span_end[k]), this.width - 12);
      if (right - left >= NARROW) {
        context.fillStyle = COLOURS[STATES[run.span_state[k]].name];
        context.fillRect(left, y, Math.max(right - left - 0.5, 1), height);
      } else {
        for (let pixel = Math.floor(left); pixel < right; pixel += 1) {
          if (!shares.has(pixel)) shares.set(pixel, new Float64Array(STATES.length));
          shares.get(pixel)[run.span_state[k]] += Math.min(right, pixel + 1) - Math.max(left, pixel);
        }
      }
    }
    for (const [pixel, lengths] of shares) this.drawShares(context, run, pixel, lengths, y, height);
    this.drawFailures(context, run, row, y, height);
  }

  drawShares(context, run, pixel, lengths, y, height) {
    let bottom = y + height;
    lengths.forEach((length, state) => {
      if (!length) return;
      const high = Math.max(Math.min(length, 1) * height, 1.5);
      context.fillStyle = COLOURS[STATES[state].name];
      context.fillRect(pixel, Math.max(bottom - high, y), 1, Math.min(high, bottom - y));
      bottom -= high;
    });
  }

  drawFailures(context, run, row, y, height) {
    const end = run.failure_first[row + 1];
    let drawn = -9;
    context.fillStyle = COLOURS.failed;
    for (let k = upperBound(run.failure_time, this.from - 1, run.failure_first[row], end);
      k < end && run.failure_time[k] <= this.to; k += 1) {
      const x = this.toX(run.failure_time[k]);
      if (x - drawn < 1) continue;
      context.fillRect(x - 1, y - 2, 2, height + 4);
      drawn = x;
    }
  }

  drawTicks(context, run, row, y, height) {
    const end = run.tick_first[row + 1];
    let k = upperBound(run.tick_time, this.from - 1, run.tick_first[row], end);
    context.fillStyle = COLOURS.muted;
    while (k < end && run.tick_time[k] <= this.to) { // one step per pixel, however many ticks are in it
      const pixel = Math.floor(this.toX(run.tick_time[k]));
      const next = upperBound(run.tick_time, this.toTime(pixel + 1) - 1e-3, k, end);
      const high = height * Math.min(1, 0.4 + 0.15 * Math.log2(Math.max(next - k, 1)));
      context.fillRect(pixel, y + height - high, 1, high);
      k = Math.max(next, k + 1);
    }
  }

  get step() {
    return niceStep((this.to - this.from) / NS_PER_S * 84 / Math.max(this.width - this.labels, 84)); // s
  }

  // [x, time in s] of the marks of the axis
  * marks() {
    const {step} = this;
    for (let k = Math.ceil(this.from / NS_PER_S / step); k * step * NS_PER_S <= this.to; k += 1) {
      yield [Math.round(this.toX(k * step * NS_PER_S)), k * step];
    }
  }

  drawLines(context) {
    context.fillStyle = COLOURS.line;
    for (const [x] of this.marks()) context.fillRect(x, AXIS - 6, 1, this.height);
  }

  drawAxis(context) {
    context.fillStyle = COLOURS.panel;
    context.fillRect(0, 0, this.width, AXIS - 2);
    context.font = `12px ${FONT}`;
    context.textBaseline = 'middle';
    context.fillStyle = COLOURS.muted;
    const digits = Math.max(0, -Math.floor(Math.log10(this.step) + 1e-9));
    for (const [x, time] of this.marks()) {
      const text = `${grouped(time.toFixed(digits))} s`, half = context.measureText(text).width / 2;
      context.fillText(text, Math.min(x - half, this.width - 2 * half - 4), AXIS / 2 - 3);
    }
  }

  drawPresent() {
    const context = prepare(this.above, this.width, this.height);
    if (!context) return;
    context.clearRect(0, 0, this.width, this.height);
    const {difference, time} = this.player;
    if (difference && difference.time >= this.from && difference.time <= this.to) {
      context.fillStyle = COLOURS.failed;
      const x = Math.round(this.toX(difference.time));
      context.fillRect(x - 2, AXIS - 6, 4, this.height); // wider than the line of the present
      trace(context, [[x - 8, AXIS - 18], [x + 8, AXIS - 18], [x, AXIS - 4]]);
      context.fill();
    }
    if (time < this.from || time > this.to) return;
    context.fillStyle = COLOURS.accent;
    const x = Math.round(this.toX(time));
    context.fillRect(x - 1, AXIS - 8, 2, this.height);
    context.beginPath();
    context.arc(x, AXIS - 8, 4.5, 0, 2 * Math.PI);
    context.fill();
  }
}
