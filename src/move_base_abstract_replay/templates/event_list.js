// The list of events. Only the rows in sight exist as elements.
const EVENT_ROW = 26, MOST_PIXELS = 15e6; // browsers know no taller elements; a longer list scrolls in larger steps

class EventList {
  constructor(element, player) {
    this.element = element;
    this.scroller = element.querySelector('.scroller');
    this.spacer = element.querySelector('.spacer');
    this.count = element.querySelector('.count');
    this.search = element.querySelector('input[type=search]');
    this.debug = element.querySelector('.debug');
    [this.copier, this.command] = this.debug.children;
    this.copier.addEventListener('click', () => this.copy());
    Object.assign(this, {player, pool: [], picked: null, indices: null});
    this.scroller.addEventListener('scroll', () => this.draw());
    this.scroller.addEventListener('keydown', (event) => this.key(event));
    this.search.addEventListener('input', () => {
      clearTimeout(this.waits);
      this.waits = setTimeout(() => this.filter(), 150);
    });
    this.show(0);
  }

  // List the events of a run of the page.
  show(place) {
    this.run = this.player.runs[place];
    this.fitColumns();
    this.filter();
  }

  // Make the columns of times and names as wide as their longest texts, within limits.
  fitColumns() {
    const context = document.createElement('canvas').getContext('2d');
    context.font = `600 13px ${FONT}`;
    const longest = (texts) => texts.reduce((most, text) => Math.max(most, context.measureText(text).width), 0);
    const named = longest(this.run.names.slice(0, 1000)), share = this.element.clientWidth * 0.22;
    this.scroller.style.setProperty('--times', `${Math.ceil(longest([seconds(this.run.end)])) + 2}px`);
    this.scroller.style.setProperty('--names', `${Math.ceil(Math.max(48, Math.min(named, share)))}px`);
  }

  filter() {
    const run = this.run, wanted = this.search.value.trim().toLowerCase();
    this.indices = wanted ? this.matching(run, wanted) : null;
    this.length = this.indices ? this.indices.length : run.events;
    const all = grouped(String(run.events));
    this.count.textContent = wanted ? `${grouped(String(this.length))} of ${all}` : `${all}`;
    this.spacer.style.height = `${Math.min(this.length * EVENT_ROW, MOST_PIXELS)}px`;
    this.picked = null;
    this.update();
  }

  matching(run, wanted) {
    const has = (text) => text.toLowerCase().includes(wanted);
    const [names, kinds] = [run.names.map(has), run.kinds.map(has)], found = [];
    for (let k = 0; k < run.events; k += 1) {
      if (names[run.event_name[k]] || kinds[run.event_kind[k]] || has(run.event_values[k])) found.push(k);
    }
    return Uint32Array.from(found);
  }

  at(line) {
    return this.indices ? this.indices[line] : line;
  }

  // The line of an event, or of the last one before it that is in the list; -1 before the first.
  lineOf(event) {
    return this.indices ? upperBound(this.indices, event, 0, this.length) - 1 : event;
  }

  get current() {
    if (this.picked !== null && this.run.event_time[this.at(this.picked)] === this.player.time) return this.picked;
    return this.lineOf(this.run.eventsUntil(this.player.time) - 1);
  }

  get most() {
    return Math.max(this.spacer.offsetHeight - this.scroller.clientHeight, 0);
  }

  // The line at the upper edge, as a number with a fraction.
  get top() {
    const lines = this.length - this.scroller.clientHeight / EVENT_ROW;
    return this.most ? this.scroller.scrollTop / this.most * Math.max(lines, 0) : 0;
  }

  // Scroll so that the current line is in sight.
  center() {
    const seen = this.scroller.clientHeight / EVENT_ROW, {current, top} = this;
    if (current >= top + 1 && current <= top + seen - 2) return;
    const lines = Math.max(this.length - seen, 1);
    this.scroller.scrollTop = Math.min(Math.max((current - seen / 3) / lines, 0), 1) * this.most;
  }

  pick(line) {
    this.picked = Math.min(Math.max(line, 0), this.length - 1);
    if (this.length) this.player.seek(this.run.event_time[this.at(this.picked)]);
  }

  // Go to the next event (1) or the one before (-1).
  step(by) {
    const line = this.current + by;
    if (line >= 0 && line < this.length) this.pick(line);
  }

  key(event) {
    const by = {ArrowDown: 1, ArrowUp: -1}[event.key];
    if (!by || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    this.step(by);
  }

  update() {
    this.command.value = this.run.debugCommand(this.player.time);
    this.debug.hidden = !this.command.value;
    this.copier.textContent = 'Debug here';
    this.center();
    this.draw();
  }

  // Copy the command that leads here in the debugger. The clipboard's own interface is missing in some pages of files.
  copy() {
    this.command.select();
    if (document.execCommand('copy')) this.copier.textContent = 'Copied';
  }

  draw() {
    const {top, current} = this, first = Math.floor(top);
    const wanted = Math.min(Math.ceil(this.scroller.clientHeight / EVENT_ROW) + 1, this.length);
    while (this.pool.length < wanted) this.pool.push(this.makeRow());
    const offset = this.scroller.scrollTop - (top - first) * EVENT_ROW;
    this.pool.forEach((row, k) => {
      const line = first + k;
      row.element.hidden = k >= wanted || line >= this.length;
      if (!row.element.hidden) this.fill(row, line, offset + k * EVENT_ROW, line === current);
    });
  }

  makeRow() {
    const element = document.createElement('div');
    element.className = 'event';
    element.setAttribute('role', 'option');
    const parts = ['time', 'name', 'what'].map((name) => {
      const part = document.createElement('span');
      part.className = name;
      element.append(part);
      return part;
    });
    const row = {element, parts, line: -1, event: -1};
    element.addEventListener('click', () => this.pick(row.line));
    this.scroller.append(element);
    return row;
  }

  fill(row, line, y, isCurrent) {
    const event = this.at(line), {run} = this;
    row.line = line;
    row.element.style.transform = `translateY(${y}px)`;
    row.element.classList.toggle('current', isCurrent);
    row.element.setAttribute('aria-selected', isCurrent);
    if (row.event === event && row.run === run) return;
    Object.assign(row, {event, run});
    const texts = [seconds(run.event_time[event]), run.names[run.event_name[event]], eventText(run, event)];
    row.parts.forEach((part, k) => { part.textContent = texts[k]; });
    row.element.title = texts.join('  ');
    row.element.dataset.kind = run.kinds[run.event_kind[event]];
  }
}
