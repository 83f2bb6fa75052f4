// The map from above with one run's robots. All views of a page share one camera.
class Camera {
  constructor(box) {
    this.box = box;
    this.isFitted = true;
  }

  fit(width, height) {
    const [x0, y0, x1, y1] = this.box;
    const [side, top, bottom] = [28, 34, 46]; // px; margins for names and the scale
    this.scale = Math.min((width - 2 * side) / Math.max(x1 - x0, 1), (height - top - bottom) / Math.max(y1 - y0, 1));
    this.scale = Math.max(this.scale, 1e-6); // px/m
    [this.x, this.y] = [(x0 + x1) / 2, (y0 + y1) / 2 - (bottom - top) / 2 / this.scale];
  }

  zoom(factor, east, north) {
    this.isFitted = false;
    const scale = Math.min(Math.max(this.scale * factor, 1e-6), 1e5);
    this.x = east + (this.x - east) * this.scale / scale;
    this.y = north + (this.y - north) * this.scale / scale;
    this.scale = scale;
  }
}

class Ground {
  constructor(packed) {
    const {about} = packed;
    Object.assign(this, about, {cells: packed.columns.cells});
    this.picture = document.createElement('canvas');
    Object.assign(this.picture, {width: about.columns, height: about.rows});
  }

  paint() {
    const context = this.picture.getContext('2d');
    const image = context.createImageData(this.picture.width, this.picture.height);
    const [wall, floor, unknown] = [COLOURS.wall, COLOURS.floor, COLOURS.unknown].map(rgb);
    const {width, height} = this.picture;
    for (let row = 0; row < height; row += 1) {
      for (let column = 0; column < width; column += 1) {
        const cell = this.cells[(height - 1 - row) * width + column], at = 4 * (row * width + column);
        const share = cell / 100;
        for (let k = 0; k < 3; k += 1) {
          image.data[at + k] = cell === 255 ? unknown[k] : floor[k] + share * (wall[k] - floor[k]);
        }
        image.data[at + 3] = 255;
      }
    }
    context.putImageData(image, 0, 0);
  }
}

class MapView {
  constructor(figure, run, player) {
    this.canvas = figure.querySelector('canvas');
    [this.readout, this.orders] = figure.querySelectorAll('output');
    Object.assign(this, {figure, run, player, grip: new Map()});
    this.robots = new RobotView(run, this);
    this.world = new WorldView(player.world, this);
    this.canvas.addEventListener('pointerdown', (event) => this.take(event));
    this.canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const name of ['pointerup', 'pointercancel']) {
      this.canvas.addEventListener(name, (event) => this.release(event));
    }
    this.canvas.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
  }

  get camera() {
    return this.player.camera;
  }

  world(event) {
    const box = this.canvas.getBoundingClientRect(), camera = this.camera;
    return [camera.x + (event.clientX - box.left - box.width / 2) / camera.scale,
            camera.y - (event.clientY - box.top - box.height / 2) / camera.scale];
  }

  wheel(event) {
    event.preventDefault();
    this.camera.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), ...this.world(event));
    this.player.redraw();
  }

  take(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.grip.set(event.pointerId, [event.clientX, event.clientY]);
    this.pressed = [event.clientX, event.clientY];
  }

  move(event) {
    if (!this.grip.has(event.pointerId)) return;
    const [x, y] = this.grip.get(event.pointerId), camera = this.camera;
    const other = [...this.grip].find(([id]) => id !== event.pointerId);
    camera.isFitted = false;
    if (other) { // two fingers
      const distance = (a, b) => Math.hypot(a - other[1][0], b - other[1][1]);
      camera.zoom(distance(event.clientX, event.clientY) / Math.max(distance(x, y), 1), ...this.world(event));
    } else {
      camera.x -= (event.clientX - x) / camera.scale;
      camera.y += (event.clientY - y) / camera.scale;
    }
    this.grip.set(event.pointerId, [event.clientX, event.clientY]);
    this.player.redraw();
  }

  release(event) {
    this.grip.delete(event.pointerId);
    const isClick = this.pressed && Math.hypot(event.clientX - this.pressed[0], event.clientY - this.pressed[1]) < 4;
    this.pressed = null;
    if (isClick && event.type === 'pointerup') this.choose(...this.world(event));
  }

  choose(x, y) {
    let nearest = null, least = 18 / this.camera.scale;
    for (let robot = 0; robot < this.run.robots; robot += 1) {
      const pose = this.run.poseAt(robot, this.player.time);
      const distance = pose ? Math.hypot(pose.x - x, pose.y - y) : Infinity;
      if (distance < least) [nearest, least] = [this.run.rows[robot].name, distance];
    }
    if (nearest === null) this.player.chooseThing(this.player.world.nearest(x, y, 10 / this.camera.scale));
    else this.player.choose(nearest);
  }

  draw() {
    const {clientWidth: width, clientHeight: height} = this.figure;
    const context = prepare(this.canvas, width, height);
    if (context) this.drawOn(context, width, height);
  }

  drawOn(context, width, height) {
    const camera = this.camera;
    if (camera.isFitted) camera.fit(width, height);
    this.toX = (x) => width / 2 + (x - camera.x) * camera.scale;
    this.toY = (y) => height / 2 - (y - camera.y) * camera.scale;
    context.fillStyle = this.player.ground ? COLOURS.unknown : COLOURS.panel;
    context.fillRect(0, 0, width, height);
    if (this.player.ground) this.drawGround(context, this.player.ground);
    else this.drawGrid(context, width, height);
    const poses = [];
    for (let robot = 0; robot < this.run.robots; robot += 1) poses.push(this.run.poseAt(robot, this.player.time));
    const uses = this.player.world.usesAt(this.run, this.player.time);
    const limits = this.player.world.limitsAt(this.run, this.player.time);
    this.world.draw(context, uses, limits);
    this.drawLinks(context, poses);
    this.run.hosts.forEach((host) => this.drawHost(context, host));
    for (const draw of ['drawTrail', 'drawWay', 'drawRobot']) {
      poses.forEach((pose, robot) => pose && this.robots[draw](context, robot, pose));
    }
    this.robots.drawOrders(context);
    this.write(context, poses, width, height);
    this.drawScale(context, height);
    this.tell(poses, uses, limits);
  }

  // Write names as far as there is room: first where robots wait and which ones, then things with counts, then others.
  write(context, poses, width, height) {
    const labels = new Labels(context, width, height), size = this.robots.size;
    labels.take([0, height - 38, 90, height]); // the scale
    for (const pose of poses) {
      if (pose) {
        const [x, y] = [this.toX(pose.x), this.toY(pose.y)];
        labels.take([x - size, y - size, x + size, y + size]);
      }
    }
    const writeThings = this.world.write(labels, this.player.chosenThing);
    writeThings(0);
    this.robots.write(labels, poses, true);
    writeThings(1);
    this.robots.write(labels, poses, false);
    writeThings(2);
    for (const {name, x, y} of this.run.hosts) labels.write(name, this.toX(x), this.toY(y), {isKept: true});
  }

  drawGround(context, ground) {
    const [x, y, yaw] = ground.origin, cell = this.camera.scale * ground.resolution;
    context.save();
    context.translate(this.toX(x), this.toY(y));
    context.rotate(-yaw);
    context.imageSmoothingEnabled = cell < 1;
    context.drawImage(ground.picture, 0, -ground.rows * cell, ground.columns * cell, ground.rows * cell);
    context.restore();
  }

  drawGrid(context, width, height) {
    const step = niceStep(64 / this.camera.scale), camera = this.camera;
    context.strokeStyle = COLOURS.line;
    context.lineWidth = 1;
    context.beginPath();
    const [left, bottom] = [camera.x - width / 2 / camera.scale, camera.y - height / 2 / camera.scale];
    for (let k = Math.ceil(left / step); this.toX(k * step) < width; k += 1) {
      const x = Math.round(this.toX(k * step)) + 0.5;
      context.moveTo(x, 0);
      context.lineTo(x, height);
    }
    for (let k = Math.ceil(bottom / step); this.toY(k * step) > 0; k += 1) {
      const y = Math.round(this.toY(k * step)) + 0.5;
      context.moveTo(0, y);
      context.lineTo(width, y);
    }
    context.stroke();
  }

  // The links of the radio that are up. They are dashed, because trails are lines, too.
  drawLinks(context, poses) {
    context.strokeStyle = COLOURS.accent;
    context.lineWidth = 1.5;
    context.globalAlpha = 0.55;
    context.setLineDash([2, 4]);
    context.beginPath();
    for (const [one, other] of this.run.linksAt(this.player.time, poses)) {
      context.moveTo(this.toX(one.x), this.toY(one.y));
      context.lineTo(this.toX(other.x), this.toY(other.y));
    }
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }

  // A host of the radio that stands still.
  drawHost(context, {x, y}) {
    context.lineWidth = 1.5;
    context.strokeStyle = COLOURS.accent;
    context.fillStyle = COLOURS.panel;
    context.fillRect(this.toX(x) - 5, this.toY(y) - 5, 10, 10);
    context.strokeRect(this.toX(x) - 5, this.toY(y) - 5, 10, 10);
  }

  drawScale(context, height) {
    const step = niceStep(48 / this.camera.scale), length = step * this.camera.scale;
    context.font = `12px ${FONT}`;
    context.textBaseline = 'alphabetic';
    const text = step >= 1000 ? `${step / 1000} km` : `${grouped(String(+step.toPrecision(3)))} m`;
    const wide = Math.max(length, context.measureText(text).width);
    context.globalAlpha = 0.85;
    context.fillStyle = COLOURS.panel;
    context.fillRect(10, height - 34, wide + 12, 26);
    context.globalAlpha = 1;
    context.fillStyle = COLOURS.ink;
    context.fillText(text, 16, height - 20);
    context.fillRect(16, height - 15, length, 2);
  }

  // Show in words what the chosen robot does, or which robots are in the chosen thing; and the state of the orders.
  tell(poses, uses, limits) {
    const {run} = this, {chosen, chosenThing, world, time} = this.player;
    const robot = run.rows.findIndex((row) => row.robot && row.name === chosen);
    const text = robot >= 0 ? this.robots.words(robot, poses[robot]) : chosenThing === null ? ''
      : world.words(world.things[chosenThing], uses.get(chosenThing), (number) => run.rows[number].name,
        limits.get(chosenThing));
    if (this.readout.textContent !== text) this.readout.textContent = text;
    const orders = run.ordersAt(time);
    if (this.orders.textContent !== orders) this.orders.textContent = orders;
  }
}
