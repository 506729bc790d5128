// Arrows on a drawing. The arrow of a sensor begins at the sensor; the arrow of a force ends at its point of action.
import { svg } from './dom.js';

const near = 8, far = 36, head = 9; // multiples of a unit of the drawing

// `spot` is the position on the drawing and `tip` the direction there, in the units of the drawing.
const arrowOf = ({ spot, tip, unit, arrow, chosen }) => {
  const group = svg('g', { class: `sensor${arrow.force ? ' force' : ''}${arrow.selected ? ' selected' : ''}`, 'data-number': arrow.number },
    svg('title', {}, arrow.title));
  if (chosen) group.addEventListener('click', chosen);
  const [x, y] = spot, long = Math.hypot(...(tip ?? [0, 0]));
  const label = (dx, dy) => group.append(svg('text', { x: x + dx * unit, y: y + dy * unit + 4.5 * unit, 'font-size': 13 * unit, 'text-anchor': 'middle' }, String(arrow.number)));
  if (!tip) {
    // A rotation: an arc with a head, counterclockwise if it is positive.
    const r = 14 * unit, sign = arrow.vector.startsWith('-') ? -1 : 1;
    group.append(svg('path', { class: 'shaft', d: `M${x + sign * r} ${y}A${r} ${r} 0 1 ${sign > 0 ? 0 : 1} ${x} ${y + r}` }),
      svg('path', { class: 'head', d: `M${x + sign * 7 * unit} ${y + r}l${-sign * 8 * unit} ${-4.5 * unit}v${9 * unit}Z` }));
    label(-20, -16);
  } else if (long < 0.15) {
    // Along the line of sight.
    group.append(svg('circle', { class: 'shaft', cx: x, cy: y, r: 10 * unit }), svg('circle', { class: 'head', cx: x, cy: y, r: 2.5 * unit }));
    label(20, -16);
  } else {
    const [u, v] = tip.map((d) => d / long), sign = arrow.force ? -1 : 1;
    const size = near + (far - near) * Math.max(0.5, Math.min(1, long));
    const at = (d, across = 0) => `${x + (u * d - v * across) * unit} ${y + (v * d + u * across) * unit}`;
    const point = arrow.force ? -near : size, back = point - head;
    group.append(svg('path', { class: 'shaft', d: `M${at(arrow.force ? -size : near)}L${at(back)}` }),
      svg('path', { class: 'head', d: `M${at(point)}L${at(back, 4.5)}L${at(back, -4.5)}Z` }));
    label(sign * u * (size + 10), sign * v * (size + 10));
  }
  return group;
};

// The directions of the axes, at `corner`.
export const axesOf = (corner, tips, unit) => svg('g', { class: 'axes', 'aria-hidden': 'true' }, Object.entries(tips).flatMap(([name, [u, v]]) => {
  const end = [corner[0] + 22 * unit * u, corner[1] + 22 * unit * v], long = Math.hypot(u, v);
  return long < 0.15 ? [] : [svg('path', { d: `M${corner.join(' ')}L${end.join(' ')}` }),
    svg('text', { x: end[0] + 8 * unit * u / long, y: end[1] + (8 * v / long + 4) * unit, 'font-size': 12 * unit, 'text-anchor': 'middle' }, name)];
}));

// Draws arrows. `spotOf(place, arrow)` and `tipOf(vector)` give positions and directions on the drawing.
export const drawArrows = (picture, arrows, { spotOf, tipOf, unit, chosen }) => {
  for (const arrow of arrows) {
    const spot = spotOf(arrow.place, arrow);
    if (!spot || spot.some((x) => !Number.isFinite(x))) continue;
    picture.append(arrowOf({ spot, tip: Array.isArray(arrow.vector) ? tipOf(arrow.vector) : null, unit, arrow, chosen: chosen && (() => chosen(arrow)) }));
  }
};
