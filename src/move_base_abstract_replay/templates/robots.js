// Robots on the map: their ways, their charge, and the orders they work on. Sizes depend on the scale and the number.
const TRAIL_LEGS = 12, TRAILS = 120; // legs in the trail of one robot, and in those of all; more would hide one another
const FEW_ROBOTS = 12, MANY_ROBOTS = 200; // few have their whole names; the names of many are shown when zoomed in
const NOBODY = 2 ** 32 - 1;
const OPEN = 0;

class RobotView {
  constructor(run, view) {
    Object.assign(this, {run, view});
    this.trail = Math.max(2, Math.min(TRAIL_LEGS, Math.floor(TRAILS / Math.max(run.robots, 1))));
    const names = run.rows.slice(0, run.robots).map(({name}) => name);
    this.beginning = run.robots > FEW_ROBOTS ? commonBeginning(names).length : 0;
  }

  get player() {
    return this.view.player;
  }

  isChosen(robot) {
    return this.run.rows[robot].name === this.player.chosen;
  }

  state(robot) {
    return STATES[this.run.stateAt(robot, this.player.time)];
  }

  get size() {
    const {robots} = this.run, most = robots > MANY_ROBOTS ? 5 : robots > FEW_ROBOTS ? 8 : 9;
    const least = robots > MANY_ROBOTS ? 2.5 : robots > FEW_ROBOTS ? 3.5 : 7;
    return Math.min(most, Math.max(least, 0.42 * this.view.camera.scale));
  }

  drawTrail(context, robot, pose) {
    const {run, view} = this, {motion} = pose, isChosen = this.isChosen(robot);
    if (!this.player.showsTrails && !isChosen) return;
    const legs = isChosen ? TRAIL_LEGS : this.trail, first = Math.max(run.motion_first[robot], motion - legs);
    context.strokeStyle = isChosen ? COLOURS.accent : hue(run.rows[robot].name, robot);
    context.lineWidth = isChosen ? 3 : Math.min(2, 0.3 * this.size);
    context.lineJoin = 'round';
    context.globalAlpha = isChosen ? 0.8 : run.isUnderWay(motion, this.player.time) ? 0.55 : 0.3;
    context.beginPath();
    for (let m = first; m <= motion; m += 1) {
      const begin = run.piece_first[m], end = m === motion ? pose.piece : run.pieceAt(m, run.motion_end[m]);
      const last = m === motion ? Math.min(this.player.time, run.motion_end[m]) : run.motion_end[m];
      for (let k = begin; k <= end; k += 1) {
        const isPlaced = k === begin && (m === first || run.piece_first[m + 1] === begin + 1);
        context[isPlaced ? 'moveTo' : 'lineTo'](view.toX(run.piece_x[k]), view.toY(run.piece_y[k]));
        for (const {x, y} of run.pointsIn(k, k === end ? last : run.piece_begin_ns[k + 1])) {
          context.lineTo(view.toX(x), view.toY(y));
        }
      }
    }
    context.lineTo(view.toX(pose.x), view.toY(pose.y));
    context.stroke();
    context.globalAlpha = 1;
  }

  drawWay(context, robot, pose) {
    const {run, view} = this, {motion} = pose, isChosen = this.isChosen(robot);
    if (!run.isUnderWay(motion, this.player.time) || (run.robots > MANY_ROBOTS && !isChosen)) return;
    if (run.piece_k[pose.piece] < 0) return; // driven by velocities, it has no goal
    const last = run.piece_first[motion + 1] - 1, [x, y] = [view.toX(run.piece_x[last]), view.toY(run.piece_y[last])];
    context.strokeStyle = isChosen ? COLOURS.accent : hue(run.rows[robot].name, robot);
    context.lineWidth = isChosen ? 2 : 1.25;
    context.globalAlpha = isChosen || run.robots <= FEW_ROBOTS ? 0.85 : 0.5;
    context.setLineDash([3, 4]);
    context.beginPath();
    context.moveTo(view.toX(pose.x), view.toY(pose.y));
    for (let k = pose.piece + 1; k <= last; k += 1) context.lineTo(view.toX(run.piece_x[k]), view.toY(run.piece_y[k]));
    context.stroke();
    context.setLineDash([]);
    context.beginPath();
    context.arc(x, y, 3, 0, 2 * Math.PI);
    context.stroke();
    context.globalAlpha = 1;
  }

  drawRobot(context, robot, pose) {
    const isChosen = this.isChosen(robot), size = this.size * (isChosen ? 1.25 : 1);
    this.drawCharge(context, robot, pose, size);
    context.save();
    context.translate(this.view.toX(pose.x), this.view.toY(pose.y));
    context.rotate(-pose.yaw);
    trace(context, [[1.25, 0], [-0.85, 0.8], [-0.45, 0], [-0.85, -0.8]].map((at) => at.map((one) => one * size)));
    context.restore();
    context.lineJoin = 'round';
    context.lineWidth = Math.min(4, 0.5 * size);
    context.strokeStyle = COLOURS.panel;
    context.stroke();
    context.fillStyle = COLOURS[this.state(robot).name];
    context.fill();
    context.lineWidth = isChosen ? 2 : 1;
    context.strokeStyle = isChosen ? COLOURS.accent : COLOURS.ink;
    context.stroke();
  }

  // The charge is a ring around the robot; its filled part is the share of charge of the battery.
  drawCharge(context, robot, pose, size) {
    const share = this.run.chargeAt(robot, this.player.time);
    if (share === null || (this.run.robots > MANY_ROBOTS && !this.isChosen(robot))) return;
    const [x, y, radius] = [this.view.toX(pose.x), this.view.toY(pose.y), 1.25 * size + Math.min(3, 0.45 * size)];
    context.lineWidth = Math.max(1.75, 0.3 * size);
    const level = this.player.world.levelOf(share);
    const full = {[GOOD]: COLOURS.working, [LOW]: COLOURS.waiting, [CRITICAL]: COLOURS.failed}[level];
    for (const [colour, part] of [[COLOURS.line, 1], [full, share]]) {
      if (part <= 0) continue;
      context.strokeStyle = colour;
      context.beginPath();
      context.arc(x, y, radius, -Math.PI / 2, -Math.PI / 2 + 2 * Math.PI * part);
      context.stroke();
    }
  }

  name(robot) {
    const {name} = this.run.rows[robot];
    return this.isChosen(robot) ? name : name.slice(this.beginning);
  }

  // Write the names of the chosen robot and of those whose state stands out (`areFirst`), or those of all others.
  write(labels, poses, areFirst) {
    const areMany = this.run.robots > MANY_ROBOTS && this.view.camera.scale < NAMED_FROM;
    poses.forEach((pose, robot) => {
      const isChosen = this.isChosen(robot), isHindered = this.state(robot).standsOut;
      if (!pose || (isChosen || isHindered) !== areFirst || (areMany && !isChosen)) return;
      labels.write(this.name(robot), this.view.toX(pose.x), this.view.toY(pose.y), {
        gap: this.size + 3, colour: isHindered && !isChosen ? COLOURS.alarm : COLOURS.ink, weight: areFirst ? '600' : '',
        size: isChosen || this.run.robots <= FEW_ROBOTS ? 12 : 11, isKept: isChosen});
    });
  }

  // Draw a diamond at the next stop of each order; it is filled if no robot has the order.
  drawOrders(context) {
    const {run, view} = this, size = Math.min(6, Math.max(3, 0.3 * view.camera.scale));
    context.lineWidth = 1.5;
    for (const phase of run.phases.at(this.player.time)) {
      const [x, y] = [view.toX(run.phase_x[phase]), view.toY(run.phase_y[phase])];
      trace(context, [[x, y - size], [x + size, y], [x, y + size], [x - size, y]]);
      context.fillStyle = run.phase_kind[phase] === OPEN ? COLOURS.order : COLOURS.panel;
      context.strokeStyle = COLOURS.order;
      context.fill();
      context.stroke();
    }
  }

  // The state of the chosen robot in words.
  words(robot, pose) {
    const {run} = this, {time, world} = this.player, share = run.chargeAt(robot, time);
    const order = [...run.phases.at(time)].find((phase) => run.phase_robot[phase] === robot);
    return [run.rows[robot].name, this.state(robot).name, ...(pose ? [place(pose.x, pose.y, pose.yaw)] : []),
            ...(share === null ? [] : [`${Math.round(100 * share)} % charged`]),
            ...(share === null || !('good' in world.levels) ? [] : [world.levelOf(share)]),
            ...(order === undefined ? [] : [`order ${run.orders[run.phase_order[order]]}`,
                                            `stop ${run.phase_stop[order]} of ${run.phase_stops[order]}`]),
    ].join(' · ');
  }
}

// The colour of a robot, by the number at the end of its name, otherwise by its place. RViz has the same hues.
function hue(name, robot) {
  const digits = /(\d{1,9})$/.exec(name), number = digits ? +digits[1] : robot;
  return `hsl(${Math.round(360 * ((number * 0.618033988749895) % 1))} ${COLOURS.vivid})`;
}
