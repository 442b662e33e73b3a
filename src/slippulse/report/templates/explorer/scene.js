// The rupture that the settings describe, the formulas of the paper for it, and all that is said of it.

// A pulse is steady within this of its limit.
const STEADY = 0.01;

// The scene that the settings describe.
function sceneOf({ left, right, gamma, width, release, beta, dx, alpha, end, held }) {
  const ratio = Math.min(beta / dx, DATA.largest_ratio);
  return { left, right, gamma: held ? gamma : 0, width, release, beta, ratio, alpha, end };
}

function paperPulse(tau, gamma) {
  const speed = 1 / Math.sqrt(1 - tau * tau);
  const time = Math.PI / Math.sqrt(gamma);
  return { speed, time, width: time * tau * speed, slip: 2 * tau / gamma, peak: 1 / Math.sqrt(gamma) };
}

// Int tau dx from a position on to the right, as far as the Gaussian reaches, and where it vanishes: x_minus.
function balance({ left, right, width }) {
  const tau = (x) => (x < 0 ? left : right) + (1 - (x < 0 ? left : right)) * Math.exp(-0.5 * (x / width) ** 2);
  const zero = -width * Math.sqrt(2 * Math.log((1 - left) / -left));
  const over = (low, high) => Array.from({ length: 8 }, (_, k) => (
    integral(tau, low + (high - low) * k / 8, low + (high - low) * (k + 1) / 8))).reduce((sum, part) => sum + part);
  const ahead = over(zero, 0) + over(0, 10 * width);
  return { x: rootBetween((x) => over(x, zero) + ahead, 20 * ahead / left + zero, zero), peak: 0.5 * ahead };
}

// The exact rupture and everything that is said of it; `steady` is null where no pulse is, and `known` tells where the
// construction holds: nothing is said of the future of a trailing edge that is slower than the waves.
function solve(scene) {
  const rupture = new Rupture(scene, DATA.law);
  const map = columns(rupture, scene.end);
  const exact = rupture.transition(map);
  const limits = map.flatMap((column, k) => [1, -1].map((sign) => [column, map[k + sign], sign]))
    .filter(([{ y, stick }, next, sign]) => next && Number.isFinite(stick) && sign * (y - exact.firstStick) >= 0
      && Math.min(next.stick, scene.end) - stick > 1.02 * Math.abs(next.y - y) && next.start < next.stop)
    .map(([{ y, stick }]) => ({ x: y, time: stick }));
  const known = (x, time) => limits.every((limit) => time < limit.time + Math.abs(x - limit.x));
  const [, front] = rupture.fronts(scene.end);
  const running = !rupture.right.slow;
  const sought = exact.transitionTime < scene.end && running && !limits.some((limit) => limit.x > exact.firstStick)
    ? rupture.pulse(scene.end, exact.firstStick) : null;
  const pulse = sought && known(sought.edge, scene.end) ? sought : null;
  const held = scene.gamma > 0 && scene.right > 0;
  return {
    scene, rupture, exact, map, limits, known, front, pulse, paper: held ? paperPulse(scene.right, scene.gamma) : null,
    steady: held ? steadyPulse(scene, exact.speed) : null,
  };
}

function deviates(pulse, steady) {
  return Math.max(Math.abs(pulse.width / steady.width - 1), Math.abs(pulse.slip / steady.slip - 1)) > STEADY;
}

// Rows of what is exact and what the paper's formulas say.
function rowsOf({ scene, rupture, exact, pulse, paper, steady }) {
  const { left, right, gamma, alpha, end } = scene;
  const rows = [];
  for (const [side, level, speed] of [["right", right, exact.speed], ["left", left, exact.speedLeft]]) {
    if (level > 0 && (side === "right" || left !== right)) {
      rows.push([`front speed <i>v</i>, ${side}`, speed, 1 / Math.sqrt(1 - level * level)]);
    }
  }
  if (Number.isFinite(exact.transitionTime) && gamma > 0) {
    const length = left > 0 && right > 0
      ? Math.PI / Math.sqrt(gamma) * (1 / Math.sqrt(1 - left * left) + 1 / Math.sqrt(1 - right * right)) : null;
    rows.push(["<i>T</i><sub>trans</sub>", exact.transitionTime, Math.PI / Math.sqrt(gamma)]);
    rows.push(["<i>L</i><sub>trans</sub>", exact.transitionLength, length]);
  }
  for (const [side, front, sign] of [["left", rupture.left, -1], ["right", rupture.right, 1]]) {
    if (!front.slow) continue;
    const [x, time] = [sign * front.slow.x.at(-1), front.slow.time.at(-1)];
    rows.push([front.slow.stopped ? `${side} front stops at <i>x</i>` : `${side} front at <i>t</i> = ${format(end)}`, x,
      gamma === 0 && right === 0 && side === "left" ? balance(scene).x : null]);
    if (front.slow.stopped) rows.push([`${side} front stops at <i>t</i>`, time, null]);
  }
  if (gamma === 0 && left < 0 && right === 0 && alpha === 0) {
    rows.push(["largest slip velocity, far away", balance(scene).peak, null]);
  }
  if (pulse && paper) {
    const late = steady && deviates(pulse, steady) ? " (not yet steady)" : "";
    rows.push([`width of the right pulse at the end${late}`, pulse.width, paper.width]);
    if (steady) rows.push(["its width once steady", steady.width, paper.width]);
    rows.push([`slip behind it at the end${late}`, pulse.slip, paper.slip]);
    if (steady) rows.push(["that slip once steady", steady.slip, paper.slip]);
  }
  if (paper) rows.push(["pulses end at <i>α</i><sub>c</sub>", criticalRate(gamma, exact.speed), null]);
  return rows;
}

// Axes for a rupture: as far as it gets until the end of the map.
function fit({ scene, rupture, front, paper, steady, map: found }) {
  const peak = Math.max(...found.flatMap(({ values }) => values), 1e-9);
  const span = scene.gamma > 0 ? 1.5 * Math.max(steady ? steady.width : 0, paper ? paper.width : front) : front - rupture.fronts(scene.end)[0];
  const slip = Math.max(...found.map(({ slips }) => slips.at(-1)));
  return {
    reach: rupture.fronts(scene.end).map((x) => 1.15 * x), largest: peak, span: Math.min(span, 1.2 * (front - rupture.fronts(scene.end)[0])),
    velocity: 1.1 * Math.max(peak, paper ? paper.peak : 0), slip: 1.1 * Math.max(slip, paper ? paper.slip : 0),
  };
}
