// Draw pictures as SVG: axes, curves, and the map of slip velocity as an image.

function format(value, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "–";
  const short = Number(value.toPrecision(digits));
  return (Math.abs(short) >= 1e5 ? short.toExponential() : String(short)).replace("-", "−");
}

// Return about `count` round values inside a range.
function ticks(low, high, count = 5) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
  const first = Math.ceil(low / step);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, k) => (first + k) * step);
}

// A picture with axes. It is drawn at the width that the page leaves it, so that text keeps its
// size.
class Picture {
  constructor(element, {
    x,
    y,
    labels,
    height,
    top: above = 12,
    before = 58,
    xTicks = ticks(...x),
    yTicks = ticks(...y),
    position = (value) => value,
    shown = format,
  }) {
    Object.assign(this, { element, height, ranges: [x, y] });
    element.picture = this;
    // Measured once for each page width, since measuring forces the browser to finish its layout.
    element.room ||= element.getBoundingClientRect().width;
    this.width = Math.max(element.room, 40);
    this.box = { left: before, right: this.width - 10, top: above, bottom: height - 42 };
    this.inside = [];
    const { left, right, top, bottom } = this.box;
    const [low, high] = x.map(position);
    this.x = (value) => left + (right - left) * (position(value) - low) / (high - low);
    this.y = (value) => bottom - (bottom - top) * (value - y[0]) / (y[1] - y[0]);
    const xMarks = xTicks.map((tick) => {
      const across = this.x(tick);
      return `<text x="${across}" y="${bottom + 16}" text-anchor="middle">${format(tick)}</text>`
        + `<line class="axis" x1="${across}" x2="${across}" y1="${bottom}" y2="${bottom - 4}"/>`;
    });
    const yMarks = yTicks.map((tick) => {
      const up = this.y(tick);
      return `<text x="${left - 6}" y="${up + 4}" text-anchor="end">${shown(tick)}</text>`
        + `<line class="axis" x1="${left}" x2="${left + 4}" y1="${up}" y2="${up}"/>`;
    });
    const frame = `<path class="axis" d="M${left} ${top}V${bottom}H${right}V${top}Z"/>`;
    const below = `x="${0.5 * (left + right)}" y="${height - 8}"`;
    const beside = `transform="translate(13 ${0.5 * (top + bottom)}) rotate(-90)"`;
    this.outside = frame + xMarks.join("") + yMarks.join("")
      + `<text ${below} text-anchor="middle">${labels[0]}</text>`
      + `<text ${beside} text-anchor="middle">${labels[1]}</text>`;
  }

  // Return the position of the pointer in the units of the axes, which must be linear.
  valuesAt({ clientX, clientY }) {
    const place = this.element.getBoundingClientRect();
    const { left, right, top, bottom } = this.box;
    const across = ((clientX - place.left) * this.width / place.width - left) / (right - left);
    const up = (bottom - (clientY - place.top) * this.height / place.height) / (bottom - top);
    return [across, up].map((part, n) => {
      const [low, high] = this.ranges[n];
      return low + (high - low) * Math.min(Math.max(part, 0), 1);
    });
  }

  // Return points in pixels as text, with one separator within a point and one between points.
  pixels(points, within, between) {
    const rounded = points.map(([x, y]) => [this.x(x).toFixed(1), this.y(y).toFixed(1)]);
    return rounded.map((pair) => pair.join(within)).join(between);
  }

  curve(points, kind) {
    if (points.length < 2) return;
    this.inside.push(`<path class="${kind}" d="M${this.pixels(points, " ", "L")}"/>`);
  }

  area(points, kind) {
    this.inside.push(`<polygon class="${kind}" points="${this.pixels(points, ",", " ")}"/>`);
  }

  dot(x, y, kind = "", radius = kind ? 5 : 4) {
    this.inside.push(`<circle class="${kind}" cx="${this.x(x)}" cy="${this.y(y)}" r="${radius}"/>`);
  }

  // Write a text, with what follows "_" as a subscript.
  write(x, y, text, anchor = "start") {
    const subscript = '<tspan dy="4" font-size="9">$1</tspan><tspan dy="-4"></tspan>';
    const set = text.replace(/_(\w+)/g, subscript);
    this.outside += `<text class="over" x="${x}" y="${y}" text-anchor="${anchor}">${set}</text>`;
  }

  // Place an image between two corners of the axes, clipped to an outline.
  image(address, [x0, x1], [y0, y1], outline) {
    const [left, right, top, bottom] = [this.x(x0), this.x(x1), this.y(y1), this.y(y0)];
    const corners = this.pixels(outline, ",", " ");
    this.inside.push(`<clipPath id="outline"><polygon points="${corners}"/></clipPath>`
      + `<image href="${address}" x="${left}" y="${top}" width="${right - left}"`
      + ` height="${bottom - top}" preserveAspectRatio="none" clip-path="url(#outline)"/>`);
  }

  // Draw a colour scale above the axes.
  scale(colours, text) {
    const { left, right } = this.box;
    // The scale is narrower on a phone, where the text needs the room.
    const wide = Math.min(128, 0.25 * (right - left)) / 64;
    this.outside += Array.from({ length: 64 }, (_, k) => {
      const colour = colours[Math.floor(colours.length * k / 64)];
      return `<rect x="${left + wide * k}" y="6" width="${wide + 0.5}" height="10"`
        + ` fill="rgb(${colour})"/>`;
    }).join("");
    this.write(left + 64 * wide + 8, 15, text);
  }

  // Show the picture with an alternative text. An empty group takes what changes with time.
  show(text) {
    const { left, right, top, bottom } = this.box;
    const clip = `clip-${this.element.id}`;
    this.element.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
    this.element.setAttribute("aria-label", text);
    const box = `<rect x="${left}" y="${top}" width="${right - left}" height="${bottom - top}"/>`;
    const inside = `${this.inside.join("")}<g class="moment"></g>`;
    this.element.innerHTML = `<clipPath id="${clip}">${box}</clipPath>`
      + `<g clip-path="url(#${clip})">${inside}</g>${this.outside}`;
  }
}

// Return columns at evenly spaced positions between the fronts at the end: arrival, the times, slip
// velocities and slips after it, and the end of sliding.
function columns(rupture, end, count = 121) {
  const [low, high] = rupture.fronts(end);
  const half = (count - 1) / 2;
  const found = [];
  for (let k = 0; k < count; k++) {
    const y = low + (high - low) * k / (count - 1);
    if (rupture.symmetric && k > half) {
      found.push({ ...found[count - 1 - k], y });
      continue;
    }
    const { times, values, stick } = rupture.history(y, end);
    const [start, stop] = [Math.min(times[0], end), Math.min(stick, end)];
    found.push({ y, start, stick, stop, times, values, slips: sums(times, values) });
  }
  return found;
}

// Return the slip at each time of a history of slip velocity.
function sums(times, values) {
  let slip = 0;
  return times.map((time, k) => {
    if (k) slip += 0.5 * (values[k] + values[k - 1]) * (time - times[k - 1]);
    return slip;
  });
}

// Return the columns as an image, with time to the right and position upwards. It reaches a few
// pixels beyond the points that slide.
function velocityImage(found, end, largest, colours, pixels = 300) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [pixels, found.length];
  const context = canvas.getContext("2d");
  const image = context.createImageData(pixels, found.length);
  const shades = new Uint32Array(image.data.buffer);
  const margin = 6 * end / pixels;
  found.forEach(({ start, stop, times, values }, k) => {
    let m = 0;
    // The outline is a line to the neighbouring columns, so that it covers part of their times,
    // too.
    const beside = [found[k - 1], found[k + 1]].filter(Boolean);
    const first = Math.min(start, ...beside.map((column) => column.start)) - margin;
    const last = Math.max(stop, ...beside.map((column) => column.stop)) + margin;
    for (let n = 0; n < pixels; n++) {
      const time = (n + 0.5) * end / pixels;
      if (time < first || time > last) continue;
      while (m < times.length - 2 && times[m + 1] < time) m++;
      // A block that sticks at once has the same time twice.
      const fraction = Math.min(Math.max((time - times[m]) / (times[m + 1] - times[m] || 1), 0), 1);
      const value = times.length > 1 ? values[m] + fraction * (values[m + 1] - values[m]) : 0;
      const shade = Math.floor(colours.length * Math.max(value, 0) / largest);
      const [red, green, blue] = colours[Math.min(shade, colours.length - 1)];
      shades[(found.length - 1 - k) * pixels + n] = red | green << 8 | blue << 16 | 255 << 24;
    }
  });
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}

// Interpolate between the given colours, so that no steps are visible.
function smoothed(colours, count = 256) {
  return Array.from({ length: count }, (_, n) => {
    const position = (colours.length - 1) * n / (count - 1);
    const k = Math.min(Math.floor(position), colours.length - 2);
    const next = colours[k + 1];
    return colours[k].map((part, i) => Math.round(part + (position - k) * (next[i] - part)));
  });
}
