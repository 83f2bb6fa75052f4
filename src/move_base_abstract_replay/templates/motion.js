// The motion law of the simulator's core (move_base_abstract/motion/leg.py): turn, drive from rest to rest, turn.
// Times are in ns, lengths in m, angles in rad. A test compares it with the core, leg by leg.
const NS_PER_S = 1e9, ROUNDING = 1e-9;

function normalizeAngle(angle) {
  const wrapped = angle % (2 * Math.PI);
  if (wrapped <= -Math.PI) return wrapped + 2 * Math.PI;
  return wrapped > Math.PI ? wrapped - 2 * Math.PI : wrapped;
}

function roundHalfToEven(value) {
  const rounded = Math.round(value);
  return rounded - value === 0.5 && rounded % 2 !== 0 ? rounded - 1 : rounded;
}

function secondsToNs(seconds) {
  const whole = Math.floor(seconds);
  return whole * NS_PER_S + roundHalfToEven((seconds - whole) * NS_PER_S);
}

function withSign(size, sign) {
  return sign < 0 || Object.is(sign, -0) ? -Math.abs(size) : Math.abs(size);
}

// A leg between two poses {x, y, yaw}. limits: [max speed, acceleration, turn rate, xy and yaw tolerance]; an
// acceleration or turn rate of 0 is no limit.
function makeLeg(start, goal, limits, departNs) {
  const [maxSpeed, acceleration, turnRate, xyTolerance, yawTolerance] =
      [limits[0], limits[1] || Infinity, limits[2] || Infinity, limits[3], limits[4]];
  const gap = Math.hypot(goal.x - start.x, goal.y - start.y);
  const left = gap - xyTolerance, distance = left > (xyTolerance ? ROUNDING : 0) ? left : 0;
  const course = distance > 0 ? Math.atan2(goal.y - start.y, goal.x - start.x) : start.yaw;
  const firstTurn = normalizeAngle(course - start.yaw);
  const wanted = normalizeAngle(goal.yaw - course);
  const lastTurn = withSign(Math.max(0, Math.abs(wanted) - yawTolerance), wanted);
  const product = acceleration * distance;
  // The product of two tiny numbers may be 0; then the robot would never start and yet arrive at once.
  const reached = product ? Math.sqrt(product) : Math.sqrt(acceleration) * Math.sqrt(distance);
  const peak = acceleration === Infinity ? maxSpeed : Math.min(maxSpeed, reached);
  const ramp = acceleration === Infinity ? 0 : peak / acceleration;
  const seconds = distance <= 0 || peak <= 0 ? 0 : distance / peak + ramp;
  const driveNs = departNs + secondsToNs(Math.abs(firstTurn) / turnRate);
  const lastTurnNs = driveNs + secondsToNs(seconds);
  const arriveNs = lastTurnNs + secondsToNs(Math.abs(lastTurn) / turnRate);
  const share = gap > 0 ? distance / gap : 0;
  const end = {
    x: share === 1 ? goal.x : start.x + share * (goal.x - start.x),
    y: share === 1 ? goal.y : start.y + share * (goal.y - start.y),
    yaw: normalizeAngle(yawTolerance === 0 ? goal.yaw : course + lastTurn),
  };
  return {start, end, distance, course, firstTurn, lastTurn, acceleration, turnRate, peak, ramp, seconds,
          departNs, driveNs, lastTurnNs, arriveNs};
}

function covered(leg, elapsed) {
  if (elapsed >= leg.seconds) return leg.distance;
  if (elapsed <= 0) return 0;
  if (elapsed < leg.ramp) return 0.5 * leg.acceleration * elapsed * elapsed;
  if (elapsed > leg.seconds - leg.ramp) {
    const left = leg.seconds - elapsed;
    return leg.distance - 0.5 * leg.acceleration * left * left;
  }
  return leg.peak * (elapsed - 0.5 * leg.ramp);
}

function legPose(leg, timeNs) {
  if (timeNs < leg.departNs) return leg.start;
  if (timeNs >= leg.arriveNs) return leg.end;
  if (timeNs < leg.driveNs) {
    const turned = withSign(leg.turnRate * (timeNs - leg.departNs) / NS_PER_S, leg.firstTurn);
    return {x: leg.start.x, y: leg.start.y, yaw: normalizeAngle(leg.start.yaw + turned)};
  }
  if (timeNs < leg.lastTurnNs) {
    const way = covered(leg, (timeNs - leg.driveNs) / NS_PER_S);
    return {x: leg.start.x + way * Math.cos(leg.course), y: leg.start.y + way * Math.sin(leg.course), yaw: leg.course};
  }
  const turned = withSign(leg.turnRate * (timeNs - leg.lastTurnNs) / NS_PER_S, leg.lastTurn);
  return {x: leg.end.x, y: leg.end.y, yaw: normalizeAngle(leg.course + turned)};
}

// The pose on a leg of which only the ends are known: straight, at an even speed.
function evenPose(start, end, beginNs, endNs, timeNs, turns) {
  if (timeNs >= endNs || endNs <= beginNs) return end;
  const share = Math.max(0, timeNs - beginNs) / (endNs - beginNs);
  const isTurn = turns || (start.x === end.x && start.y === end.y);
  return {x: start.x + share * (end.x - start.x), y: start.y + share * (end.y - start.y),
          yaw: isTurn ? normalizeAngle(start.yaw + share * normalizeAngle(end.yaw - start.yaw))
                      : Math.atan2(end.y - start.y, end.x - start.x)};
}
