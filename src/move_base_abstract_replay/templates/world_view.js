// Draws the world. Things that are full, or for which robots wait, stand out.
const NAMED_FROM = 26; // px/m; from this scale on, places and zones without a capacity show their names, too

class WorldView {
  constructor(world, view) {
    Object.assign(this, {world, view});
  }

  draw(context, uses, limits) {
    Object.assign(this, {uses, limits});
    const {things} = this.world;
    things.forEach((thing, k) => thing.kind === 'zone' && this.drawZone(context, thing, uses.get(k)));
    things.forEach((thing, k) => thing.kind === 'lane' && this.drawLane(context, thing, uses.get(k)));
    this.drawNodes(context);
    things.forEach((thing, k) => thing.kind === 'node' && this.drawSpots(context, thing, uses.get(k)));
    things.forEach((thing, k) => thing.kind === 'place' && this.drawPlace(context, thing, uses.get(k)));
  }

  colour(thing, use) {
    if (use && use.waiting.length) return COLOURS.waiting;
    if (this.world.isFull(thing, use)) return COLOURS.full;
    if (use && use.inside.length) return COLOURS.working;
    return thing.charger ? COLOURS.charging : COLOURS.muted;
  }

  onMap(points) {
    return points.map(([x, y]) => [this.view.toX(x), this.view.toY(y)]);
  }

  drawZone(context, thing, use) {
    const colour = this.colour(thing, use);
    trace(context, this.onMap(thing.points));
    context.fillStyle = context.strokeStyle = colour;
    context.globalAlpha = use ? 0.2 : 0.1;
    context.fill();
    context.globalAlpha = 0.9;
    context.lineWidth = 1.25;
    context.stroke();
    context.globalAlpha = 1;
    if (thing.charger) this.drawBolt(context, thing, colour);
  }

  // A charger has a flash of lightning in its upper left corner.
  drawBolt(context, thing, colour) {
    const [left, top] = [Math.min(...thing.points.map(([x]) => x)), Math.max(...thing.points.map(([, y]) => y))];
    const size = Math.min(12, Math.max(6, 0.5 * this.view.camera.scale));
    const [x, y] = [this.view.toX(left) + 0.7 * size, this.view.toY(top) + 0.85 * size];
    trace(context, [[0.1, -0.6], [-0.35, 0.1], [-0.02, 0.1], [-0.12, 0.6], [0.35, -0.12], [0.02, -0.12]].map(
      ([dx, dy]) => [x + dx * size, y + dy * size]));
    context.fillStyle = colour;
    context.fill();
  }

  drawLane(context, thing, use) {
    const {scale} = this.view.camera;
    trace(context, this.onMap(thing.points), false);
    context.lineJoin = 'round';
    context.lineCap = 'round';
    context.strokeStyle = use ? this.colour(thing, use) : COLOURS.lane;
    context.globalAlpha = use ? 0.85 : 1;
    context.lineWidth = (use ? 1.6 : 1) * Math.min(3.5, Math.max(1, 0.11 * scale)) * (thing.capacity === null ? 0.75 : 1);
    context.stroke();
    context.globalAlpha = 1;
    context.lineCap = 'butt';
    if (thing.one_way) this.drawArrow(context, thing, context.strokeStyle);
  }

  drawArrow(context, thing, colour) {
    const {at: [[ax, ay], [bx, by]], length} = longestPiece(thing.points), {view} = this, {scale} = view.camera;
    const size = Math.min(7, Math.max(3, 0.24 * scale));
    if (length * scale < 3 * size) return;
    const course = Math.atan2(by - ay, bx - ax), [x, y] = [view.toX(0.4 * ax + 0.6 * bx), view.toY(0.4 * ay + 0.6 * by)];
    const point = (along, aside) => [x + size * (along * Math.cos(course) + aside * Math.sin(course)),
                                     y - size * (along * Math.sin(course) - aside * Math.cos(course))];
    trace(context, [point(1, 0), point(-0.8, 0.75), point(-0.8, -0.75)]);
    context.fillStyle = colour;
    context.fill();
  }

  drawNodes(context) {
    const {view} = this, size = Math.min(3, 0.09 * view.camera.scale);
    if (size < 1) return;
    context.fillStyle = COLOURS.node;
    for (const [, x, y] of this.world.nodes) {
      context.beginPath();
      context.arc(view.toX(x), view.toY(y), size, 0, 2 * Math.PI);
      context.fill();
    }
  }

  // A node with a capacity has a ring where a robot stands: around it, or at each of its spots, with lines to these.
  drawSpots(context, thing, use) {
    const [node, ...spots] = this.onMap(thing.points), size = Math.min(9, Math.max(2.5, 0.3 * this.view.camera.scale));
    context.strokeStyle = use ? this.colour(thing, use) : COLOURS.node;
    context.lineWidth = use ? 2 : 1;
    for (const [x, y] of spots.length ? spots : [node]) {
      context.beginPath();
      context.moveTo(...node);
      if (spots.length) context.lineTo(x, y);
      context.moveTo(x + size, y);
      context.arc(x, y, size, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  // A parking place has the letter P.
  drawPlace(context, thing, use) {
    const [[x, y]] = thing.points, {view} = this, size = Math.min(9, Math.max(2.5, thing.reach * view.camera.scale * 0.7));
    context.fillStyle = COLOURS.panel;
    context.strokeStyle = use ? this.colour(thing, use) : COLOURS.place;
    context.lineWidth = use ? 2.5 : 1.25;
    context.fillRect(view.toX(x) - size, view.toY(y) - size, 2 * size, 2 * size);
    context.strokeRect(view.toX(x) - size, view.toY(y) - size, 2 * size, 2 * size);
    if (!thing.parking || size < 5) return;
    Object.assign(context, {fillStyle: context.strokeStyle, font: `600 ${Math.round(1.6 * size)}px ${FONT}`,
                            textAlign: 'center', textBaseline: 'middle'});
    context.fillText('P', view.toX(x), view.toY(y));
    context.textAlign = 'left';
  }

  // Return a function that writes the signs of one rank: 0 for the chosen thing and those with waiting robots, 1 for
  // others in use with a capacity, 2 for the rest. Lanes, and nodes for one robot, are in rank 0 only; in rank 2, things
  // without a capacity have names only from a certain scale on.
  write(labels, chosen) {
    const {things} = this.world, isNear = this.view.camera.scale >= NAMED_FROM, order = [[], [], []];
    things.forEach((thing, k) => {
      const use = this.uses.get(k);
      if (k === chosen || (use && use.waiting.length)) order[0].push(k);
      else if (thing.capacity !== null && !this.world.isOneOfMany(thing) && use) order[1].push(k);
      else if (!this.world.isOneOfMany(thing) && (thing.capacity !== null || isNear || this.limits.has(k))) order[2].push(k);
    });
    return (rank) => order[rank].forEach((k) => this.writeOne(labels, k, rank, k === chosen));
  }

  writeOne(labels, k, rank, isChosen) {
    const {view} = this, thing = this.world.things[k], [x, y] = thing.middle, {scale} = view.camera;
    const withName = isChosen || (!this.world.isOneOfMany(thing) ? scale > 9 || !rank : scale > 2 * NAMED_FROM);
    const text = this.world.sign(thing, this.uses.get(k), withName, this.limits.get(k));
    if (!withName && rank > 0) return;
    const gap = Math.max(8, thing.kind === 'place' ? 0.7 * thing.reach * scale + 3 : thing.kind === 'zone' ? 0.8 * scale : 8);
    labels.write(text, view.toX(x), view.toY(y), {
      gap: Math.min(gap, 26), colour: rank === 0 ? COLOURS.alarm : COLOURS.muted, weight: rank === 0 ? '600' : '', size: 11,
      isKept: isChosen});
  }
}
