// Modal identification by hand: the stabilisation diagram of a finished modal run, on which poles are chosen.
import { attempt, button, element, number, say, svg } from './dom.js';
import { plot } from './plot.js';
import { start, runList } from './runs.js';
import { written } from './schema.js';
import { exporting } from './export.js';
import { newDamageCase } from './modes_case.js';
import { get, post } from './server.js';
import { shapeView } from './shapes.js';
import { table } from './table.js';

const width = 900, height = 460, reach = 14; // px of the drawing

const product = (a, b) => {
  // |aᴴb|², aᴴa, bᴴb
  let re = 0, im = 0, aa = 0, bb = 0;
  a.real.forEach((ar, i) => {
    const ai = a.imaginary[i], br = b.real[i], bi = b.imaginary[i];
    re += ar * br + ai * bi;
    im += ar * bi - ai * br;
    aa += ar * ar + ai * ai;
    bb += br * br + bi * bi;
  });
  return (re * re + im * im) / (aa * bb || 1);
};

// The shape, rotated in phase to minimise its imaginary parts and scaled to a largest entry of 1.
const principal = ({ real, imaginary }) => {
  let s = 0, c = 0;
  real.forEach((x, i) => { c += x * x - imaginary[i] ** 2; s += 2 * x * imaginary[i]; });
  const angle = -Math.atan2(s, c) / 2;
  const re = real.map((x, i) => x * Math.cos(angle) - imaginary[i] * Math.sin(angle));
  const im = real.map((x, i) => x * Math.sin(angle) + imaginary[i] * Math.cos(angle));
  return { re, im };
};

const drawingOf = (geometry, sensors, poles) => {
  const names = Object.keys(geometry.nodes);
  const motionsOf = (values) => {
    const moved = new Map(names.map((name) => [name, [0, 0, 0]]));
    sensors.forEach((sensor, i) => {
      const own = moved.get(String(sensor.node));
      if (own && sensor.direction) sensor.direction.forEach((d, k) => { own[k] += d * values[i]; });
    });
    return names.map((name) => moved.get(name));
  };
  const modes = poles.map((pole) => {
    const { re, im } = principal(pole.shape);
    const motions = motionsOf(re), quadrature = motionsOf(im);
    const largest = Math.max(...motions.map((m) => Math.hypot(...m))) || 1;
    const scaled = (list) => list.map((m) => m.map((x) => x / largest));
    return { frequency_hz: pole.f, motions: scaled(motions), quadrature: scaled(quadrature) };
  });
  const index = new Map(names.map((name, i) => [name, i]));
  return { dimension: geometry.dimension, drawing: { modes, as: 'as measured at the sensors',
    points: names.map((name) => [0, 1, 2].map((k) => geometry.nodes[name][k] ?? 0)),
    lines: geometry.lines.map((line) => line.map((name) => index.get(String(name)))).filter((line) => line.every((i) => i !== undefined)) } };
};

export const polesView = async (place, name) => {
  const [opened, projects] = await Promise.all([get('case', { name }), get('projects')]);
  const own = projects.cases.find((one) => one.name === name);
  const runsPlace = runList(name);
  if (!own?.result) {
    place.replaceChildren(element('h1', {}, `Poles of ${name}`), element('p', {}, 'Run the case first: the diagram comes from its results.'),
      button('Run', () => attempt(() => start(name)), { class: 'main' }), runsPlace.place, element('p', {}, button('Show the diagram', () => dispatchEvent(new Event('hashchange')))));
    return runsPlace.close;
  }
  const [summary, kept] = await Promise.all([get('result', { name: own.result }), get('result', { name: own.result, file: 'poles.json' })]);
  const doc = JSON.parse(opened.text);
  const setUp = kept.set_ups[0], about = summary.set_ups ? { ...summary.set_ups[0] } : summary;
  if (kept.set_ups.length !== 1 || !setUp.poles.length) {
    place.replaceChildren(element('h1', {}, `Poles of ${name}`), element('p', {}, kept.set_ups.length > 1
      ? 'Each set-up has its own diagram, but a choice of poles needs a single diagram. Use one record, or "merge": "preger".' : 'This method has no stabilisation diagram: use the method ssi-cov.'));
    return runsPlace.close;
  }
  let version = opened.version;
  const poles = setUp.poles.map(([order, f, damping, sd, dampingSd, mode], i) => ({ i, order, f, damping, sd, dampingSd, mode, shape: setUp.shapes[i] }));
  const nearest = (order, f) => poles.filter((p) => p.order === order).sort((a, b) => Math.abs(a.f - f) - Math.abs(b.f - f))[0];
  const chosen = new Set();
  for (const one of doc.poles ?? []) { const p = nearest(one.order, one.frequency); if (p) chosen.add(p.i); }
  const band = about.procedure.band, top = about.procedure.largest_order + 2;
  let view = [...band], cursor = null, drawn, hovered = null, box = null, undo = [];

  const readout = element('p', { class: 'status', role: 'status', 'aria-live': 'polite' });
  const diagram = element('div', { class: 'diagram' }), below = element('div');
  const inWords = (p) => `order ${p.order}: ${number(p.f, 6)} Hz ± ${number(p.sd, 2)}, damping ${number(100 * p.damping, 3)} % ± ${number(100 * p.dampingSd, 2)}`;
  const tell = (p) => { readout.textContent = p ? inWords(p) + (chosen.has(p.i) ? ' (chosen)' : '') : `${chosen.size} poles chosen of ${poles.length}. Click a pole, drag a box around a column of poles, or use the arrow keys and Enter.`; };

  const toggle = (p) => {
    undo.push([...chosen]);
    if (chosen.has(p.i)) chosen.delete(p.i); else chosen.add(p.i);
    tell(p);
    draw();
  };
  // The pole with the smallest uncertainty in a box.
  const best = (inside) => inside.sort((a, b) => (a.sd / a.f) * (a.dampingSd ?? 1) - (b.sd / b.f) * (b.dampingSd ?? 1))[0];

  const draw = () => {
    const focused = diagram.contains(document.activeElement);
    drawn = plot({ width, height, xs: view, ys: [0, top], xLabel: 'frequency [Hz]', yLabel: 'order', label: 'Stabilisation diagram: order of each pole over its frequency' });
    const { picture, x, y } = drawn;
    const { frequencies_hz: f, level_db: level } = about.spectrum;
    const shown = f.map((v, i) => [v, level[i]]).filter(([v]) => v >= view[0] && v <= view[1]);
    if (shown.length > 1) {
      const low = Math.min(...shown.map((p) => p[1])), high = Math.max(...shown.map((p) => p[1]));
      picture.append(svg('path', { class: 'spectrum', d: shown.map(([v, l], i) => `${i ? 'L' : 'M'}${x(v).toFixed(1)} ${y(top * (l - low) / (high - low || 1)).toFixed(1)}`).join('') }));
    }
    for (const p of poles) {
      if (p.f < view[0] || p.f > view[1]) continue;
      const is = chosen.has(p.i);
      if ((p.mode || is) && p.sd !== null) {
        const clip = (v) => Math.max(view[0], Math.min(view[1], v));
        picture.append(svg('line', { class: 'interval', x1: x(clip(p.f - 1.96 * p.sd)), x2: x(clip(p.f + 1.96 * p.sd)), y1: y(p.order), y2: y(p.order) }));
      }
      picture.append(svg('circle', { class: `pole${p.mode ? ' stable' : ''}${is ? ' chosen' : ''}${cursor === p.i ? ' cursor' : ''}`, cx: x(p.f), cy: y(p.order), r: is ? 6 : p.mode ? 3.5 : 2.5 }));
    }
    if (box) picture.append(svg('rect', { class: 'box', x: Math.min(box[0], box[2]), y: Math.min(box[1], box[3]), width: Math.abs(box[2] - box[0]), height: Math.abs(box[3] - box[1]) }));
    picture.setAttribute('tabindex', 0);
    picture.setAttribute('role', 'application');
    picture.setAttribute('aria-roledescription', 'stabilisation diagram');
    listen(picture);
    diagram.replaceChildren(picture);
    if (focused) picture.focus({ preventScroll: true });
    describe();
  };

  const under = (event) => {
    const { px, py } = drawn.inside(event);
    let found = null, least = reach;
    for (const p of poles) {
      const d = Math.hypot(drawn.x(p.f) - px, drawn.y(p.order) - py);
      if (p.f >= view[0] && p.f <= view[1] && d < least) [found, least] = [p, d];
    }
    return found;
  };
  let from = null;
  const listen = (picture) => {
    picture.addEventListener('pointerdown', (event) => { const { px, py } = drawn.inside(event); from = [px, py]; });
    picture.addEventListener('pointermove', (event) => {
      const { px, py } = drawn.inside(event);
      if (from && event.buttons === 1 && Math.hypot(px - from[0], py - from[1]) > 8) {
        box = [...from, px, py];
        let frame = picture.querySelector('.box');
        if (!frame) picture.append(frame = svg('rect', { class: 'box' }));
        for (const [key, value] of Object.entries({ x: Math.min(box[0], px), y: Math.min(box[1], py), width: Math.abs(px - box[0]), height: Math.abs(py - box[1]) })) frame.setAttribute(key, value);
        return;
      }
      const p = under(event);
      if (p !== hovered) { hovered = p; tell(p); }
    });
    picture.addEventListener('pointerup', (event) => {
      if (box) {
        const xs = [box[0], box[2]].sort((a, b) => a - b), ys = [box[1], box[3]].sort((a, b) => a - b);
        const inside = poles.filter((p) => drawn.x(p.f) >= xs[0] && drawn.x(p.f) <= xs[1] && drawn.y(p.order) >= ys[0] && drawn.y(p.order) <= ys[1]);
        box = null;
        from = null;
        const p = best(inside);
        if (p && !chosen.has(p.i)) toggle(p); else draw();
        return;
      }
      from = null;
      const p = under(event);
      if (p) { cursor = p.i; toggle(p); }
    });
    picture.addEventListener('keydown', (event) => {
      const now = poles[cursor] ?? null;
      const visible = poles.filter((p) => p.f >= view[0] && p.f <= view[1]);
      let next;
      if (!now && event.key.startsWith('Arrow')) [next] = visible.filter((p) => p.mode).concat(visible);
      else if (event.key === 'ArrowRight') next = visible.filter((p) => p.order === now.order && p.f > now.f).sort((a, b) => a.f - b.f)[0];
      else if (event.key === 'ArrowLeft') next = visible.filter((p) => p.order === now.order && p.f < now.f).sort((a, b) => b.f - a.f)[0];
      else if (event.key === 'ArrowUp' || event.key === 'ArrowDown') next = nearest(now.order + (event.key === 'ArrowUp' ? 2 : -2), now.f);
      else if ((event.key === 'Enter' || event.key === ' ') && now) toggle(now);
      else return;
      event.preventDefault();
      if (next) { cursor = next.i; tell(next); draw(); }
    });
  };

  // Table, assurance criteria and shapes of the choice.
  const describe = () => {
    const list = [...chosen].map((i) => poles[i]).sort((a, b) => a.f - b.f);
    if (!list.length) {
      below.replaceChildren();
      return;
    }
    const rows = list.map((p, k) => [String(k + 1), String(p.order), `${number(p.f, 6)} ± ${number(p.sd, 2)}`, `${number(100 * p.damping, 3)} ± ${number(100 * p.dampingSd, 2)}`,
      button('remove', () => toggle(p), { class: 'plain', 'aria-label': `Remove the pole at ${number(p.f, 5)} Hz` })]);
    const mac = list.map((a, k) => [String(k + 1), ...list.map((b) => {
      const value = product(a.shape, b.shape);
      return element('span', { class: value > 0.5 ? 'mac high' : value > 0.2 ? 'mac middle' : 'mac' }, value.toFixed(2));
    })]);
    const shapes = summary.geometry && setUp.sensors.some((s) => s.direction && s.node) ? shapeView(drawingOf(summary.geometry, setUp.sensors, list), element) : bars(list);
    below.replaceChildren(element('div', { class: 'columns' },
      element('div', {}, table('Chosen poles, with one standard deviation', ['mode', 'order', 'f [Hz]', 'damping [%]', 'action'], rows),
        element('p', { class: 'tools' }, exporting.csvButton(`Chosen poles of ${name}`, () => [['mode', 'order', 'frequency [Hz]', 'sd [Hz]', 'damping', 'sd'], ...list.map((p, k) => [k + 1, p.order, p.f, p.sd, p.damping, p.dampingSd])])),
        table('MAC between the chosen shapes', ['mode', ...list.map((p, k) => String(k + 1))], mac)), shapes));
  };
  const bars = (list) => element('div', {}, element('h3', {}, 'Shapes'), list.map((p) => {
    const { re } = principal(p.shape), largest = Math.max(...re.map(Math.abs)) || 1;
    const picture = svg('svg', { class: 'bars', viewBox: `0 0 ${Math.max(12 * re.length, 60)} 44`, role: 'img', 'aria-label': `Shape at ${number(p.f, 5)} Hz: ${setUp.sensors.map((s, i) => `${s.name} ${number(re[i] / largest, 2)}`).join(', ')}` },
      re.map((v, i) => svg('rect', { x: 12 * i + 2, width: 8, y: 22 - Math.max(0, 20 * v / largest), height: Math.max(0.5, 20 * Math.abs(v) / largest) }, svg('title', {}, `${setUp.sensors[i].name}: ${number(v / largest, 3)}`))));
    return element('figure', {}, element('figcaption', {}, `${number(p.f, 5)} Hz`), picture);
  }));

  const save = () => attempt(async () => {
    const list = [...chosen].map((i) => poles[i]).sort((a, b) => a.f - b.f);
    if (list.length) doc.poles = list.map((p) => ({ order: p.order, frequency: Number(p.f.toPrecision(6)) }));
    else delete doc.poles;
    version = (await post('save', { name, text: `${written(doc)}\n`, before: version })).version;
    say(list.length ? `${list.length} poles saved in the case.` : 'The case now lists no poles: the next run chooses the poles automatically.');
    return true;
  });
  const set = (list) => { undo.push([...chosen]); chosen.clear(); list.forEach((p) => chosen.add(p.i)); tell(); draw(); };
  const limit = (k, label) => {
    const input = element('input', { class: 'number', inputmode: 'decimal', value: number(view[k], 5), 'aria-label': label, onchange: () => {
      const x = Number(input.value.replace(',', '.')), next = view.map((v, i) => (i === k ? x : v));
      if (Number.isFinite(x) && next[0] < next[1]) { view = next; draw(); }
      input.value = number(view[k], 5);
    } });
    return input;
  };
  place.replaceChildren(element('h1', {}, `Poles of ${name}`),
    element('div', { class: 'buttons' }, button('Save the choice', save, { class: 'main' }), button('Save and run', () => attempt(async () => { if (await save()) await start(name); }), { id: 'save-run' }),
      button('Automatic choice', () => set((about.modes ?? []).map((m) => nearest(m.order, m.frequency_hz)).filter(Boolean))), button('Clear', () => set([])),
      button('Undo', () => { if (undo.length) { const old = undo.pop(); chosen.clear(); old.forEach((i) => chosen.add(i)); tell(); draw(); } }),
      element('label', { class: 'inline' }, 'From ', limit(0, 'Lowest frequency shown'), ' to ', limit(1, 'Highest frequency shown'), ' Hz'),
      element('a', { href: `#/case/${encodeURIComponent(name)}` }, 'Edit the case'), element('a', { href: `#/result/${encodeURIComponent(own.result)}` }, 'Results'),
      button('New damage case from these modes …', () => newDamageCase(own.result), { title: 'From the modes of the last run' })),
    readout, diagram, element('p', { class: 'tools' }, exporting.figureButtons(`Stabilisation diagram of ${name}`, () => exporting.svgOf(diagram.querySelector('svg')))),
    element('p', { class: 'quiet' }, 'Large dots are the chosen poles. Blue dots are poles of an automatically chosen mode, with 95 % intervals. The line is the spectrum of the record in decibels.'), below, runsPlace.place);
  tell();
  draw();
  return runsPlace.close;
};
