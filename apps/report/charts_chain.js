// Charts of a chain of masses: its drawing, the laws of its links, and their motion and forces.
const chainCharts = (({ number, written, bracketed, unitSystem, slug, short, frame, linear, strokes, tickFormat, dots, dotMark, axisX, axisY }) => {
  // ---- the drawing ------------------------------------------------------------------------
  // A symbol extends from (x, low) up to (x, top); its body has a height of 36 px, centred at m.
  const zigzag = (x, from, to) => {
    const turns = 6, step = (from - to) / turns;
    return `L${x},${from}` + Array.from({ length: turns }, (_, i) => `L${x + (i % 2 ? -5 : 5)},${from - (i + 0.5) * step}`).join('') + `L${x},${to}`;
  };
  const spring = (x, low, top) => { const m = (low + top) / 2; return `M${x},${low}${zigzag(x, m + 18, m - 18)}L${x},${top}`; };
  const dashpot = (x, low, top) => {
    const m = (low + top) / 2;
    return `M${x},${low}L${x},${m + 12}M${x - 8},${m - 8}L${x - 8},${m + 12}L${x + 8},${m + 12}L${x + 8},${m - 8}M${x},${top}L${x},${m + 1}M${x - 6},${m + 1}L${x + 6},${m + 1}`;
  };
  // An arrow across the symbol of a nonlinear law.
  const across = (x, low, top) => { const m = (low + top) / 2; return `M${x - 10},${m + 13}L${x + 10},${m - 13}M${x + 4},${m - 11}L${x + 10},${m - 13}L${x + 9},${m - 6}`; };
  // Two plates that are pressed together and slide on each other.
  const friction = (x, low, top) => {
    const m = (low + top) / 2;
    return `M${x},${low}L${x},${m + 17}L${x - 2},${m + 17}L${x - 2},${m - 11}M${x},${top}L${x},${m - 17}L${x + 2},${m - 17}L${x + 2},${m + 11}`
      + `M${x - 11},${m}L${x - 4},${m}M${x - 7},${m - 3}L${x - 4},${m}L${x - 7},${m + 3}M${x + 11},${m}L${x + 4},${m}M${x + 7},${m - 3}L${x + 4},${m}L${x + 7},${m + 3}`;
  };
  // A stop: a spring after a gap, met from above (closing) or by a hook (opening).
  const stop = (x, low, top, gap, opening) => {
    const m = (low + top) / 2;
    const body = `M${x},${low}${zigzag(x, m + 20, m + 2)}`;
    return opening
      ? `${body}L${x},${m}M${x - 8},${m}L${x + 8},${m}M${x - 8},${m}L${x - 8},${m - 8 - gap}L${x - 3},${m - 8 - gap}M${x + 8},${m}L${x + 8},${m - 8 - gap}L${x + 3},${m - 8 - gap}M${x},${top}L${x},${m - 6}M${x - 5},${m - 6}L${x + 5},${m - 6}`
      : `${body}L${x},${m}M${x - 7},${m}L${x + 7},${m}M${x},${top}L${x},${m - gap}M${x - 7},${m - gap}L${x + 7},${m - gap}`;
  };
  // All other laws: a box, with a loop inside for laws with memory.
  const box = (x, low, top, inside) => { const m = (low + top) / 2; return `M${x},${low}L${x},${m + 13}M${x},${top}L${x},${m - 13}M${x - 10},${m - 13}L${x + 10},${m - 13}L${x + 10},${m + 13}L${x - 10},${m + 13}Z${inside}`; };
  const symbols = {
    stiffness: spring,
    damping: dashpot,
    quadratic: (x, low, top) => spring(x, low, top) + across(x, low, top),
    cubic: (x, low, top) => spring(x, low, top) + across(x, low, top),
    quadratic_damping: (x, low, top) => dashpot(x, low, top) + across(x, low, top),
    coulomb: friction,
    contact: (x, low, top, side) => stop(x, low, top, 8, side !== 'closing'),
    bilinear: (x, low, top, side) => stop(x, low, top, 2, side !== 'closing'),
    bouc_wen: (x, low, top) => { const m = (low + top) / 2; return box(x, low, top, `M${x - 7},${m + 9}C${x - 5},${m - 4} ${x},${m - 8} ${x + 7},${m - 9}C${x + 5},${m + 4} ${x},${m + 8} ${x - 7},${m + 9}`); },
  };
  const symbol = (law, x, low, top) => (symbols[law.key] ? symbols[law.key](x, low, top, law.side)
    : box(x, low, top, `M${x - 7},${(low + top) / 2 + 8}C${x},${(low + top) / 2 + 8} ${x},${(low + top) / 2 - 8} ${x + 7},${(low + top) / 2 - 8}`));

  // The coefficient of an inferred term.
  class OfTerm { constructor(label) { this.label = label; } }
  // "k = 12.3 N/m": inferred values as medians, stated values as in the case.
  const said = (value, unit, found) => {
    const withUnit = (x, u) => number(x) + (written(u) ? ' ' + written(u) : '');
    if (typeof value === 'number') return withUnit(value, unit);
    if (value instanceof OfTerm) return `= ${withUnit(found[value.label]?.q50, found[value.label]?.unit)}`;
    const known = found[value];
    return typeof known?.q50 === 'number' ? `${value} = ${withUnit(known.q50, known.unit)}` : String(value);
  };
  // Converts a unit in N and m to the units of the run; empty if these are not known.
  const inPlaceOf = (si, units) => {
    if (!units.force) return '';
    const factor = (u) => (/^[\p{L}\p{N}]*$/u.test(u) ? u : `(${u})`);
    return si.replace(/[A-Za-z]+/g, (word) => (word === 'N' ? factor(units.force) : word === 'm' ? factor(units.length) : word));
  };
  // The laws of a link as { key, side, words }, in the order of their symbols. `infos`: all laws with
  // the SI units of their coefficients; `inRun` converts these to the units of the run.
  const linkOrder = ['stiffness', 'damping'];
  function lawsOf(link, found, infos, inRun) {
    const keys = Object.keys(link).filter((k) => k !== 'between').sort((a, b) => (linkOrder.indexOf(a) + 1 || 9) - (linkOrder.indexOf(b) + 1 || 9));
    const units = { stiffness: [{ unit: 'N/m' }], damping: [{ unit: 'N s/m' }], ...infos };
    return keys.flatMap((key) => [link[key]].flat().map((law) => {
      const name = key.replace(/_/g, ' ').replace('coulomb', 'Coulomb friction').replace('bouc wen', 'Bouc-Wen');
      const coefficients = units[key] || [];
      if (law === null || typeof law !== 'object' || law instanceof OfTerm) return { key, words: `${name} ${said(law, inRun(coefficients[0]?.unit), found)}` };
      const values = Object.entries(law).filter(([k]) => k !== 'side').map(([k, v]) => `${k} ${said(v, inRun(coefficients.find((c) => c.name === k)?.unit), found)}`);
      return { key, side: law.side, words: `${name}${law.side ? `, ${law.side}` : ''}${values.length ? ': ' : ''}${values.join(', ')}` };
    }));
  }
  // Lines of at most `most` characters, broken at ", " or ": ".
  const pieces = (text) => text.split(/(?<=[,:]) /);
  function wrapped(text, most) {
    const lines = [];
    for (const part of pieces(text)) {
      const last = lines.length - 1;
      if (last >= 0 && lines[last].length + 1 + part.length <= most) lines[last] += ' ' + part;
      else lines.push(lines.length ? '  ' + part : part);
    }
    return lines.map((line) => short(line, most + 2));
  }
  // The base model of a discovery, with the terms of the subset that has this name.
  function withTerms(run, base, name) {
    if (!run.summary.terms || !base) return undefined;
    const labels = name.slice(base.name.length).split(' + ');
    // "contact gap closing 0-2" is the gap of the term "contact closing" of the link 0-2.
    const law = (t) => {
      const [, key, side] = t.name.match(/^(.*?)(?: (opening|closing))?$/);
      const coefficients = Object.keys(t.parameters).map((label) =>
        [label.slice(key.length).replace(/ \d+-\d+$/, '').replace(/ (opening|closing)$/, '').trim(), new OfTerm(label)]);
      const one = coefficients.length === 1 && !side;
      return [key, one ? coefficients[0][1] : { ...(side && { side }), ...Object.fromEntries(coefficients) }];
    };
    const withAdded = (link) => {
      const out = { ...link };
      for (const t of run.summary.terms) {
        if (!labels.includes(t.label) || t.link.join() !== link.between.join()) continue;
        const [key, added] = law(t);
        out[key] = key in out ? [out[key], added].flat() : added;
      }
      return out;
    };
    return { ...base, links: base.links.map(withAdded) };
  }
  function chain(run) {
    const cased = run.summary.wheeltap.case.models || [];
    const best = [...run.summary.models].sort((a, b) => b.probability - a.probability)[0];
    const model = cased.find((m) => m.name === best.name) || withTerms(run, cased[0], best.name);
    if (!model || !Array.isArray(model.masses)) return [];
    const unknowns = run.summary.unknowns?.[best.name] || [];
    const found = Object.fromEntries(Object.entries(run.summary.parameters[best.name] || {}).map(([name, row]) => [name, { ...row, unit: unknowns.find((u) => u.label === name)?.unit }]));
    const units = unitSystem(run), inRun = (si) => inPlaceOf(si || '', units);
    // Links between the same two masses form one drawing.
    const links = [];
    for (const l of model.links || []) {
      const a = Math.min(...l.between), b = Math.max(...l.between);
      const laws = lawsOf(l, found, run.laws || {}, inRun);
      const same = links.find((k) => k.a === a && k.b === b);
      if (same) same.laws.push(...laws);
      else links.push({ a, b, laws, name: l.between.join(' – ') });
    }
    const channels = run.summary.wheeltap.case.record?.channels || [];
    const ground = channels.some((c) => /^base/.test(c?.role || '')) ? 'moving base' : 'ground';
    const grounded = links.some((l) => l.a === 0);
    const masses = model.masses.map((m, i) => `mass ${i + 1}: ${said(m, units.force === 'N' && units.length === 'm' ? 'kg' : inRun('N s^2/m'), found)}`);
    return [{
      id: 'chain', section: 'where', wide: true, title: `The chain of the most probable model, “${short(best.name, 60)}”`,
      caption: `Masses, and links with their force laws. The label of a link names its laws in the order of the symbols from left to right. Inferred values are medians.${grounded ? ` 0 is the ${ground}.` : ''}`,
      table: () => ({ head: ['between', 'laws'], rows: links.map((l) => [l.name, l.laws.map((law) => law.words).join('; ')]) }),
      spec: (width, theme) => {
        // One row per mass, from the ground up. Links that pass a mass are beside the column. All text is to the right
        // of these links, or below them if the width is too small.
        const neighbours = links.filter((l) => l.b - l.a === 1), beside = links.filter((l) => l.b - l.a !== 1);
        const lane = 27, half = Math.max(56, Math.min(width / 4, 3.5 * Math.max(...masses.map((m) => m.length)) + 8), ...neighbours.map((l) => l.laws.length * lane / 2 + 8));
        const right = 4 + 2 * half;
        let x = right + 10;
        for (const l of beside) { l.x = x + l.laws.length * lane / 2; x += l.laws.length * lane + 8; }
        const aside = (beside.length ? x : right) + 12, room = (from) => Math.floor((width - from) / 6.2) - 2;
        const longest = Math.max(...links.flatMap((l) => l.laws.flatMap((law) => pieces(law.words).map((piece) => [...piece].length + 2))));
        const beneath = longest > room(aside), words = beneath ? 4 : aside, most = Math.max(12, room(words));
        const lines = new Map(links.map((l) => [l, [l.name, ...l.laws.flatMap((law) => wrapped(law.words, most))]]));
        const row = beneath ? 92 : Math.max(92, 30 + 13 * Math.max(...links.map((l) => lines.get(l).length)) + (beside.length ? 26 : 0));
        const height = grounded ? row * model.masses.length + 50 : row * (model.masses.length - 1) + 40;
        const yOf = (k) => (grounded ? height - 32 - k * row : height - 20 - (k - 1) * row);
        const drawn = links.map((l) => {
          const middle = l.x || 4 + half, low = yOf(l.a) - (l.a && !l.x ? 15 : 0), top = yOf(l.b) + (l.x ? 0 : 15);
          const at = (i) => middle + (i - (l.laws.length - 1) / 2) * lane;
          const first = at(0), last = at(l.laws.length - 1);
          // The rails between which the symbols lie, and the connections to the masses of a link beside the column.
          const rails = l.x
            ? `M${l.a ? right : right - 2},${low}L${last},${low}M${right},${top}L${last},${top}`
            : l.laws.length > 1 ? `M${first},${low - 5}L${last},${low - 5}M${middle},${low}L${middle},${low - 5}M${first},${top + 5}L${last},${top + 5}M${middle},${top}L${middle},${top + 5}` : '';
          const ends = l.x || l.laws.length < 2 ? [low, top] : [low - 5, top + 5];
          return { path: rails + l.laws.map((law, i) => symbol(law, at(i), ...ends)).join(''), text: lines.get(l), y: (low + top) / 2 - 6.5 * (lines.get(l).length - 1) };
        });
        // Move overlapping texts down.
        let free = beneath ? height + 12 : 0;
        for (const d of [...drawn].sort((a, b) => a.y - b.y)) { d.y = Math.max(d.y, free); free = d.y + 13 * d.text.length + 4; }
        return frame(width, Math.max(height, free), theme, {
          data: [{ name: 'm', values: masses.map((text, i) => ({ y: yOf(i + 1), text })) }, { name: 'l', values: drawn }],
          marks: [
            ...(grounded ? [
              { type: 'rule', encode: { enter: { x: { value: 0 }, x2: { value: beside.some((l) => l.a === 0) ? x : right + 4 }, y: { value: height - 32 }, stroke: { value: theme.ink }, strokeWidth: { value: 2 } } } },
              { type: 'rect', encode: { enter: { x: { value: 0 }, x2: { value: beside.some((l) => l.a === 0) ? x : right + 4 }, y: { value: height - 32 }, y2: { value: height - 25 }, fill: { value: theme.grid } } } },
              { type: 'text', encode: { enter: { x: { value: 4 + half }, y: { value: height - 14 }, align: { value: 'center' }, baseline: { value: 'middle' }, text: { value: ground }, fill: { value: theme.soft } } } },
            ] : []),
            { type: 'path', from: { data: 'l' }, encode: { enter: { path: { field: 'path' }, stroke: { value: theme.main }, strokeWidth: { value: 1.6 }, strokeJoin: { value: 'round' } } } },
            { type: 'text', from: { data: 'l' }, encode: { enter: { x: { value: words }, y: { field: 'y' }, baseline: { value: 'middle' }, text: { field: 'text' }, lineHeight: { value: 13 }, limit: { value: Math.max(60, width - words) } } } },
            { type: 'rect', from: { data: 'm' }, encode: { enter: { x: { value: 4 }, x2: { value: right }, y: { field: 'y', offset: -15 }, y2: { field: 'y', offset: 15 }, fill: { value: theme.paper }, stroke: { value: theme.ink }, cornerRadius: { value: 3 } } } },
            { type: 'text', from: { data: 'm' }, encode: { enter: { x: { value: 4 + half }, y: { field: 'y' }, align: { value: 'center' }, baseline: { value: 'middle' }, text: { field: 'text' }, limit: { value: 2 * half - 8 }, fontSize: { value: 12 } } } },
          ],
        });
      },
    }];
  }

  // The inferred laws of the links: one chart per link, one band per model.
  function laws(run) {
    const found = Object.entries(run.summary.links || {});
    const units = unitSystem(run), [force, length] = [bracketed(units.force), bracketed(units.length)];
    const keys = [...new Set(found.flatMap(([, links]) => links.map((l) => l.between.join(' – '))))];
    // A damper or friction alone has no tension at rest: its chart is force against velocity.
    const pulls = (key) => found.some(([, links]) => links.some((l) => l.between.join(' – ') === key && Object.values(l.tension).flat().some((T) => T !== 0)));
    return keys.filter(pulls).map((key) => {
      const lines = found.flatMap(([model, links]) => links.filter((l) => l.between.join(' – ') === key).map((l) => ({ model, ...l })));
      const values = lines.flatMap((l) => l.extension.map((e, i) => ({ model: l.model, e, a: l.tension['q2.5'][i], m: l.tension.q50[i], b: l.tension['q97.5'][i] })));
      const span = (pick) => [Math.min(...values.map(pick[0])), Math.max(...values.map(pick[1]))];
      const [low, high] = span([(v) => v.a, (v) => v.b]), along = span([(v) => v.e, (v) => v.e]);
      const models = [...new Set(lines.map((l) => l.model))];
      return {
        id: 'law-' + slug(key), section: 'where', group: key, title: 'Law at rest', name: `Law of link ${key}`,
        caption: 'Tension against extension (opening: positive), over the extensions in the record: median and 95 % band.',
        table: () => ({ head: ['model', `extension${length}`, `2.5 %${force}`, `50 %${force}`, `97.5 %${force}`], rows: values.map((v) => [v.model, v.e, v.a, v.m, v.b]) }),
        spec: (width, theme) => frame(width, 170, theme, {
          data: [{ name: 'd', values }],
          scales: [linear('x', along, 'width'), linear('y', low < high ? [low, high] : [low - 1, high + 1], 'height'),
            { name: 'm', type: 'ordinal', domain: models, range: theme.series }],
          axes: [axisX(`extension${length}`, { format: tickFormat(...along) }), axisY(`tension${force}`, { format: tickFormat(low, high) })],
          legends: [strokes(width, models, 'm')],
          marks: [{ type: 'group', from: { facet: { name: 'one', data: 'd', groupby: 'model' } }, marks: [
            { type: 'area', from: { data: 'one' }, encode: { enter: { x: { scale: 'x', field: 'e' }, y: { scale: 'y', field: 'a' }, y2: { scale: 'y', field: 'b' }, fill: { scale: 'm', field: 'model' }, fillOpacity: { value: 0.3 } } } },
            { type: 'line', from: { data: 'one' }, encode: { enter: { x: { scale: 'x', field: 'e' }, y: { scale: 'y', field: 'm' }, stroke: { scale: 'm', field: 'model' }, strokeWidth: { value: 1.8 } } } }] }],
        }),
      };
    });
  }

  // ---- motion and forces of the links -----------------------------------------------------
  // Force against displacement, velocity and both: the motion of the model at its best draw and, if the accelerations
  // are known, the data.
  function loops(run) {
    return (run.draws.link_paths || []).flatMap((link) => {
      const model = link.rows.map(([e, v, T]) => ({ e, v, T }));
      const data = link.rows.filter((r) => r[3] !== null).map(([e, v, , T, measured]) => ({ e: measured ?? e, v, T }));
      const extent = (key, rows) => {
        const values = rows.map((r) => r[key]), low = Math.min(...values), high = Math.max(...values), pad = 0.03 * (high - low) || Math.abs(high) || 1;
        return [low - pad, high + pad];
      };
      const all = [...model, ...data];
      const still = extent('e', model).every((v) => v === model[0].e);
      if (still) return [];
      const units = link.units || {}, [force, length, rate] = [units.tension, units.extension, units.rate].map(bracketed);
      const names = data.length ? ['data', 'model'] : ['model'];
      const thinned = link.rows.length < link.samples ? ` The charts show ${link.rows.length} of ${link.samples} samples.` : '';
      // One introduction for all charts of a link.
      const lead = "Dots of the model: samples of the motion of the best draw of the most probable model." + (data.length
        ? ` Dots of the data: the tension is mass times acceleration minus force, with ${link.differentiated ? 'accelerations from numerical derivatives of the measurements' : 'measured accelerations'} and the masses of this draw. The extension and its rate come from ${link.measured_extension ? 'measured displacements and from velocities of the model' : 'displacements and velocities of the model'}.`
        : ' The record has no accelerations that determine the tension of this link, or these accelerations are too noisy.') + thinned;
      const table = () => ({ head: [`extension${length}`, `rate${rate}`, `tension of the model${force}`, `tension of the data${force}`, `measured extension${length}`], rows: link.rows });
      const loop = (id, title, key, axis, caption) => ({
        id: `${id}-${slug(link.between)}`, section: 'where', group: link.between, lead, title, name: `${title} of link ${link.between}`, caption, table,
        spec: (width, theme) => {
          const x = extent(key, all), y = extent('T', all);
          return frame(width, 220, theme, {
            data: [{ name: 'model', values: dots(model) }, { name: 'data', values: dots(data) }],
            scales: [linear('x', x, 'width'), linear('y', y, 'height'), { name: 'who', type: 'ordinal', domain: names, range: names.map((n) => (n === 'data' ? theme.ink : theme.other)) }],
            axes: [axisX(axis, { format: tickFormat(...x), grid: true }), axisY(`tension${force}`, { format: tickFormat(...y) })],
            legends: data.length ? [strokes(width, names)] : [],
            marks: [...(data.length ? [dotMark('data', key, 'T', theme.ink, 2.6, 0.45)] : []), dotMark('model', key, 'T', theme.other, 1.8, 0.8)],
          });
        },
      });
      // The tension as colour over extension and rate: that of the data if known, otherwise that of the model.
      const shown = data.length ? data : model;
      const top = Math.max(...shown.map((r) => Math.abs(r.T)));
      const map = {
        id: 'restoring-force-' + slug(link.between), section: 'where', group: link.between, title: 'Restoring force', name: `Restoring force of link ${link.between}`,
        caption: `The colour is the tension of the ${data.length ? 'data' : 'model'}. The tension of a spring varies along the extension, the tension of a damper along the rate. Different colours of neighbouring dots indicate a force with memory.`, table,
        spec: (width, theme) => {
          const x = extent('e', shown), y = extent('v', shown), shades = 9;
          const of = (T) => Math.min(shades - 1, Math.floor((T / top + 1) / 2 * shades));
          const series = Array.from({ length: shades }, (_, i) => shown.filter((r) => of(r.T) === i));
          return frame(width, 220, theme, {
            data: series.map((rows, i) => ({ name: 's' + i, values: dots(rows) })),
            scales: [linear('x', x, 'width'), linear('y', y, 'height'), { name: 'force', type: 'linear', domain: [-top, 0, top], range: theme.diverging, interpolate: 'lab' }],
            axes: [axisX(`extension${length}`, { format: tickFormat(...x), grid: true }), axisY(`rate${rate}`, { format: tickFormat(...y) })],
            legends: [{ fill: 'force', type: 'gradient', title: `tension${force}`, gradientLength: Math.min(220, width * 0.5), values: [-top, 0, top], format: tickFormat(-top, top).replace('12', '3') }],
            marks: series.map((_, i) => ({ ...dotMark('s' + i, 'e', 'v', '', 3.4, 0.9) })).map((mark, i) => ({ ...mark, encode: { enter: { ...mark.encode.enter, stroke: { scale: 'force', value: ((i + 0.5) / shades * 2 - 1) * top } } } })),
          });
        },
      };
      return [loop('force-displacement', 'Force and displacement', 'e', `extension${length}`, 'Tension against extension (opening: positive).'),
        loop('force-velocity', 'Force and velocity', 'v', `rate of extension${rate}`, 'Tension against the rate of the extension.'), map];
    });
  }

  return { chain, laws, loops };
})(kit);
