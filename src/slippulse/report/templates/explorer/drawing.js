// Pictures as SVG: axes, curves, and the map of slip velocity as an image between them.

const PARTS = 32;

function format(value, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "–";
  const short = Number(value.toPrecision(digits));
  return (Math.abs(short) >= 1e5 ? short.toExponential() : String(short)).replace("-", "−");
}

// Round values inside a range, about this many.
function ticks(low, high, count = 5) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
  const first = Math.ceil(low / step);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => (first + k) * step);
}

// A picture with axes, as wide as the page leaves it so that its letters keep their size.
class Picture {
  constructor(element, { x, y, labels, height, top: above = 12, xTicks = ticks(...x), position = (value) => value }) {
    this.element = element;
    this.width = Math.max(element.parentElement.clientWidth - 24, 240);
    this.height = height;
    this.box = { left: 58, right: this.width - 10, top: above, bottom: height - 42 };
    this.inside = [];
    const { left, right, top, bottom } = this.box;
    const [low, high] = x.map(position);
    this.x = (value) => left + (right - left) * (position(value) - low) / (high - low);
    this.y = (value) => bottom - (bottom - top) * (value - y[0]) / (y[1] - y[0]);
    const marks = [
      ...xTicks.map((tick) => `<text x="${this.x(tick)}" y="${bottom + 16}" text-anchor="middle">${format(tick)}</text>`
        + `<line class="axis" x1="${this.x(tick)}" x2="${this.x(tick)}" y1="${bottom}" y2="${bottom - 4}"/>`),
      ...ticks(...y).map((tick) => `<text x="${left - 6}" y="${this.y(tick) + 4}" text-anchor="end">${format(tick)}</text>`
        + `<line class="axis" x1="${left}" x2="${left + 4}" y1="${this.y(tick)}" y2="${this.y(tick)}"/>`),
    ];
    this.outside = `<path class="axis" d="M${left} ${top}V${bottom}H${right}V${top}Z"/>${marks.join("")}`
      + `<text x="${0.5 * (left + right)}" y="${height - 8}" text-anchor="middle">${labels[0]}</text>`
      + `<text transform="translate(13 ${0.5 * (top + bottom)}) rotate(-90)" text-anchor="middle">${labels[1]}</text>`;
  }

  curve(points, kind) {
    const path = points.map(([x, y]) => `${this.x(x).toFixed(1)} ${this.y(y).toFixed(1)}`).join("L");
    if (points.length > 1) this.inside.push(`<path class="${kind}" d="M${path}"/>`);
  }

  area(points, kind) {
    const corners = points.map(([x, y]) => `${this.x(x).toFixed(1)},${this.y(y).toFixed(1)}`).join(" ");
    this.inside.push(`<polygon class="${kind}" points="${corners}"/>`);
  }

  dot(x, y, kind = "") {
    this.inside.push(`<circle class="${kind}" cx="${this.x(x)}" cy="${this.y(y)}" r="${kind ? 5 : 4}"/>`);
  }

  write(x, y, text, anchor = "start") {
    this.outside += `<text class="over" x="${x}" y="${y}" text-anchor="${anchor}">${text}</text>`;
  }

  // An image between two corners of the axes, cut along an outline.
  image(address, [x0, x1], [y0, y1], outline) {
    const points = outline.map(([x, y]) => `${this.x(x).toFixed(1)},${this.y(y).toFixed(1)}`).join(" ");
    this.inside.push(`<clipPath id="outline"><polygon points="${points}"/></clipPath>`
      + `<image href="${address}" x="${this.x(x0)}" y="${this.y(y1)}" width="${this.x(x1) - this.x(x0)}"`
      + ` height="${this.y(y0) - this.y(y1)}" preserveAspectRatio="none" clip-path="url(#outline)"/>`);
  }

  // A scale of colours above the axes.
  scale(colours, text) {
    const { left, right } = this.box;
    // On a phone there must be room for the text.
    const wide = Math.min(4, 0.25 * (right - left) / colours.length);
    this.outside += colours.map((colour, k) => `<rect x="${left + wide * k}" y="6" width="${wide + 0.5}" height="10"`
      + ` fill="rgb(${colour})"/>`).join("");
    this.write(left + wide * colours.length + 8, 15, text);
  }

  // Show it; what it says is its alternative text.
  show(text) {
    const { left, right, top, bottom } = this.box;
    const clip = `clip-${this.element.id}`;
    this.element.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
    this.element.setAttribute("aria-label", text);
    this.element.innerHTML = `<clipPath id="${clip}"><rect x="${left}" y="${top}" width="${right - left}"`
      + ` height="${bottom - top}"/></clipPath><g clip-path="url(#${clip})">${this.inside.join("")}</g>${this.outside}`;
  }
}

// At even positions between the fronts of a time: arrival, end of sliding, and slip velocity at even steps between.
function columns(rupture, end, count = 181) {
  const [low, high] = rupture.fronts(end);
  const half = (count - 1) / 2;
  const found = [];
  for (let k = 0; k < count; k++) {
    const y = low + (high - low) * k / (count - 1);
    if (rupture.symmetric && k > half) {
      found.push({ ...found[count - 1 - k], y });
      continue;
    }
    const start = rupture.arrival(y);
    const stick = rupture.stick(y, end);
    const stop = Math.min(stick, end);
    const velocity = Array.from({ length: PARTS + 1 }, (_, n) => (
      n === 0 || stop <= start ? 0 : Math.max(rupture.velocity(y, start + (stop - start) * n / PARTS), 0)));
    found.push({ y, start, stick, stop, velocity });
  }
  return found;
}

// The columns as an image, time to the right and position upward; a few pixels beyond where anything slides.
function velocityImage(found, end, largest, colours, pixels = 300) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [pixels, found.length];
  const context = canvas.getContext("2d");
  const image = context.createImageData(pixels, found.length);
  const margin = 6 * end / pixels;
  found.forEach(({ start, stop, velocity }, k) => {
    for (let n = 0; n < pixels; n++) {
      const time = (n + 0.5) * end / pixels;
      if (time < start - margin || time > stop + margin) continue;
      const fraction = PARTS * Math.min(Math.max((time - start) / (stop - start), 0), 0.999);
      const low = Math.floor(fraction);
      const value = velocity[low] + (fraction - low) * (velocity[low + 1] - velocity[low]);
      const colour = colours[Math.min(Math.floor(colours.length * value / largest), colours.length - 1)];
      image.data.set([...colour, 255], 4 * ((found.length - 1 - k) * pixels + n));
    }
  });
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}
