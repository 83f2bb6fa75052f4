// The player: the present time, and the views that show it.
const FONT = 'system-ui, -apple-system, "Segoe UI", "Liberation Sans", "DejaVu Sans", sans-serif';
const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];
const SLIDER_STEPS = 10000, WATCHED_S = 30; // wall s that a run takes at the initial speed

class Player {
  constructor(runs, ground, world, {box, difference}) {
    Object.assign(this, {runs, ground, world, difference, chosen: null, chosenThing: null, showsTrails: true,
                         isPlaying: false});
    this.begin = Math.min(...runs.map((run) => run.begin));
    this.end = Math.max(...runs.map((run) => run.end));
    this.time = this.begin;
    this.camera = new Camera(box || [0, 0, 10, 10]);
    this.find();
    this.timeline = new Timeline(document.querySelector('.timeline'), this);
    this.events = new EventList(document.querySelector('.events'), this);
    this.maps = [...document.querySelectorAll('.map')].map((figure, k) => new MapView(figure, runs[k], this));
    this.offerSpeeds();
    this.listen();
    document.documentElement.classList.toggle('print', this.isPrint);
    this.recolour();
    this.seek(this.ofAddress());
  }

  find() {
    for (const name of ['play', 'previous', 'next', 'slider', 'speed', 'now', 'trails', 'fit', 'picture', 'closer',
                        'wider', 'all']) {
      this[name] = document.getElementById(name);
    }
  }

  // The time in the page's address, such as #t=12.5 [s]
  ofAddress() {
    const found = /^#t=([0-9.]+)$/.exec(window.location.hash);
    return found && Number.isFinite(+found[1]) ? Math.round(+found[1] * NS_PER_S) : this.begin;
  }

  offerSpeeds() {
    const wanted = (this.end - this.begin) / NS_PER_S / WATCHED_S;
    const usual = SPEEDS.find((speed) => speed >= wanted) || SPEEDS[SPEEDS.length - 1];
    for (const speed of SPEEDS) this.speed.add(new Option(`${grouped(String(speed))}×`, speed, false, speed === usual));
  }

  listen() {
    this.play.addEventListener('click', () => this.toggle());
    this.previous.addEventListener('click', () => this.events.step(-1));
    this.next.addEventListener('click', () => this.events.step(1));
    this.slider.addEventListener('input', () => this.seek(
      this.begin + this.slider.value / SLIDER_STEPS * (this.end - this.begin)));
    this.trails.addEventListener('change', () => { this.showsTrails = this.trails.checked; this.redraw(); });
    this.fit.addEventListener('click', () => { this.camera.isFitted = true; this.redraw(); });
    this.picture.addEventListener('click', () => savePicture(this));
    this.closer.addEventListener('click', () => this.timeline.zoom(0.5, this.time));
    this.wider.addEventListener('click', () => this.timeline.zoom(2, this.time));
    this.all.addEventListener('click', () => { this.timeline.showAll(); this.redraw(); });
    const jump = document.getElementById('jump');
    if (jump) jump.addEventListener('click', () => this.jump());
    for (const button of document.querySelectorAll('[data-list]')) {
      button.addEventListener('click', () => this.list(+button.dataset.list));
    }
    document.addEventListener('keydown', (event) => this.key(event));
    window.addEventListener('hashchange', () => this.seek(this.ofAddress()));
    for (const [name, isPrint] of [['beforeprint', true], ['afterprint', this.isPrint]]) {
      window.addEventListener(name, () => this.printed(isPrint));
    }
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.recolour());
    new ResizeObserver(() => { this.events.update(); this.redraw(); }).observe(document.querySelector('main'));
  }

  get isPrint() {
    return new URLSearchParams(window.location.search).get('style') === 'print';
  }

  // Draw at once in the style for print (dark on white, as SVG), or leave that style.
  printed(isPrint) {
    document.documentElement.classList.toggle('print', isPrint);
    this.recolour();
    this.draw();
  }

  recolour() {
    readColours();
    if (this.ground) this.ground.paint();
    this.timeline.isDirty = true;
    this.redraw();
  }

  key(event) {
    if (event.altKey || event.ctrlKey || event.metaKey || event.target.closest('input[type=search], select')) return;
    const step = (this.timeline.to - this.timeline.from) / (event.shiftKey ? 10 : 100);
    const actions = {
      ' ': () => this.toggle(), Home: () => this.seek(this.begin), End: () => this.seek(this.end),
      ArrowLeft: () => this.seek(this.time - step), ArrowRight: () => this.seek(this.time + step),
      ',': () => this.events.step(-1), '.': () => this.events.step(1),
      '[': () => this.faster(-1), ']': () => this.faster(1), d: () => this.jump(), t: () => this.trails.click(),
      f: () => this.fit.click(), p: () => this.picture.click(), '+': () => this.closer.click(), '-': () => this.wider.click(), 0: () => this.all.click(),
      b: () => this.events.copier.click(), '/': () => this.events.search.focus(), Escape: () => this.choose(null),
    };
    if (!Object.hasOwn(actions, event.key) || (event.key === ' ' && event.target.closest('button, summary'))) return;
    event.preventDefault();
    actions[event.key]();
  }

  faster(by) {
    const place = this.speed.selectedIndex + by;
    if (place >= 0 && place < SPEEDS.length) this.speed.selectedIndex = place;
  }

  // Go to the first difference of the two runs.
  jump() {
    if (!this.difference) return;
    const {time, event} = this.difference, {events} = this;
    this.stop();
    this.seek(time);
    if (event >= 0 && event < events.run.events && events.run.event_time[event] === time) events.pick(events.lineOf(event));
  }

  // List the events of another run.
  list(place) {
    for (const button of document.querySelectorAll('[data-list]')) {
      button.setAttribute('aria-pressed', +button.dataset.list === place);
    }
    this.events.show(place);
  }

  // Choose a zone, a lane or a place by its number, and no robot; or nothing.
  chooseThing(number) {
    this.choose(null);
    this.chosenThing = number;
  }

  choose(name) {
    this.chosen = name;
    this.chosenThing = null;
    this.timeline.isDirty = true;
    this.redraw();
  }

  toggle() {
    if (this.isPlaying) this.stop();
    else this.start();
  }

  start() {
    if (this.time >= this.end) this.seek(this.begin);
    this.isPlaying = true;
    this.last = null;
    this.showPlay();
    requestAnimationFrame((wall) => this.advance(wall));
  }

  stop() {
    this.isPlaying = false;
    this.showPlay();
  }

  showPlay() {
    this.play.setAttribute('aria-label', this.isPlaying ? 'Pause' : 'Play');
    this.play.title = `${this.isPlaying ? 'Pause' : 'Play'} (space)`;
    document.body.classList.toggle('playing', this.isPlaying);
  }

  advance(wall) {
    if (!this.isPlaying) return;
    const passed = this.last === null ? 0 : Math.min(wall - this.last, 250); // ms; a page in the background stands still
    this.last = wall;
    this.seek(this.time + passed * 1e6 * this.speed.value);
    if (this.time >= this.end) this.stop();
    else requestAnimationFrame((next) => this.advance(next));
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.begin), this.end);
    this.slider.value = this.end > this.begin ? (this.time - this.begin) / (this.end - this.begin) * SLIDER_STEPS : 0;
    this.now.textContent = seconds(this.time);
    this.slider.setAttribute('aria-valuetext', `${seconds(this.time)} s`);
    this.timeline.follow(this.time);
    this.events.update();
    this.redraw();
  }

  // Draw in the next frame, once, however often this is called.
  redraw() {
    if (this.isAwaited) return;
    this.isAwaited = true;
    requestAnimationFrame(() => {
      this.isAwaited = false;
      this.draw();
    });
  }

  draw() {
    this.maps.forEach((view) => view.draw());
    this.timeline.draw();
  }
}

async function open() {
  const texts = [...document.querySelectorAll('script[data-run]')].map((element) => element.textContent);
  const packedMap = document.getElementById('packed-map');
  const about = JSON.parse(document.getElementById('about').textContent);
  const runs = (await Promise.all(texts.map(unpack))).map((unpacked) => new Run(unpacked));
  const ground = packedMap ? new Ground(await unpack(packedMap.textContent)) : null;
  const world = new World(await unpack(document.getElementById('packed-world').textContent));
  for (const element of document.querySelectorAll('script[data-run], #packed-map, #packed-world')) element.remove();
  window.replay = new Player(runs, ground, world, about);
  document.body.classList.add('ready');
}

open().catch((error) => {
  document.getElementById('failure').textContent = `This page cannot be shown: ${error.message}`;
  throw error;
});
