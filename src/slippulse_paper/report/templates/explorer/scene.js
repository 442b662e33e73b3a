// Compute the rupture that the settings describe, the paper's formulas for it, and the numbers
// shown.

// A pulse counts as steady if it deviates from its limit by less than this.
const STEADY = 0.01;

// Return the scene that the settings describe.
function sceneOf({ left, right, gamma, width, release, beta, dx, alpha, end, held }) {
  const ratio = Math.min(beta / dx, DATA.largest_ratio);
  return { left, right, gamma: held ? gamma : 0, width, release, beta, ratio, alpha, end };
}

// Return the front speed by the paper's formula, which holds at b = 0.
function paperSpeed(tau) {
  return 1 / Math.sqrt(1 - tau * tau);
}

function paperPulse(tau, gamma) {
  const width = Math.PI / Math.sqrt(gamma) * tau * paperSpeed(tau);
  return { width, slip: 2 * tau / gamma, peak: 1 / Math.sqrt(gamma) };
}

// Return x_minus, the position from which the integral of tau to the right vanishes, and the
// largest slip velocity far away.
function balance(scene) {
  const { left, width } = scene;
  const zero = -width * Math.sqrt(2 * Math.log((1 - left) / -left));
  const over = (low, high) => {
    const edges = Array.from({ length: 9 }, (_, k) => low + (high - low) * k / 8);
    const parts = edges.slice(1).map((edge, k) => (
      integral((x) => prestressAt(scene, x), edges[k], edge)));
    return parts.reduce((sum, part) => sum + part);
  };
  const ahead = over(zero, 0) + over(0, 10 * width);
  const x = rootBetween((from) => over(from, zero) + ahead, 20 * ahead / left + zero, zero);
  return { x, peak: 0.5 * ahead };
}

// Return the exact rupture and everything that the page shows of it. `steady` is null if there is
// no steady pulse. `known` is true where the construction holds, which excludes the future of a
// trailing edge that is slower than the waves.
function solve(scene) {
  const rupture = new Rupture(scene, DATA.law);
  const map = columns(rupture, scene.end);
  const exact = rupture.transition(map);
  const pairs = map.flatMap((column, k) => [1, -1].map((sign) => [column, map[k + sign], sign]));
  // True if the trailing edge reaches the next column, away from the first stick, slower than
  // waves.
  const slower = ([{ y, stick }, next, sign]) => next && next.start < next.stop
    && Number.isFinite(stick) && sign * (y - exact.firstStick) >= 0
    && Math.min(next.stick, scene.end) - stick > 1.02 * Math.abs(next.y - y);
  const limits = pairs.filter(slower).map(([{ y, stick }]) => ({ x: y, time: stick }));
  const known = (x, time) => limits.every((limit) => time < limit.time + Math.abs(x - limit.x));
  const [, front] = rupture.fronts(scene.end);
  const running = !rupture.right.slow;
  const followed = !limits.some((limit) => limit.x > exact.firstStick);
  const sought = exact.transitionTime < scene.end && running && followed
    ? rupture.pulse(scene.end, exact.firstStick) : null;
  const pulse = sought && known(sought.edge, scene.end) ? sought : null;
  const held = scene.gamma > 0 && scene.right > 0;
  const paper = held ? paperPulse(scene.right, scene.gamma) : null;
  const steady = held ? steadyPulse(scene, exact.speed) : null;
  return { scene, rupture, exact, map, limits, known, front, pulse, paper, steady };
}

function deviates(pulse, steady) {
  const deviation = (name) => Math.abs(pulse[name] / steady[name] - 1);
  return Math.max(deviation("width"), deviation("slip")) > STEADY;
}

// Return the rows of the table: a label, the exact number, and the number of the paper's formula.
function rowsOf({ scene, rupture, exact, pulse, paper, steady }) {
  const { left, right, gamma, alpha, end } = scene;
  const rows = [];
  const speeds = [["right", right, exact.speed], ["left", left, exact.speedLeft]];
  for (const [side, level, speed] of speeds) {
    if (level > 0 && (side === "right" || left !== right)) {
      rows.push([`front speed <i>v</i>, ${side}`, speed, paperSpeed(level)]);
    }
  }
  if (Number.isFinite(exact.transitionTime) && gamma > 0) {
    const time = Math.PI / Math.sqrt(gamma);
    const length = left > 0 && right > 0 ? time * (paperSpeed(left) + paperSpeed(right)) : null;
    rows.push(["<i>T</i><sub>trans</sub>", exact.transitionTime, time]);
    rows.push(["<i>L</i><sub>trans</sub>", exact.transitionLength, length]);
  }
  for (const [side, front, sign] of [["left", rupture.left, -1], ["right", rupture.right, 1]]) {
    if (!front.slow) continue;
    const [x, time] = [sign * front.slow.x.at(-1), front.slow.time.at(-1)];
    const where = front.slow.stopped ? "stops at <i>x</i>" : `at <i>t</i> = ${format(end)}`;
    const balanced = gamma === 0 && right === 0 && side === "left";
    rows.push([`${side} front ${where}`, x, balanced ? balance(scene).x : null]);
    if (front.slow.stopped) rows.push([`${side} front stops at <i>t</i>`, time, null]);
  }
  if (gamma === 0 && left < 0 && right === 0 && alpha === 0) {
    rows.push(["largest slip velocity, far from <i>x</i> = 0", balance(scene).peak, null]);
  }
  if (pulse && paper) {
    const late = steady && deviates(pulse, steady) ? " (not yet steady)" : "";
    rows.push([`width of the right pulse at the end${late}`, pulse.width, paper.width]);
    if (steady) rows.push(["width of the steady right pulse", steady.width, paper.width]);
    rows.push([`slip behind the right pulse at the end${late}`, pulse.slip, paper.slip]);
    if (steady) rows.push(["slip behind the steady right pulse", steady.slip, paper.slip]);
  }
  if (paper) {
    const limit = "no steady pulse above <i>α</i><sub>c</sub>";
    rows.push([limit, criticalRate(gamma, exact.speed), null]);
  }
  return rows;
}

// Return axis ranges that cover a rupture until the end of the map.
function fit({ scene, rupture, paper, steady, map: found }) {
  const peak = Math.max(...found.flatMap(({ values }) => values), 1e-9);
  const slip = Math.max(...found.map(({ slips }) => slips.at(-1)));
  const [back, front] = rupture.fronts(scene.end);
  const widest = Math.max(steady ? steady.width : 0, paper ? paper.width : front);
  const span = scene.gamma > 0 ? 1.5 * widest : front - back;
  return {
    reach: [1.15 * back, 1.15 * front],
    largest: peak,
    span: Math.min(span, 1.2 * (front - back)),
    velocity: 1.1 * Math.max(peak, paper ? paper.peak : 0),
    slip: 1.1 * Math.max(slip, paper ? paper.slip : 0),
  };
}
