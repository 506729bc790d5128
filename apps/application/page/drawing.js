// The structure of a case, drawn while it is edited. Nodes of plane frames are moved, added, joined and deleted by mouse
// or by keyboard; structures in space can be turned.
import { button, element, number, svg } from './dom.js';

const coordinates = (place) => (Array.isArray(place) && place.every((x) => typeof x === 'number')
  ? [place[0] ?? 0, place[1] ?? 0, place[2] ?? 0] : null);

// A round step of about a fiftieth of the size.
const roundStep = (size) => {
  const power = 10 ** Math.floor(Math.log10(size / 50));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= size / 50) ?? power;
};

const rounded = (x, step) => Number((Math.round(x / step) * step).toPrecision(12));

export class Drawing {
  // `changed()` is called after an edit of the document, `chosen(pointer)` when a part is picked.
  constructor(place, { changed, chosen }) {
    this.place = place;
    this.changed = changed;
    this.chosen = chosen;
    this.tool = 'move';
    this.azimuth = 0.6;
    this.elevation = 0.35;
  }

  show(doc) {
    this.doc = doc;
    const { structure, beam, geometry } = doc ?? {};
    if (structure?.nodes) return this.frame(structure, '/structure', true);
    if (structure?.chain) return this.chain(structure.chain);
    if (beam) return this.beam(beam);
    if (geometry?.nodes) {
      const members = (geometry.lines ?? []).flatMap((line) => line.slice(1).map((to, i) => ({ nodes: [String(line[i]), String(to)] })));
      return this.frame({ nodes: geometry.nodes, members, supports: (geometry.fixed ?? []).map((node) => ({ node: String(node), fix: ['x', 'y'] })),
        dimension: Object.values(geometry.nodes).some((p) => p?.length === 3) ? 3 : 2 }, '/geometry', false);
    }
    if (doc?.models?.[0]?.masses) return this.chain(doc.models[0]);
    this.place.replaceChildren(element('p', { class: 'quiet' }, 'This case has no structure to draw.'));
    return undefined;
  }

  // ------------------------------------------------------------------ frames

  frame(structure, root, editable) {
    const nodes = Object.entries(structure.nodes).map(([name, place]) => ({ name, at: coordinates(place) })).filter((node) => node.at);
    const solid = structure.dimension === 3;
    const flat = (p) => {
      if (!solid) return [p[0], -p[1]];
      const across = p[0] * Math.cos(this.azimuth) - p[1] * Math.sin(this.azimuth);
      const away = p[0] * Math.sin(this.azimuth) + p[1] * Math.cos(this.azimuth);
      return [across, -(p[2] * Math.cos(this.elevation) + away * Math.sin(this.elevation))];
    };
    const spots = new Map(nodes.map((node) => [node.name, flat(node.at)]));
    const xs = [...spots.values()].map((p) => p[0]), ys = [...spots.values()].map((p) => p[1]);
    const low = [Math.min(...xs), Math.min(...ys)], high = [Math.max(...xs), Math.max(...ys)];
    const size = Math.max(high[0] - low[0], high[1] - low[1]) || 1;
    this.step = roundStep(size);
    // The view stays while a node is dragged beyond it, and follows larger changes.
    const pad = 0.15 * size;
    const box = [low[0] - pad, low[1] - pad, (high[0] - low[0]) + 2 * pad, (high[1] - low[1]) + 2 * pad];
    const unit = Math.max(box[2] / 640, box[3] / 420);
    const picture = svg('svg', { class: 'structure', viewBox: box.join(' '), role: 'group', 'aria-label': `Structure of ${nodes.length} nodes and ${(structure.members ?? []).length} members` });
    picture.style.setProperty('--unit', `${unit}px`);
    const lines = new Map();
    (structure.members ?? []).forEach((member, i) => {
      const ends = (member.nodes ?? []).map((name) => spots.get(String(name)));
      if (ends.length !== 2 || !ends[0] || !ends[1]) return;
      const line = svg('line', { x1: ends[0][0], y1: ends[0][1], x2: ends[1][0], y2: ends[1][1], class: 'member', 'data-member': i });
      line.append(svg('title', {}, `${member.name ?? `member ${i + 1}`}: ${member.nodes.join(' – ')}`));
      line.addEventListener('click', () => {
        if (this.tool === 'delete' && editable) {
          structure.members.splice(i, 1);
          this.edited();
        } else this.chosen(`${root}/members/${i}`);
      });
      picture.append(line);
      for (const [k, name] of member.nodes.entries()) {
        if (!lines.has(String(name))) lines.set(String(name), []);
        lines.get(String(name)).push([line, k + 1]);
        const end = member.ends?.[name];
        if (end && end !== 'rigid') {
          const other = ends[1 - k], here = ends[k], length = Math.hypot(other[0] - here[0], other[1] - here[1]) || 1;
          picture.append(svg('circle', { class: 'joint', cx: here[0] + 12 * unit * (other[0] - here[0]) / length, cy: here[1] + 12 * unit * (other[1] - here[1]) / length, r: 4 * unit }));
        }
      }
    });
    for (const spring of structure.springs ?? []) {
      const ends = (spring.nodes ?? []).map((name) => spots.get(String(name)));
      if (ends.length === 2 && ends[0] && ends[1]) picture.append(svg('line', { class: 'spring', x1: ends[0][0], y1: ends[0][1], x2: ends[1][0], y2: ends[1][1] }));
    }
    (structure.supports ?? []).forEach((support) => {
      const spot = spots.get(String(support.node));
      if (!spot) return;
      const [x, y] = spot, s = 9 * unit, clamped = (support.fix ?? []).some((d) => d.startsWith('r'));
      picture.append(svg('path', { class: `support${support.fix ? '' : ' elastic'}`, d: clamped ? `M${x - s} ${y}h${2 * s}v${0.7 * s}h${-2 * s}Z` : `M${x} ${y}l${s} ${1.6 * s}h${-2 * s}Z` },
        svg('title', {}, `support at ${support.node}: ${(support.fix ?? Object.keys(support.stiffness ?? {})).join(', ')}`)));
    });
    for (const mass of structure.masses ?? []) {
      const spot = spots.get(String(mass.node));
      if (spot) picture.append(svg('rect', { class: 'mass', x: spot[0] - 6 * unit, y: spot[1] - 6 * unit, width: 12 * unit, height: 12 * unit }, svg('title', {}, `mass at ${mass.node}`)));
    }
    for (const sensor of this.doc.data?.sensors ?? []) this.arrow(picture, spots.get(String(sensor.node)), sensor.direction, unit, solid ? flat : null);
    for (const record of [this.doc.record, ...(this.doc.records ?? [])])
      for (const channel of record?.channels ?? []) this.arrow(picture, spots.get(String(channel.node)), channel.direction, unit, solid ? flat : null);

    const labelled = nodes.length <= 60;
    for (const node of nodes) {
      const [x, y] = spots.get(node.name);
      const dot = svg('circle', { class: `node${this.first === node.name ? ' first' : ''}`, cx: x, cy: y, r: 5 * unit, tabindex: editable && !solid ? 0 : undefined,
        role: editable ? 'button' : undefined, 'aria-label': `node ${node.name} at ${node.at.slice(0, solid ? 3 : 2).map((v) => number(v, 5)).join(', ')} m`, 'data-node': node.name });
      dot.append(svg('title', {}, node.name));
      picture.append(dot);
      if (labelled) picture.append(svg('text', { x: x + 8 * unit, y: y - 8 * unit, 'font-size': 13 * unit }, node.name));
      if (editable && !solid) this.handle(dot, node, structure, picture, lines.get(node.name) ?? [], unit);
      else dot.addEventListener('click', () => this.chosen(`${root}/nodes/${node.name}`));
    }
    if (solid) this.turnable(picture);
    else if (editable) {
      picture.addEventListener('click', (event) => {
        if (this.tool !== 'node' || event.target !== picture) return;
        const [px, py] = this.point(picture, event);
        this.addNode(structure, [rounded(px, this.step), rounded(-py, this.step)]);
      });
    }
    const tools = editable && !solid ? element('div', { class: 'tools', role: 'radiogroup', 'aria-label': 'Tool' },
      [['move', 'Select and move'], ['node', 'Add nodes'], ['member', 'Join nodes'], ['delete', 'Delete']].map(([tool, text]) =>
        button(text, () => { this.tool = tool; this.first = undefined; this.show(this.doc); }, { role: 'radio', 'aria-checked': String(this.tool === tool), class: this.tool === tool ? 'on' : '' }))) : null;
    const help = solid ? 'Drag the drawing or use the arrow keys to turn it.' : editable ? {
      move: `Drag a node, or focus it and use the arrow keys; the grid is ${number(this.step)} m. Click a member to see its keys.`,
      node: `Click where the node is to be; the grid is ${number(this.step)} m.`,
      member: this.first ? `Click the second node of the member from ${this.first}.` : 'Click the two nodes of a member, one after the other.',
      delete: 'Click a node or a member.',
    }[this.tool] : '';
    const focused = document.activeElement?.dataset?.node;
    this.place.replaceChildren(...[tools, picture, element('p', { class: 'quiet' }, help)].filter(Boolean));
    if (focused) [...picture.querySelectorAll('.node')].find((dot) => dot.dataset.node === focused)?.focus();
  }

  // A sensor's direction.
  arrow(picture, spot, direction, unit, flat) {
    const named = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] }[String(direction ?? '').replace(/^[-+]/, '')];
    if (!spot || !named) return;
    const sign = String(direction).startsWith('-') ? -1 : 1;
    const origin = flat ? flat([0, 0, 0]) : [0, 0];
    const tip = flat ? flat(named) : [named[0], -named[1]];
    const length = 24 * unit * sign;
    picture.append(svg('line', { class: 'sensor', x1: spot[0], y1: spot[1], x2: spot[0] + length * (tip[0] - origin[0]), y2: spot[1] + length * (tip[1] - origin[1]) }));
  }

  point(picture, event) {
    const place = picture.createSVGPoint();
    place.x = event.clientX;
    place.y = event.clientY;
    const { x, y } = place.matrixTransform(picture.getScreenCTM().inverse());
    return [x, y];
  }

  handle(dot, node, structure, picture, lines) {
    const move = (x, y) => {
      dot.setAttribute('cx', x);
      dot.setAttribute('cy', y);
      for (const [line, end] of lines) {
        line.setAttribute(`x${end}`, x);
        line.setAttribute(`y${end}`, y);
      }
    };
    let moved = false;
    dot.addEventListener('pointerdown', (event) => {
      moved = false;
      if (this.tool === 'move') dot.setPointerCapture(event.pointerId);
    });
    dot.addEventListener('pointermove', (event) => {
      if (this.tool !== 'move' || !dot.hasPointerCapture(event.pointerId)) return;
      const [x, y] = this.point(picture, event);
      this.target = [rounded(x, this.step), rounded(-y, this.step)];
      moved = moved || this.target[0] !== node.at[0] || this.target[1] !== node.at[1];
      if (moved) move(this.target[0], -this.target[1]);
    });
    dot.addEventListener('pointerup', () => {
      if (!moved) return;
      structure.nodes[node.name] = this.target;
      this.edited();
    });
    dot.addEventListener('click', () => { if (!moved) this.pick(node.name, structure); });
    dot.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (by) {
        structure.nodes[node.name] = [rounded(node.at[0] + by[0] * this.step, this.step), rounded(node.at[1] + by[1] * this.step, this.step)];
        this.edited();
      } else if (event.key === 'Delete') this.deleteNode(node.name, structure);
      else if (event.key === 'Enter' || event.key === ' ') this.pick(node.name, structure);
      else return;
      event.preventDefault();
    });
  }

  pick(name, structure) {
    if (this.tool === 'delete') this.deleteNode(name, structure);
    else if (this.tool === 'member') {
      if (this.first && this.first !== name) {
        const model = structure.members?.at(-1);
        const { name: ignored, ends, offsets, pieces, ...like } = model ?? { elements: 8, material: Object.keys(structure.materials ?? {})[0] ?? '', section: Object.keys(structure.sections ?? {})[0] ?? '' };
        structure.members = [...(structure.members ?? []), { name: this.freeName('member', new Set((structure.members ?? []).map((m) => m.name))), ...structuredClone(like), nodes: [this.first, name] }];
        this.first = undefined;
        this.edited();
      } else {
        this.first = name;
        this.show(this.doc);
      }
    } else this.chosen(`/structure/nodes/${name}`);
  }

  freeName(stem, taken) {
    let i = taken.size + 1;
    while (taken.has(`${stem} ${i}`)) i += 1;
    return `${stem} ${i}`;
  }

  addNode(structure, place) {
    const taken = new Set(Object.keys(structure.nodes));
    let name = [...'ABCDEFGHIJKLMNOPQRSTUVWXYZ'].find((letter) => !taken.has(letter));
    for (let i = 1; !name; i += 1) if (!taken.has(`N${i}`)) name = `N${i}`;
    structure.nodes[name] = place;
    this.edited();
  }

  deleteNode(name, structure) {
    delete structure.nodes[name];
    for (const key of ['members', 'springs', 'dashpots'])
      if (structure[key]) structure[key] = structure[key].filter((one) => !(one.nodes ?? []).map(String).includes(name));
    for (const key of ['supports', 'masses', 'springs', 'dashpots'])
      if (structure[key]) structure[key] = structure[key].filter((one) => String(one.node ?? '') !== name);
    this.edited();
  }

  edited() {
    this.changed();
    this.show(this.doc);
  }

  turnable(picture) {
    const turn = (a, e) => {
      this.azimuth += a;
      this.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.elevation + e));
      this.show(this.doc);
      this.place.querySelector('svg')?.focus();
    };
    picture.setAttribute('tabindex', 0);
    picture.addEventListener('pointermove', (event) => { if (event.buttons === 1) turn(event.movementX / 150, event.movementY / 150); });
    picture.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15] }[event.key];
      if (!by) return;
      event.preventDefault();
      turn(...by);
    });
  }

  // ------------------------------------------------------------ beams, chains

  beam(beam) {
    const length = typeof beam.length === 'number' && beam.length > 0 ? beam.length : 1;
    const named = { 'simply-supported': [[0, false], [length, false]], cantilever: [[0, true]], 'clamped-clamped': [[0, true], [length, true]],
      'clamped-pinned': [[0, true], [length, false]], 'free-free': [] };
    const supports = Array.isArray(beam.supports) ? beam.supports.filter((s) => typeof s.at === 'number').map((s) => [s.at, (s.fix ?? []).includes('rotation')])
      : named[beam.supports] ?? [];
    const x = (place) => 30 + 580 * (place / length);
    const picture = svg('svg', { class: 'structure', viewBox: '0 0 640 150', role: 'img', 'aria-label': `Beam of ${number(length)} m with ${supports.length} supports` },
      svg('rect', { class: 'body', x: 30, y: 60, width: 580, height: 12 }));
    picture.style.setProperty('--unit', '1px');
    for (const [place, clamped] of supports)
      picture.append(svg('path', { class: 'support', d: clamped ? `M${x(place) - 6} 46h12v40h-12Z` : `M${x(place)} 72l10 16h-20Z` }));
    const damages = [beam.truth, this.doc.damage?.truth].flat().filter((d) => typeof d?.location === 'number');
    for (const damage of damages) picture.append(svg('path', { class: 'joint', d: `M${x(damage.location)} 40v48` }));
    for (const sensor of this.doc.data?.sensors ?? [])
      if (typeof sensor.at === 'number') picture.append(svg('line', { class: 'sensor', x1: x(sensor.at), x2: x(sensor.at), y1: 60, y2: 36 }));
    const elements = beam.elements ?? 0;
    if (elements > 1 && elements <= 200)
      picture.append(svg('path', { class: 'grid', d: Array.from({ length: elements - 1 }, (ignored, i) => `M${x(length * (i + 1) / elements)} 60v12`).join('') }));
    picture.append(svg('path', { class: 'measure', d: 'M30 112h580M30 106v12M610 106v12' }), svg('text', { x: 320, y: 134, 'font-size': 14, 'text-anchor': 'middle' }, `${number(length, 5)} m`));
    this.place.replaceChildren(picture);
  }

  chain({ masses = [], links = [] }) {
    const count = Math.min(masses.length, 40), height = 60 * (count + 1);
    const y = (mass) => height - 30 - 60 * mass;
    const picture = svg('svg', { class: 'structure', viewBox: `0 0 320 ${height}`, role: 'img', 'aria-label': `Chain of ${masses.length} masses` }, svg('path', { class: 'support', d: `M60 ${height - 24}h140v8h-140Z` }));
    picture.style.setProperty('--unit', '1px');
    links.forEach((link, i) => {
      const [a, b] = link.between ?? [];
      if (!(a >= 0 && b >= 0 && a <= count && b <= count)) return;
      const side = 130 + (Math.abs(a - b) > 1 ? 30 : 0);
      picture.append(svg('path', { class: 'spring', d: `M${side} ${y(a)}V${y(b)}` }, svg('title', {}, link.name ?? `link ${i + 1}`)),
        svg('text', { x: side + 10, y: (y(a) + y(b)) / 2 + 5, 'font-size': 13 }, String(link.name ?? '')));
    });
    masses.slice(0, count).forEach((mass, i) => picture.append(svg('rect', { class: 'mass solid', x: 90, y: y(i + 1) - 12, width: 80, height: 24 }),
      svg('text', { x: 130, y: y(i + 1) + 5, 'font-size': 13, 'text-anchor': 'middle', class: 'onmass' }, typeof mass === 'number' ? `${number(mass)} kg` : String(mass))));
    this.place.replaceChildren(picture);
  }
}
