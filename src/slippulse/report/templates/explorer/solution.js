// The exact rupture under a displacement boundary in the continuum limit dx -> 0 at fixed b = beta/dx.
//
// Fronts are at t = T(x), the integral of 1/v(tau, b). Behind them, with J0 inside the past cone of (y, t),
//   du/dt = 1/2 Int tau(x) J0( sqrt(gamma) sqrt((t - T(x))^2 - (x - y)^2) ) dx,
// and y sticks at the first zero of du/dt. Both pre-stress levels must be positive.

// Nodes and weights of Gauss and Legendre on [-1, 1].
function gauss(count) {
  const nodes = [];
  for (let k = 0; k < count; k++) {
    let x = Math.cos(Math.PI * (k + 0.75) / (count + 0.5));
    let slope = 1;
    for (let turn = 0; turn < 20; turn++) {
      let [before, value] = [1, x];
      for (let n = 2; n <= count; n++) [before, value] = [value, ((2 * n - 1) * x * value - (n - 1) * before) / n];
      slope = count * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    nodes.push({ x, weight: 2 / ((1 - x * x) * slope * slope) });
  }
  return nodes;
}

const NODES = gauss(12);
const [FEW, MANY] = [gauss(4), gauss(40)];

function integral(integrand, low, high, nodes = NODES) {
  const half = 0.5 * (high - low);
  return half * nodes.reduce((sum, node) => sum + node.weight * integrand(low + half * (1 + node.x)), 0);
}

// The root of a function between two points where its signs differ (secants that keep the bracket).
function rootBetween(f, low, high, atLow = f(low), atHigh = f(high)) {
  for (let turn = 0; turn < 60 && Math.abs(high - low) > 1e-10 * (Math.abs(high) + Math.abs(low)); turn++) {
    const middle = (low * atHigh - high * atLow) / (atHigh - atLow);
    const value = f(middle);
    if (value === 0) return middle;
    if (value * atHigh < 0) [low, atLow] = [high, atHigh];
    else atLow *= 0.5;
    [high, atHigh] = [middle, value];
  }
  return high;
}

// J0(sqrt z), tabulated with its slope by z: means over an angle, exact to rounding up to sqrt z = 60.
const BESSEL = { step: 0.25, last: 3600, value: [], slope: [] };
for (let z = 0; z <= BESSEL.last; z += BESSEL.step) {
  const root = Math.sqrt(z);
  let value = 0;
  let slope = 0;
  for (let k = 0; k < 64; k++) {
    const sine = Math.sin((k + 0.5) * Math.PI / 64);
    value += Math.cos(root * sine) / 64;
    slope -= (root > 0 ? Math.sin(root * sine) / root : sine) * sine / 128;
  }
  BESSEL.value.push(value);
  BESSEL.slope.push(slope);
}

function bessel(z) {
  const position = Math.min(Math.max(z, 0), BESSEL.last - 1) / BESSEL.step;
  const k = Math.floor(position);
  const { step, value, slope } = BESSEL;
  return hermite(position - k, step, value[k], value[k + 1], slope[k], slope[k + 1]);
}

// The front on one side, seen going away from x = 0: T by distance, and where T + x or T - x has a value.
class Front {
  constructor(level, width, law) {
    Object.assign(this, { level, width, cells: 240, extent: 7 * width });
    this.rest = (x) => -(1 - level) * Math.expm1(-0.5 * (x / width) ** 2);
    this.slowness = law(1 - level);
    const slowness = (x) => law(this.rest(x));
    // Nodes are denser near the peak, where the front is fastest.
    this.x = Array.from({ length: this.cells + 1 }, (_, k) => this.extent * (k / this.cells) ** 2);
    this.slope = this.x.map(slowness);
    this.time = [0];
    for (let k = 0; k < this.cells; k++) {
      this.time.push(this.time[k] + integral(slowness, this.x[k], this.x[k + 1], FEW));
    }
    this.sums = { 1: this.time.map((t, k) => t + this.x[k]), [-1]: this.time.map((t, k) => t - this.x[k]) };
  }

  within(k, x) {
    const length = this.x[k + 1] - this.x[k];
    const fraction = (x - this.x[k]) / length;
    return hermite(fraction, length, this.time[k], this.time[k + 1], this.slope[k], this.slope[k + 1]);
  }

  arrival(x) {
    if (x >= this.extent) return this.time[this.cells] + this.slowness * (x - this.extent);
    return this.within(Math.floor(this.cells * Math.sqrt(x / this.extent)), x);
  }

  // The distance x at which T + sign x has a value; with sign 0, at which T has it.
  where(sign, target) {
    const sums = this.sums[sign] || this.time;
    const direction = sign < 0 ? -1 : 1;
    const beyond = target - sums[this.cells];
    if (direction * beyond >= 0) return this.extent + beyond / (this.slowness + sign);
    const k = cell(sums, target, direction);
    const [low, high] = [this.x[k], this.x[k + 1]];
    let x = low + (high - low) * (target - sums[k]) / (sums[k + 1] - sums[k]);
    for (let turn = 0; turn < 4; turn++) {
      const fraction = (x - low) / (high - low);
      const slope = this.slope[k] + fraction * (this.slope[k + 1] - this.slope[k]) + sign;
      if (slope === 0) break;
      x = Math.min(Math.max(x - (this.within(k, x) + sign * x - target) / slope, low), high);
    }
    return x;
  }
}

class Rupture {
  // left, right: pre-stress levels in (0, 1); gamma > 0; width of the peak; ratio b; release "total" or "elastic".
  constructor({ left, right, gamma, width, ratio, release }, table) {
    const law = frontLaw(table, ratio, release);
    this.gamma = gamma;
    this.width = width;
    this.right = new Front(right, width, law);
    this.left = left === right ? this.right : new Front(left, width, law);
    this.symmetric = left === right;
    this.period = Math.PI / Math.sqrt(gamma);
    const steps = [1, 2.5, 4.5].map((factor) => factor * width);
    this.breaks = [...steps.map((x) => -x).reverse(), 0, ...steps];
  }

  side(x) {
    return x < 0 ? this.left : this.right;
  }

  arrival(x) {
    return this.side(x).arrival(Math.abs(x));
  }

  // Where the fronts are at a time: [left, right].
  fronts(time) {
    return [-this.left.where(0, time), this.right.where(0, time)];
  }

  velocity(y, time) {
    const [behind, ahead] = [time - y, time + y];
    const from = behind >= 0 ? -this.left.where(1, behind) : this.right.where(-1, behind);
    const to = ahead >= 0 ? this.right.where(1, ahead) : -this.left.where(-1, ahead);
    let sum = 0;
    let low = from;
    for (const high of [...this.breaks.filter((x) => x > from && x < to), to]) {
      const front = this.side(0.5 * (low + high));
      const half = 0.5 * (high - low);
      for (const node of NODES) {
        const x = low + half * (1 + node.x);
        const distance = Math.abs(x);
        const late = time - front.arrival(distance);
        sum += half * node.weight * (1 - front.rest(distance))
          * bessel(this.gamma * (late - x + y) * (late + x - y));
      }
      low = high;
    }
    return 0.5 * sum;
  }

  // When y sticks; infinite if not until a time.
  stick(y, until = 6 * this.period) {
    const start = this.arrival(y);
    const front = this.side(y);
    const slowness = y === 0 ? 0 : front.slope[Math.min(front.cells, cell(front.x, Math.abs(y)))];
    let step = 0.06 * this.period * Math.max(Math.sqrt(1 - slowness * slowness), 0.01);
    let [before, valueBefore] = [start, NaN];
    while (before < until) {
      const time = before + step;
      const value = this.velocity(y, time);
      if (value <= 0) return rootBetween((t) => this.velocity(y, t), before, time, valueBefore, value);
      [before, valueBefore] = [time, value];
      step = Math.min(1.1 * step, 0.06 * this.period);
    }
    return Infinity;
  }

  slip(y, time) {
    const start = this.arrival(y);
    return time <= start ? 0 : integral((t) => this.velocity(y, t), start, time, MANY);
  }

  // The first sticking: at the centre of a symmetric scene, else where the stick time is least.
  firstStick() {
    const centre = { x: 0, time: this.stick(0) };
    if (this.symmetric) return centre;
    const step = centre.time / 40;
    const found = Array.from({ length: 41 }, (_, k) => ({ x: (k - 20) * step }));
    for (const point of found) point.time = point.x === 0 ? centre.time : this.stick(point.x, 1.2 * centre.time);
    const least = found.reduce((a, b) => (b.time < a.time ? b : a));
    // Golden section between the neighbours.
    const golden = 0.5 * (Math.sqrt(5) - 1);
    let [low, high] = [least.x - step, least.x + step];
    let best = least;
    for (let turn = 0; turn < 18; turn++) {
      const [a, b] = [high - golden * (high - low), low + golden * (high - low)]
        .map((x) => ({ x, time: this.stick(x, 1.2 * centre.time) }));
      for (const point of [a, b]) if (point.time < best.time) best = point;
      if (a.time < b.time) high = b.x;
      else low = a.x;
    }
    return best;
  }

  // Speeds, the first sticking, and how far apart the fronts are then.
  transition() {
    const first = this.firstStick();
    const [left, right] = this.fronts(first.time);
    return {
      speed: 1 / this.right.slowness,
      speedLeft: 1 / this.left.slowness,
      transitionTime: first.time,
      transitionLength: right - left,
      firstStick: first.x,
    };
  }

  // The right pulse at a time after the first sticking at a position: its front and trailing edge, and the slip there.
  pulse(time, from) {
    const front = this.fronts(time)[1];
    const late = (x) => Math.min(this.stick(x, 1.5 * time), 1.5 * time) - time;
    const edge = rootBetween(late, from, front * (1 - 1e-9));
    return { time, front, edge, width: front - edge, slip: this.slip(edge, time) };
  }
}

// Slip of the steady pulse at finite damping: (tau_0/gamma)(1 + exp(-pi p/q)), where p +- i q are the complex roots of
// beta v z^3 + (v^2 - 1) z^2 + gamma = 0.
function steadySlip({ left, gamma, beta }, speed) {
  const [damping, stiffness] = [beta * speed, speed * speed - 1];
  if (damping === 0) return 2 * left / gamma;
  const cubic = (z) => (damping * z + stiffness) * z * z + gamma;
  const real = rootBetween(cubic, -stiffness / damping - Math.cbrt(gamma / damping), -stiffness / damping);
  const growth = -0.5 * (stiffness / damping + real);
  const wavenumber = Math.sqrt(-gamma / (damping * real) - growth * growth);
  return left / gamma * (1 + Math.exp(-Math.PI * growth / wavenumber));
}
