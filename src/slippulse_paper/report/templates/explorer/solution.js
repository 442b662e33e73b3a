// The exact rupture in the continuum limit dx -> 0 at fixed b = beta/dx, held (gamma > 0) or under
// a stress (gamma = 0), with a friction term -alpha du/dt, which strengthens with slip rate if
// alpha > 0 and weakens if alpha < 0.
//
// Where tau > 0, the fronts are at t = T(x), the integral of 1/v(tau, b). Behind them
//   du/dt = 1/2 Int tau(x) exp(-alpha late/2) J0( k sqrt(late^2 - (x - y)^2) ) dx
// over the past of (y, t), with late = t - T(x) and k^2 = gamma - alpha^2/4, and y sticks at the
// first zero of du/dt. Where tau < 0, a front is slower than the waves, and du/dt = 0 on it.

// Return nodes and weights of Gauss-Legendre quadrature on [-1, 1].
function gauss(count) {
  const nodes = [];
  for (let k = 0; k < count; k++) {
    let x = Math.cos(Math.PI * (k + 0.75) / (count + 0.5));
    let slope = 1;
    for (let turn = 0; turn < 20; turn++) {
      let [before, value] = [1, x];
      for (let n = 2; n <= count; n++) {
        [before, value] = [value, ((2 * n - 1) * x * value - (n - 1) * before) / n];
      }
      slope = count * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    nodes.push({ x, weight: 2 / ((1 - x * x) * slope * slope) });
  }
  return nodes;
}

const NODES = gauss(10);
const FOUR_NODES = gauss(4);
const MANY = gauss(32);

function integral(integrand, low, high, nodes = NODES) {
  const half = 0.5 * (high - low);
  const part = ({ x, weight }) => weight * integrand(low + half * (1 + x));
  return half * nodes.reduce((sum, node) => sum + part(node), 0);
}

// Return the root of a function between two points with different signs, by bracketed secants.
function rootBetween(f, low, high, atLow = f(low), atHigh = f(high)) {
  const apart = () => Math.abs(high - low) > 1e-10 * (Math.abs(high) + Math.abs(low));
  for (let turn = 0; turn < 60 && apart(); turn++) {
    const middle = (low * atHigh - high * atLow) / (atHigh - atLow);
    const value = f(middle);
    if (value === 0) return middle;
    if (value * atHigh < 0) [low, atLow] = [high, atHigh];
    else atLow *= 0.5;
    [high, atHigh] = [middle, value];
  }
  return high;
}

// J0(sqrt z), or I0(sqrt(-z)) for z < 0, and its derivative by z, tabulated up to |z| = 60^2. Both
// are computed as means over an angle.
const BESSEL = { step: 0.25, last: 3600, value: [], slope: [] };
for (let z = -BESSEL.last; z <= BESSEL.last; z += BESSEL.step) {
  const root = Math.sqrt(Math.abs(z));
  const [even, odd] = z < 0 ? [Math.cosh, Math.sinh] : [Math.cos, Math.sin];
  let value = 0;
  let slope = 0;
  for (let k = 0; k < 64; k++) {
    const sine = Math.sin((k + 0.5) * Math.PI / 64);
    value += even(root * sine) / 64;
    slope -= (root > 0 ? odd(root * sine) / root : sine) * sine / 128;
  }
  BESSEL.value.push(value);
  BESSEL.slope.push(slope);
}
const VALUES = Float64Array.from(BESSEL.value);
const SLOPES = Float64Array.from(BESSEL.slope);

function bessel(z) {
  const position = (Math.min(Math.max(z, -BESSEL.last), BESSEL.last - 1) + BESSEL.last) * 4;
  const k = Math.floor(position);
  const f = position - k;
  const rest = 1 - f;
  return rest * rest * ((1 + 2 * f) * VALUES[k] + 0.25 * f * SLOPES[k])
    + f * f * ((1 + 2 * rest) * VALUES[k + 1] - 0.25 * rest * SLOPES[k + 1]);
}

// The front on one side: its arrival time T by distance from x = 0, and the distance at which T + x
// or T - x has a given value. Its nodes cover the part where it outruns the waves. Where tau < 0,
// `Rupture.march` adds more nodes.
class Front {
  constructor(level, width, law) {
    Object.assign(this, { level, width, cells: 240 });
    this.rest = (x) => (1 - level) * (x < 8 * width ? -Math.expm1(-0.5 * (x / width) ** 2) : 1);
    this.slowness = level > 0 ? law(1 - level) : 1;
    // The zero of tau, or the distance at which tau has reached its level.
    this.extent = level < 0 ? width * Math.sqrt(2 * Math.log((1 - level) / -level)) : 7 * width;
    const slowness = (x) => law(this.rest(x));
    // Nodes are denser near the peak of the pre-stress, where the front is fastest.
    this.x = Array.from({ length: this.cells + 1 }, (_, k) => this.extent * (k / this.cells) ** 2);
    this.slope = this.x.map(slowness);
    this.time = [0];
    for (let k = 0; k < this.cells; k++) {
      this.time.push(this.time[k] + integral(slowness, this.x[k], this.x[k + 1], FOUR_NODES));
    }
    this.sums = {
      1: this.time.map((t, k) => t + this.x[k]),
      [-1]: this.time.map((t, k) => t - this.x[k]),
    };
    const last = this.time[this.cells];
    this.slow = level < 0 ? { x: [this.extent], time: [last], stopped: false } : null;
  }

  within(k, x) {
    const { time, slope } = this;
    const length = this.x[k + 1] - this.x[k];
    const fraction = (x - this.x[k]) / length;
    return hermite(fraction, length, time[k], time[k + 1], slope[k], slope[k + 1]);
  }

  arrival(x) {
    if (x < this.extent) return this.within(Math.floor(this.cells * Math.sqrt(x / this.extent)), x);
    if (!this.slow) return this.time[this.cells] + this.slowness * (x - this.extent);
    const { x: at, time } = this.slow;
    const last = at.length - 1;
    if (last === 0 || x > at[last]) return x > at[last] ? Infinity : time[last];
    const k = cell(at, x);
    return time[k] + (time[k + 1] - time[k]) * (x - at[k]) / (at[k + 1] - at[k]);
  }

  // Return the distance x at which T + sign x has a given value; with sign 0 at which T has it.
  where(sign, target) {
    const sums = this.sums[sign] || this.time;
    const direction = sign < 0 ? -1 : 1;
    const beyond = target - sums[this.cells];
    if (direction * beyond >= 0) {
      if (!this.slow) {
        const slope = this.slowness + sign;
        return this.extent + (slope === 0 ? 0 : beyond / slope);
      }
      const { x, time } = this.slow;
      const last = x.length - 1;
      if (sign < 0 || last === 0) return this.extent;
      if (target >= time[last] + sign * x[last]) return x[last];
      let [low, high] = [0, last];
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (time[middle] + sign * x[middle] <= target) low = middle;
        else high = middle;
      }
      const [first, second] = [time[low] + sign * x[low], time[high] + sign * x[high]];
      return x[low] + (x[high] - x[low]) * (target - first) / (second - first);
    }
    const k = cell(sums, target, direction);
    const [low, high] = [this.x[k], this.x[k + 1]];
    let x = low + (high - low) * (target - sums[k]) / (sums[k + 1] - sums[k]);
    for (let turn = 0; turn < 4; turn++) {
      const fraction = (x - low) / (high - low);
      const slope = this.slope[k] + fraction * (this.slope[k + 1] - this.slope[k]) + sign;
      if (slope === 0) break;
      const change = (this.within(k, x) + sign * x - target) / slope;
      x = Math.min(Math.max(x - change, low), high);
      if (Math.abs(change) < 1e-12 * high) break;
    }
    return x;
  }
}

class Rupture {
  // left, right: levels below 1; gamma, 0 under a stress; width of the peak; ratio b; release rule;
  // alpha; until a time.
  constructor({ left, right, gamma, width, ratio, release, alpha = 0, end = Infinity }, table) {
    const law = frontLaw(table, ratio, release);
    Object.assign(this, { gamma, width, alpha, squared: gamma - 0.25 * alpha * alpha });
    this.right = new Front(right, width, law);
    this.left = left === right ? this.right : new Front(left, width, law);
    this.symmetric = left === right;
    this.period = gamma > 0 ? Math.PI / Math.sqrt(gamma) : Infinity;
    this.end = Number.isFinite(end) ? end : 6 * this.period;
    const steps = [1, 2.5, 4.5].map((factor) => factor * width);
    this.breaks = [...steps.map((x) => -x).reverse(), 0, ...steps];
    for (const [front, sign] of [[this.left, -1], [this.right, 1]]) {
      if (front.slow) this.breaks.push(sign * front.extent);
    }
    this.breaks.sort((a, b) => a - b);
    if (this.left.slow || this.right.slow) this.march();
  }

  // Where tau < 0: the positions at which du/dt = 0 at a time, from step to step; a front stops
  // where nothing slides on.
  march(count = 200) {
    const fronts = this.symmetric ? [[this.right, 1]] : [[this.left, -1], [this.right, 1]];
    const sides = fronts.filter(([front]) => front.slow);
    const start = Math.min(...sides.map(([front]) => front.time[front.cells]));
    for (let n = 1; n <= count; n++) {
      // The first steps are short, since the front still runs at the speed of the waves.
      const time = start + (this.end - start) * (n / count) ** 1.5;
      for (const [front, sign] of sides) {
        const { slow } = front;
        const last = slow.x.length - 1;
        const step = time - slow.time[last];
        if (slow.stopped || step <= 0) continue;
        const from = slow.x[last];
        const rate = (x) => {
          slow.x[last + 1] = Math.max(x, from * (1 + 1e-13));
          return this.velocity(sign * slow.x[last + 1], time);
        };
        slow.time.push(time);
        // Secant iteration from the last position and from the position at the last speed.
        let [x0, rate0] = [from, rate(from)];
        if (rate0 <= 0) {
          slow.stopped = true;
          slow.x.length = slow.time.length = last + 1;
          continue;
        }
        const speed = last === 0 ? 0.9
          : (from - slow.x[last - 1]) / (slow.time[last] - slow.time[last - 1]);
        let x = from + step * speed;
        for (let turn = 0; turn < 8; turn++) {
          const rate1 = rate(x);
          const root = x - rate1 * (x - x0) / (rate1 - rate0);
          const next = rate1 === rate0 ? x : Math.min(Math.max(root, from), from + step);
          [x0, rate0] = [x, rate1];
          if (Math.abs(next - x) < 1e-7 * step) break;
          x = next;
        }
        slow.x[last + 1] = Math.max(x, from * (1 + 1e-12));
      }
    }
  }

  side(x) {
    return x < 0 ? this.left : this.right;
  }

  arrival(x) {
    return this.side(x).arrival(Math.abs(x));
  }

  // Return the positions of both fronts at a time: [left, right].
  fronts(time) {
    return [-this.left.where(0, time), this.right.where(0, time)];
  }

  velocity(y, time) {
    const [behind, ahead] = [time - y, time + y];
    const from = behind >= 0 ? -this.left.where(1, behind) : this.right.where(-1, behind);
    const to = ahead >= 0 ? this.right.where(1, ahead) : -this.left.where(-1, ahead);
    const { alpha, squared, breaks } = this;
    // Without leaf springs and rate term, the kernel is 1.
    const flat = alpha === 0 && squared === 0;
    // With a rate term the kernel changes like an exponential of alpha x, and with strong leaf
    // springs it oscillates too.
    const longest = alpha === 0 ? Infinity : (squared > 0 ? 2 : 8) / Math.abs(alpha);
    // The kernel is largest at the nearer end, where a front passed last, and nothing beside it
    // where one passed long before.
    const latest = Math.min(y - from, to - y) + (alpha > 0 && squared > 0 ? 40 / alpha : Infinity);
    let sum = 0;
    let low = from;
    for (let piece = 0; low < to;) {
      const high = piece < breaks.length ? breaks[piece] : to;
      if (high <= low) {
        piece++;
        continue;
      }
      const top = Math.min(high, to, low + longest);
      const front = this.side(0.5 * (low + top));
      if (time - front.arrival(Math.max(Math.abs(low), Math.abs(top))) > latest) {
        low = top;
        continue;
      }
      const half = 0.5 * (top - low);
      for (let n = 0; n < NODES.length; n++) {
        const x = low + half * (1 + NODES[n].x);
        const distance = Math.abs(x);
        let kernel = 1;
        if (!flat) {
          const late = time - front.arrival(distance);
          kernel = bessel(squared * (late - x + y) * (late + x - y));
          if (alpha !== 0) kernel *= Math.exp(-0.5 * alpha * late);
        }
        sum += half * NODES[n].weight * (1 - front.rest(distance)) * kernel;
      }
      low = top;
    }
    return 0.5 * sum;
  }

  // Slip velocity at y at rising times from its release on, until it sticks (infinite if not until
  // a time).
  history(y, until = this.end) {
    const [times, values, start] = [[this.arrival(y)], [0], this.arrival(y)];
    const front = this.side(y);
    const slowness = y === 0 ? 0 : front.slope[Math.min(front.cells, cell(front.x, Math.abs(y)))];
    const longest = Math.min(0.06 * this.period, (until - start) / 24 + 1e-9);
    let step = longest * Math.max(Math.sqrt(1 - Math.min(slowness, 1) ** 2), 0.02);
    let time = start;
    // The error of the positions of a slow front.
    const error = front.slow && Math.abs(y) > front.extent ? 3e-4 * this.width : 0;
    let slid = false;
    while (time < until) {
      time = Math.min(time + step, until);
      const value = this.velocity(y, time);
      if (value <= -error && slid) {
        const [last, before] = [times.at(-1), values.at(-1)];
        const velocity = (t) => this.velocity(y, t);
        const stick = before > 0 ? rootBetween(velocity, last, time, before, value) : last;
        return { times: [...times, stick], values: [...values, 0], stick };
      }
      // Just behind a slow front, velocities are as small as the error.
      slid ||= value > 0;
      times.push(time);
      values.push(Math.max(value, 0));
      step = Math.min(1.15 * step, Math.max(longest, (time - start) / 24));
    }
    // Nothing slides at the position where a front stops.
    if (!slid && front.slow?.stopped) {
      return { times: [start, start], values: [0, 0], stick: start };
    }
    return { times, values, stick: Infinity };
  }

  stick(y, until = this.end) {
    return this.history(y, until).stick;
  }

  slip(y, time, nodes = MANY) {
    const start = this.arrival(y);
    return time <= start ? 0 : integral((t) => this.velocity(y, t), start, time, nodes);
  }

  // The first sticking: at the centre of a symmetric scene, else where the stick time is least,
  // near the best of every other column; null if there is none.
  firstStick(found) {
    if (this.symmetric) {
      const time = this.stick(0);
      return Number.isFinite(time) ? { x: 0, time } : null;
    }
    const sought = found.filter((_, k) => k % 2).map(({ y, stick }) => ({ x: y, time: stick }));
    let step = sought[1].x - sought[0].x;
    const earlier = (least, next) => (next.time < least.time ? next : least);
    let best = sought.reduce(earlier, { x: 0, time: this.stick(0) });
    // Fit a parabola to three neighbouring columns.
    for (let turn = 0; turn < 4 && Number.isFinite(best.time); turn++, step *= 0.35) {
      const [before, after] = [best.x - step, best.x + step].map((x) => this.stick(x));
      const bend = before - 2 * best.time + after;
      if (!(bend > 0)) continue;
      const x = best.x + 0.5 * step * (before - after) / bend;
      const time = this.stick(x);
      if (time < best.time) best = { x, time };
    }
    return Number.isFinite(best.time) ? best : null;
  }

  // Speeds, the first sticking, and how far apart the fronts are then; no times where nothing
  // sticks.
  transition(found = this.symmetric ? [] : columns(this, this.end)) {
    const first = this.firstStick(found);
    const [left, right] = first ? this.fronts(first.time) : [NaN, NaN];
    return {
      speed: 1 / this.right.slowness,
      speedLeft: 1 / this.left.slowness,
      transitionTime: first ? first.time : NaN,
      transitionLength: right - left,
      firstStick: first ? first.x : 0,
    };
  }

  // The right pulse at a time after the first sticking at a position: its front and trailing edge,
  // and the slip there.
  pulse(time, from) {
    const front = this.fronts(time)[1];
    const late = (x) => Math.min(this.stick(x, 1.5 * time), 1.5 * time) - time;
    const edge = rootBetween(late, from, front * (1 - 1e-9));
    return { time, front, edge, width: front - edge, slip: this.slip(edge, time) };
  }
}

// The steady pulse at finite damping, behind its front
//   u = (tau/gamma) (1 - exp(p xi) (cos q xi - p/q sin q xi)),
// where p +- i q are the complex roots of beta v z^3 + (v^2 - 1) z^2 - alpha v z + gamma = 0; null
// where there are none.
function steadyPulse({ right: tau, gamma, beta, alpha = 0 }, speed) {
  const [damping, stiffness, rate] = [beta * speed, speed * speed - 1, alpha * speed];
  let [p, squared] = [0.5 * rate / stiffness, gamma / stiffness];
  if (damping > 0) {
    const cubic = (z) => ((damping * z + stiffness) * z - rate) * z + gamma;
    const reach = (stiffness + Math.sqrt(Math.abs(rate * damping))) / damping
      + Math.cbrt(gamma / damping);
    const real = rootBetween(cubic, -2 * reach, Math.min(0, 0.5 * rate / stiffness));
    [p, squared] = [-0.5 * (stiffness / damping + real), -gamma / (damping * real)];
  }
  if (!(squared > p * p)) return null;
  const q = Math.sqrt(squared - p * p);
  const scale = tau / gamma;
  const decay = (distance) => Math.exp(-p * distance);
  const cosine = (distance) => Math.cos(q * distance) + p / q * Math.sin(q * distance);
  return {
    width: Math.PI / q,
    slip: scale * (1 + Math.exp(-Math.PI * p / q)),
    velocityAt: (distance) => (
      speed * scale * (squared / q) * decay(distance) * Math.sin(q * distance)),
    slipAt: (distance) => scale * (1 - decay(distance) * cosine(distance)),
  };
}

// Return the largest rate term with steady pulses, at which q = 0 without damping.
function criticalRate(gamma, speed) {
  return 2 * Math.sqrt(gamma * (1 - 1 / (speed * speed)));
}
