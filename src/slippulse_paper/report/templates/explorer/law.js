// The front law: the speed v of a front that runs into pre-stress tau at b = beta/dx, interpolated
// from a table of ln(tau/(1 - tau)).

// Interpolate a table on an evenly spaced grid that begins at position 0, from the six entries
// around a position.
function between(values, position) {
  const first = Math.min(Math.max(Math.floor(position) - 2, 0), values.length - 6);
  let sum = 0;
  for (let i = 0; i < 6; i++) {
    let weight = 1;
    for (let j = 0; j < 6; j++) if (j !== i) weight *= (position - first - j) / (i - j);
    sum += weight * values[first + i];
  }
  return sum;
}

// Return the index k with values[k] <= target < values[k + 1], for rising values, or for falling
// values with sign -1.
function cell(values, target, sign = 1) {
  let low = 0;
  let high = values.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (sign * values[middle] <= sign * target) low = middle;
    else high = middle;
  }
  return low;
}

// Return the cubic with given values and slopes at the ends of an interval, at a fraction of its
// length.
function hermite(fraction, length, value0, value1, slope0, slope1) {
  const rest = 1 - fraction;
  return rest * rest * ((1 + 2 * fraction) * value0 + fraction * length * slope0)
    + fraction * fraction * ((1 + 2 * rest) * value1 - rest * length * slope1);
}

// Laws that were computed before. Computing one takes longer than using it.
const LAWS = new Map();

// Return 1/v as a function of 1 - tau at one b and release rule. The argument is 1 - tau because
// tau itself would lose digits near the peak.
function frontLaw(table, ratio, release) {
  const key = `${release} ${ratio}`;
  if (!LAWS.has(key)) LAWS.set(key, makeLaw(table, ratio, release));
  return LAWS.get(key);
}

function makeLaw(table, ratio, release) {
  if (ratio === 0) return (rest) => (rest >= 1 ? 1 : Math.sqrt(rest * (2 - rest)));
  const position = Math.asinh(ratio / table.ratio.scale) / table.ratio.step;
  const count = table[release][0].length;
  const { first, step } = table.excess;
  const level = [];
  for (let k = 0; k < count; k++) {
    const column = table[release].map((row) => row[k]);
    level.push(between(column, position));
  }
  // The derivative of ln(v - 1) by level at the inner nodes, from five neighbouring nodes.
  const slope = level.map((_, k) => 12 * step
    / (level[k - 2] - 8 * level[k - 1] + 8 * level[k + 1] - level[k + 2]));
  const inner = level.slice(2, -2);
  const last = inner.length - 1;
  return (rest) => {
    if (rest <= 0) return 0;
    if (rest >= 1) return 1;
    const target = Math.log((1 - rest) / rest);
    const k = cell(inner, target);
    const length = inner[k + 1] - inner[k];
    const low = first + (k + 2) * step;
    const excess = target > inner[last] ? low + step + (target - inner[last]) * slope[last + 2]
      : target < inner[0] ? low + (target - inner[0]) * slope[2]
      : hermite((target - inner[k]) / length, length, low, low + step, slope[k + 2], slope[k + 3]);
    return 1 / (1 + Math.exp(excess));
  };
}
