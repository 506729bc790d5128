// Axes of the application's plots.
import { svg } from './dom.js';

export const ticks = (low, high, count = 6) => {
  const span = high - low;
  if (!(span > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(span / count));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => span / s <= count) ?? power;
  const out = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * span; k += 1) out.push(Number((k * step).toPrecision(12)));
  return out;
};

// An SVG of this size with both axes; `x` and `y` convert values to coordinates.
export const plot = ({ width, height, xs, ys, xLabel, yLabel, left = 52, bottom = 40, label }) => {
  const x = (value) => left + (width - left - 12) * ((value - xs[0]) / (xs[1] - xs[0] || 1));
  const y = (value) => height - bottom - (height - bottom - 10) * ((value - ys[0]) / (ys[1] - ys[0] || 1));
  const picture = svg('svg', { viewBox: `0 0 ${width} ${height}`, class: 'plot', role: 'img', 'aria-label': label ?? `${yLabel} over ${xLabel}` });
  const grid = [];
  for (const t of ticks(...xs, 8)) {
    grid.push(`M${x(t)} ${height - bottom}v5`);
    const wide = 7 * String(t).length; // of the label, about
    picture.append(svg('text', { x: Math.min(x(t), width - wide / 2), y: height - bottom + 18, 'text-anchor': 'middle' }, String(t)));
  }
  for (const t of ticks(...ys, 6)) {
    grid.push(`M${left} ${y(t)}h-5`);
    picture.append(svg('text', { x: left - 8, y: y(t) + 4, 'text-anchor': 'end' }, Math.abs(t) >= 1e5 || (t !== 0 && Math.abs(t) < 1e-3) ? t.toExponential(0) : String(t)));
  }
  picture.append(svg('path', { class: 'axis', d: `M${left} 10V${height - bottom}H${width - 12}${grid.join('')}` }),
    svg('text', { x: (left + width) / 2, y: height - 4, 'text-anchor': 'middle' }, xLabel),
    svg('text', { transform: `translate(13 ${(height - bottom) / 2}) rotate(-90)`, 'text-anchor': 'middle' }, yLabel));
  const inside = (event) => {
    const place = picture.createSVGPoint();
    place.x = event.clientX;
    place.y = event.clientY;
    const at = place.matrixTransform(picture.getScreenCTM().inverse());
    return { px: at.x, py: at.y, x: xs[0] + (xs[1] - xs[0]) * ((at.x - left) / (width - left - 12)),
      y: ys[0] + (ys[1] - ys[0]) * ((height - bottom - at.y) / (height - bottom - 10)) };
  };
  return { picture, x, y, inside, top: 10, bottom: height - bottom, left, right: width - 12 };
};
