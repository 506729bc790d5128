// The structure of a case, drawn while it is edited. Nodes of plane frames are moved, added, joined and deleted by mouse
// or keyboard; three-dimensional structures can be rotated. While positions of channels are picked, edits are disabled.
import { axesOf, drawArrows } from './arrows.js';
import { button, element, number, svg } from './dom.js';
import { allArrows, geometryAsStructure } from './sensors.js';

const coordinates = (place) => (Array.isArray(place) && place.every((x) => typeof x === 'number')
  ? [place[0] ?? 0, place[1] ?? 0, place[2] ?? 0] : null);

// A round step of about a fiftieth of the size.
const roundStep = (size) => {
  const power = 10 ** Math.floor(Math.log10(size / 50));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= size / 50) ?? power;
};

const length = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));
const rounded = (x, step) => Number((Math.round(x / step) * step).toPrecision(12));

export class Drawing {
  // `changed()` is called after an edit of the document, `chosen(pointer)` when a part is picked. With `picked(place)`,
  // the drawing returns positions of channels instead, and `pointed(arrow)` is called when an arrow is clicked.
  constructor(place, { changed, chosen, picked, pointed }) {
    this.place = place;
    this.changed = changed;
    this.chosen = chosen;
    this.picked = picked;
    this.pointed = pointed;
    this.tool = 'move';
    this.azimuth = 0.6;
    this.elevation = 0.35;
  }

  // `named` is the structure of the case that the key geometry names; `arrows` are those of the case by default.
  show(doc, named, arrows) {
    const { structure, beam, geometry } = doc ?? {}, drawn = geometryAsStructure(geometry) ?? named;
    [this.doc, this.named, this.given] = [doc, named, arrows];
    this.arrows = arrows ?? allArrows(doc ?? {}, structure?.nodes ? structure : drawn);
    if (structure?.nodes) return this.frame(structure, '/structure', !this.picked);
    if (structure?.chain) return this.chain(structure.chain);
    if (beam) return this.beam(beam);
    if (drawn) return this.frame(drawn, '/geometry', false);
    if (doc?.models?.[0]?.masses) return this.chain(doc.models[0]);
    this.place.replaceChildren(element('p', { class: 'quiet' }, 'This case has no structure to draw.'));
    return undefined;
  }

  again() { this.show(this.doc, this.named, this.given); }

  // Makes a part of the drawing selectable as a position, by mouse and keyboard.
  pickable(part, name, place) {
    if (!this.picked) return;
    for (const [key, value] of Object.entries({ role: 'button', tabindex: -1, 'aria-label': name })) part.setAttribute(key, value);
    part.classList.add('place');
    const pick = () => { this.last = part.dataset.place; this.picked(place()); };
    part.addEventListener('click', pick);
    part.addEventListener('keydown', (event) => {
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      pick();
    });
  }

  // The Tab key reaches one position; the arrow keys move to the nearest position in their direction.
  roving(picture) {
    if (!this.picked) return;
    const places = [...picture.querySelectorAll('.place')], first = places.find((one) => one.dataset.place === this.last) ?? places[0];
    first?.setAttribute('tabindex', 0);
    picture.addEventListener('keydown', (event) => {
      const along = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key], from = event.target;
      if (!along || !places.includes(from)) return;
      event.preventDefault();
      event.stopPropagation();
      const centre = (part) => { const box = part.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]; };
      const here = centre(from);
      let best = null, least = Infinity;
      for (const one of places) {
        const there = centre(one), ahead = along[0] * (there[0] - here[0]) + along[1] * (there[1] - here[1]);
        const aside = Math.abs(along[1] * (there[0] - here[0]) - along[0] * (there[1] - here[1]));
        if (ahead > 1 && ahead + 3 * aside < least) [best, least] = [one, ahead + 3 * aside];
      }
      if (!best) return;
      from.setAttribute('tabindex', -1);
      best.setAttribute('tabindex', 0);
      this.last = best.dataset.place;
      best.focus();
    });
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
      if (this.picked) {
        if (root === '/structure' && member.name !== undefined) line.addEventListener('click', (event) => this.picked(this.onMember(picture, event, member, nodes, ends)));
      } else line.addEventListener('click', () => {
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
    const origin = flat([0, 0, 0]), tipOf = (vector) => { const [x, y] = flat(vector); return [x - origin[0], y - origin[1]]; };
    picture.append(axesOf([box[0] + (solid ? 30 : 12) * unit, box[1] + box[3] - (solid ? 30 : 14) * unit], { x: tipOf([1, 0, 0]), y: tipOf([0, 1, 0]), ...(solid ? { z: tipOf([0, 0, 1]) } : {}) }, unit));
    drawArrows(picture, this.arrows, { unit, chosen: this.pointed, tipOf,
      spotOf: (place) => (place.member === undefined ? spots.get(place.node) : this.spotOnMember(structure, nodes, spots, place)) });

    const labelled = nodes.length <= 60;
    for (const node of nodes) {
      const [x, y] = spots.get(node.name);
      const dot = svg('circle', { class: `node${this.first === node.name ? ' first' : ''}`, cx: x, cy: y, r: 5 * unit, tabindex: editable && !solid ? 0 : undefined,
        role: editable ? 'button' : undefined, 'aria-label': `node ${node.name} at ${node.at.slice(0, solid ? 3 : 2).map((v) => number(v, 5)).join(', ')} m`, 'data-node': node.name });
      dot.append(svg('title', {}, node.name));
      if (this.picked) {
        const around = svg('circle', { class: 'around', cx: x, cy: y, r: (labelled ? 12 : 7) * unit });
        around.addEventListener('click', () => this.picked({ node: node.name }));
        picture.append(around);
        dot.dataset.place = `node ${node.name}`;
        this.pickable(dot, dot.getAttribute('aria-label'), () => ({ node: node.name }));
      }
      picture.append(dot);
      if (labelled) picture.append(svg('text', { x: x + 8 * unit, y: y - 8 * unit, 'font-size': 13 * unit }, node.name));
      if (editable && !solid) this.handle(dot, node, structure, picture, lines.get(node.name) ?? [], unit);
      else if (!this.picked) dot.addEventListener('click', () => this.chosen(`${root}/nodes/${node.name}`));
    }
    if (solid) this.turnable(picture);
    if (this.picked) this.roving(picture);
    else if (editable && !solid) {
      picture.addEventListener('click', (event) => {
        if (this.tool !== 'node' || event.target !== picture) return;
        const [px, py] = this.point(picture, event);
        this.addNode(structure, [rounded(px, this.step), rounded(-py, this.step)]);
      });
    }
    const tools = editable && !solid ? element('div', { class: 'tools', role: 'radiogroup', 'aria-label': 'Tool' },
      [['move', 'Select and move'], ['node', 'Add nodes'], ['member', 'Join nodes'], ['delete', 'Delete']].map(([tool, text]) =>
        button(text, () => { this.tool = tool; this.first = undefined; this.again(); }, { role: 'radio', 'aria-checked': String(this.tool === tool), class: this.tool === tool ? 'on' : '' }))) : null;
    const help = solid ? 'Drag the drawing or use the arrow keys to turn it.' : editable ? {
      move: `Drag a node, or select a node and use the arrow keys. The grid spacing is ${number(this.step)} m. Click a member to see its keys in the case.`,
      node: `Click the position of the new node. The grid spacing is ${number(this.step)} m.`,
      member: this.first ? `Click the second node of the member from ${this.first}.` : 'Click the two nodes of a member, one after the other.',
      delete: 'Click the node or member to delete.',
    }[this.tool] : '';
    const focused = document.activeElement?.dataset?.node;
    this.place.replaceChildren(...[tools, picture, element('p', { class: 'quiet' }, help)].filter(Boolean));
    if (focused) [...picture.querySelectorAll('.node')].find((dot) => dot.dataset.node === focused)?.focus();
  }

  // The position on a member under the pointer, rounded.
  onMember(picture, event, member, nodes, [a, b]) {
    const ends = member.nodes.map((name) => nodes.find((node) => node.name === String(name)).at), whole = length(...ends);
    const [px, py] = this.point(picture, event), along = [b[0] - a[0], b[1] - a[1]];
    const t = ((px - a[0]) * along[0] + (py - a[1]) * along[1]) / (along[0] ** 2 + along[1] ** 2 || 1);
    return { member: member.name, at: Math.min(rounded(Math.max(0, Math.min(1, t)) * whole, roundStep(whole)), whole) };
  }

  spotOnMember(structure, nodes, spots, place) {
    const member = (structure.members ?? []).find((one) => one.name === place.member), names = (member?.nodes ?? []).map(String);
    const ends = names.map((name) => nodes.find((node) => node.name === name)?.at);
    if (ends.length !== 2 || !ends[0] || !ends[1] || typeof place.at !== 'number') return null;
    const t = place.at / (length(...ends) || 1), [a, b] = names.map((name) => spots.get(name));
    return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
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
        this.again();
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
    this.again();
  }

  turnable(picture) {
    const turn = (a, e) => {
      this.azimuth += a;
      this.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.elevation + e));
      this.again();
      this.place.querySelector('svg')?.focus();
    };
    picture.setAttribute('tabindex', 0);
    // A click moves the pointer a little: it must not turn the drawing away from the node.
    picture.addEventListener('pointerdown', () => { this.dragged = 0; });
    picture.addEventListener('pointermove', (event) => {
      if (event.buttons !== 1) return;
      this.dragged += Math.abs(event.movementX) + Math.abs(event.movementY);
      if (this.dragged > 5) turn(event.movementX / 150, event.movementY / 150);
    });
    picture.addEventListener('keydown', (event) => {
      if (event.target !== picture) return;
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
    const step = roundStep(length), body = picture.firstChild;
    if (this.picked) {
      body.dataset.place = 'beam';
      body.classList.add('pick');
      body.addEventListener('click', (event) => this.picked({ at: Math.min(length, Math.max(0, rounded(length * (this.point(picture, event)[0] - 30) / 580, step))) }));
    }
    drawArrows(picture, this.arrows, { unit: 1, chosen: this.pointed, tipOf: ([u, v]) => [u, -v], spotOf: (place) => (typeof place.at === 'number' ? [x(place.at), 60] : null) });
    const elements = beam.elements ?? 0;
    if (elements > 1 && elements <= 200)
      picture.append(svg('path', { class: 'grid', d: Array.from({ length: elements - 1 }, (ignored, i) => `M${x(length * (i + 1) / elements)} 60v12`).join('') }));
    picture.append(svg('path', { class: 'measure', d: 'M30 112h580M30 106v12M610 106v12' }), svg('text', { x: 320, y: 134, 'font-size': 14, 'text-anchor': 'middle' }, `${number(length, 5)} m`));
    this.place.replaceChildren(picture);
  }

  chain({ masses = [], links = [] }) {
    const count = Math.min(masses.length, 40), height = 60 * (count + 1);
    const y = (mass) => height - 30 - 60 * mass;
    const picture = svg('svg', { class: 'structure', viewBox: `0 0 320 ${height}`, role: this.picked ? 'group' : 'img', 'aria-label': `Chain of ${masses.length} masses` }, svg('path', { class: 'support', d: `M60 ${height - 24}h140v8h-140Z` }));
    picture.style.setProperty('--unit', '1px');
    links.forEach((link, i) => {
      const [a, b] = link.between ?? [];
      if (!(a >= 0 && b >= 0 && a <= count && b <= count)) return;
      const side = 130 + (Math.abs(a - b) > 1 ? 30 : 0);
      picture.append(svg('path', { class: 'spring', d: `M${side} ${y(a)}V${y(b)}` }, svg('title', {}, link.name ?? `link ${i + 1}`)),
        svg('text', { x: side + 10, y: (y(a) + y(b)) / 2 + 5, 'font-size': 13 }, String(link.name ?? '')));
    });
    masses.slice(0, count).forEach((mass, i) => {
      const box = svg('rect', { class: 'mass solid', x: 90, y: y(i + 1) - 12, width: 80, height: 24, 'data-place': `mass ${i + 1}` }, svg('title', {}, `mass ${i + 1}`));
      this.pickable(box, `mass ${i + 1}`, () => ({ mass: i + 1 }));
      picture.append(box, svg('text', { x: 130, y: y(i + 1) + 5, 'font-size': 13, 'text-anchor': 'middle', class: 'onmass' }, typeof mass === 'number' ? `${number(mass)} kg` : String(mass)),
        svg('text', { x: 84, y: y(i + 1) + 5, 'font-size': 13, 'text-anchor': 'end' }, String(i + 1)));
    });
    drawArrows(picture, this.arrows, { unit: 1, chosen: this.pointed, tipOf: ([u, v]) => [u, -v],
      spotOf: ({ mass }, { force }) => (mass >= 1 && mass <= count ? [force ? 70 : 170, y(mass)] : null) });
    this.roving(picture);
    const focused = this.place.contains(document.activeElement) ? document.activeElement.dataset.place : undefined;
    this.place.replaceChildren(picture);
    if (focused) picture.querySelector(`[data-place="${CSS.escape(focused)}"]`)?.focus();
  }
}
