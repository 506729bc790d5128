// Charts of damage: location, severity, predicted and measured frequencies, emulator errors.
const damageCharts = (({ probability, slug, circles, frame, linear, powersOfTen, axisX, axisY, heat, cellTable }) => {
  function beam(run, kind, inclusion, several) {
    const { length, supports } = run.summary.beam;
    const step = length / inclusion.length;
    const truth = (kind.truth || []).map((t) => ({ x: t.location }));
    const top = Math.max(...inclusion, 1e-9);
    return {
      id: 'where' + (several ? '-' + slug(kind.name) : ''), section: 'where', wide: true,
      title: several ? `Location of ${kind.plural}` : `Location of ${kind.plural} along the beam`,
      caption: `Expected number of ${kind.plural} in each element, averaged over all models, above the beam (length to scale) and its supports.${truth.length ? ' Arrows: true locations in the simulated data.' : ''}`,
      table: () => ({ head: ['element', 'from [m]', 'to [m]', `expected ${kind.plural}`], rows: inclusion.map((p, e) => [e, e * step, (e + 1) * step, p]) }),
      spec: (width, theme) => frame(width, 182, theme, {
        data: [
          { name: 'e', values: inclusion.map((p, e) => ({ p, from: e * step, to: (e + 1) * step })) },
          { name: 's', values: supports.map((s) => ({ ...s, clamp: s.deflection && s.rotation, spring: typeof s.stiffness === 'number' })) },
          { name: 't', values: truth },
        ],
        scales: [linear('x', [0, length], 'width'), linear('y', [0, top], [138, 14]),
          linear('heat', [0, top], [theme.grid, theme.main], { interpolate: 'rgb' })],
        axes: [axisX('position along the beam [m]', { offset: 2 }), axisY('expected number', { tickCount: 3 })],
        marks: [
          { type: 'rect', from: { data: 'e' }, encode: { enter: { x: { scale: 'x', field: 'from' }, x2: { signal: "max(scale('x', datum.to), scale('x', datum.from) + 1)" },
            y: { scale: 'y', field: 'p' }, y2: { scale: 'y', value: 0 }, fill: { value: theme.main },
            tooltip: { signal: "format(datum.from, '.4~g') + ' to ' + format(datum.to, '.4~g') + ' m: ' + format(datum.p, '.3~g')" } } } },
          { type: 'rect', from: { data: 'e' }, encode: { enter: { x: { scale: 'x', field: 'from' }, x2: { signal: "scale('x', datum.to) + 0.3" },
            y: { value: 148 }, height: { value: 11 }, fill: { scale: 'heat', field: 'p' } } } },
          { type: 'rect', encode: { enter: { x: { value: 0 }, width: { signal: 'width' }, y: { value: 148 }, height: { value: 11 }, stroke: { value: theme.soft }, fill: { value: null } } } },
          { type: 'symbol', from: { data: 's' }, encode: { enter: { x: { scale: 'x', field: 'at' }, y: { signal: 'datum.clamp ? 153.5 : 167' },
            shape: { signal: "datum.clamp ? 'M-0.12,-1L0.12,-1L0.12,1L-0.12,1Z' : datum.spring ? 'diamond' : 'triangle-up'" },
            size: { signal: 'datum.clamp ? 900 : 130' }, fill: { value: theme.ink } } } },
          { type: 'symbol', from: { data: 't' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { value: 7 }, shape: { value: 'triangle-down' }, size: { value: 80 }, fill: { value: theme.other } } } },
        ],
      }),
    };
  }

  // A plane structure or chain (three-dimensional: an oblique view), with cells coloured by the expected number of
  // defects.
  function structure(run, kind, inclusion, several) {
    const of = run.summary.structure, line = of.lines[kind.name];
    const view = (at) => of.dimension === 3
      ? [at[0] * 0.866 - at[1] * 0.866, at[0] * 0.35 + at[1] * 0.35 + at[2]] : [at[0], at[1]];
    const nodes = of.nodes ? of.nodes.map((n) => view(n.at)) : [[0, 0], ...of.masses.map((m, i) => [0, i + 1])];
    const bars = of.members ? of.members.map((m) => m.nodes) : of.links.map((l) => l.between);
    const cells = [], points = [];
    line.stretches.forEach((s, i) => {
      const end = i + 1 < line.stretches.length ? line.stretches[i + 1].first_cell : inclusion.length;
      const n = end - s.first_cell;
      for (let c = s.first_cell; c < end; c += 1) {
        const what = { p: inclusion[c], name: s.name };
        if (line.of === 'node') { points.push({ ...what, x: nodes[s.site][0], y: nodes[s.site][1] }); continue; }
        if (s.members) { // a group of members, each over its whole length
          s.members.forEach((m) => {
            const [a, b] = bars[m].map((k) => nodes[k]);
            cells.push({ ...what, x: a[0], y: a[1], x2: b[0], y2: b[1] });
          });
          continue;
        }
        const [a, b] = bars[s.site].map((k) => nodes[k]);
        const on = (share) => [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
        const from = on((c - s.first_cell) / n), to = on((c + 1 - s.first_cell) / n);
        cells.push({ ...what, x: from[0], y: from[1], x2: to[0], y2: to[1] });
      }
    });
    const xs = nodes.map((n) => n[0]), ys = nodes.map((n) => n[1]);
    const low = [Math.min(...xs), Math.min(...ys)], size = [Math.max(...xs) - low[0], Math.max(...ys) - low[1]];
    const top = Math.max(...inclusion, 1e-9);
    const held = (of.supports || []).map((s) => ({ x: nodes[s.node][0], y: nodes[s.node][1] }));
    const total = line.stretches.map((s, i) => [s.name, inclusion.slice(s.first_cell,
      i + 1 < line.stretches.length ? line.stretches[i + 1].first_cell : inclusion.length).reduce((a, b) => a + b, 0)]);
    return {
      id: 'where' + (several ? '-' + slug(kind.name) : ''), section: 'where', wide: true,
      title: `Location of ${kind.plural}`,
      caption: `The structure${of.dimension === 3 ? ' in an oblique view' : ''}; darker colours mean a larger expected number of ${kind.plural}, averaged over all models (at most ${top.toPrecision(2)} in one ${line.of === 'member' ? 'element' : line.of}).`,
      table: () => ({ head: [line.of, `expected ${kind.plural}`], rows: total }),
      spec: (width, theme) => {
        const height = Math.min(360, Math.max(140, size[0] > 0 ? width * size[1] / size[0] : 240));
        const scale = Math.min((width - 60) / (size[0] || 1), (height - 60) / (size[1] || 1));
        const place = (x, y) => ({ x: width / 2 + (x - low[0] - size[0] / 2) * scale, y: height / 2 - (y - low[1] - size[1] / 2) * scale });
        const flat = (c) => { const a = place(c.x, c.y), b = place(c.x2, c.y2); return { p: c.p, name: c.name, x: a.x, y: a.y, x2: b.x, y2: b.y }; };
        const all = bars.map(([a, b]) => flat({ x: nodes[a][0], y: nodes[a][1], x2: nodes[b][0], y2: nodes[b][1] }));
        const rule = (data, width_, stroke) => ({ type: 'rule', from: { data }, encode: { enter: { x: { field: 'x' }, y: { field: 'y' }, x2: { field: 'x2' }, y2: { field: 'y2' },
          strokeWidth: { value: width_ }, strokeCap: { value: 'round' }, stroke } } });
        const cell = rule('cells', 7, { scale: 'heat', field: 'p' });
        cell.encode.enter.tooltip = { signal: "datum.name + ': ' + format(datum.p, '.3~g')" };
        return frame(width, height, theme, {
          data: [{ name: 'bars', values: all }, { name: 'cells', values: cells.map(flat) },
            { name: 'points', values: points.map((p) => ({ ...p, ...place(p.x, p.y) })) },
            { name: 'held', values: held.map((h) => place(h.x, h.y)) },
            { name: 'nodes', values: nodes.map(([x, y], i) => ({ ...place(x, y), name: of.nodes ? of.nodes[i].name : i === 0 ? 'ground' : String(i) })) }],
          scales: [linear('heat', [0, Math.max(top, 0.2)], [theme.grid, theme.main], { interpolate: 'rgb' })],
          axes: [],
          marks: [rule('bars', 9, { value: theme.soft }), rule('bars', 7, { value: theme.grid }), cell,
            { type: 'symbol', from: { data: 'held' }, encode: { enter: { x: { field: 'x' }, y: { signal: 'datum.y + 12' }, shape: { value: 'triangle-up' }, size: { value: 130 }, fill: { value: theme.ink } } } },
            { type: 'symbol', from: { data: 'points' }, encode: { enter: { x: { field: 'x' }, y: { field: 'y' }, size: { value: 220 }, fill: { scale: 'heat', field: 'p' }, stroke: { value: theme.soft },
              tooltip: { signal: "datum.name + ': ' + format(datum.p, '.3~g')" } } } },
            { type: 'text', from: { data: 'nodes' }, encode: { enter: { x: { signal: 'datum.x + 8' }, y: { signal: 'datum.y - 8' }, text: { field: 'name' }, fill: { value: theme.soft }, fontSize: { value: 11 } } } }],
        });
      },
    };
  }

  function jointFigures(run) {
    const out = [];
    for (const joint of run.draws.joint || []) {
      const kind = run.summary.kinds.find((k) => k.name === joint.kind);
      const given = joint.views.filter((v) => v.count > 0);
      const views = given.length > 1 ? joint.views : given.length ? given : joint.views;
      const fraction = joint.share;
      for (const view of views) {
        const of = view.count ? `given ${view.count} ${view.count === 1 ? kind.name : kind.plural} (${probability(view.probability)})` : 'all counts together';
        const yName = fraction ? 'stiffness reduced by' : joint.severity;
        out.push({
          id: `severity-and-location-${slug(kind.name)}-${view.count || 'all'}`, section: 'where', wide: true,
          title: `Severity and location, ${of}`,
          caption: view.count ? '' : `Expected number of ${kind.plural} per metre and unit of ${joint.severity}. Separate regions are different explanations of the same data, such as a location and its mirror image.`,
          table: () => cellTable('location [m]', joint.severity, joint.bins_x, joint.bins_y, view.cells),
          spec: (width, theme) => heat(width, width < 480 ? 190 : 230, theme, {
            x: joint.bins_x, y: joint.bins_y, cells: view.cells, root: true, xTitle: 'location [m]', yTitle: yName, yFormat: fraction ? '%' : undefined,
            legend: 'density' }),
        });
      }
    }
    return out;
  }

  function residuals(run) {
    const rows = (run.draws.predictive?.frequency || []).filter((r) => typeof r.observed === 'number');
    if (!rows.length) return [];
    const bySd = rows.every((r) => typeof r.sd === 'number' && r.sd > 0);
    const scaled = (r, f) => (f - r.observed) / (bySd ? r.sd : r.observed);
    const values = rows.map((r) => {
      const [a, b, c, d, e] = r.quantiles.map((q) => scaled(r, q));
      return { mode: r.mode, a, b, c, d, e };
    });
    const extent = 1.08 * Math.max(...values.flatMap((v) => [Math.abs(v.a), Math.abs(v.e)]));
    return [{
      id: 'frequency-residuals', section: 'fit', wide: true, title: 'Replicated minus measured frequencies',
      caption: `Bars: the frequencies that the models predict for a noisy measurement, minus the measured frequency (thick 50 %, thin 95 %, stroke the median). ${bySd ? 'The unit is the standard deviation of the measured frequency' : 'The differences are relative to the measured frequency'}. If a bar does not cross the line at zero, the models do not explain that mode.`,
      table: () => ({ head: ['mode', 'measured [Hz]', 'sd [Hz]', '2.5 % [Hz]', '25 % [Hz]', '50 % [Hz]', '75 % [Hz]', '97.5 % [Hz]'], rows: rows.map((r) => [r.mode, r.observed, r.sd, ...r.quantiles]) }),
      spec: (width, theme) => frame(width, 200, theme, {
        data: [{ name: 'r', values }],
        scales: [{ name: 'x', type: 'point', domain: values.map((v) => v.mode), range: 'width', padding: 0.6 }, linear('y', [-extent, extent], 'height')],
        axes: [{ orient: 'bottom', scale: 'x', title: 'mode', domain: false, ticks: false, labelOverlap: true }, axisY(bySd ? 'standard deviations' : 'relative', { format: bySd ? undefined : '.2~%', tickCount: 5 })],
        marks: [
          { type: 'rule', encode: { enter: { x: { value: 0 }, x2: { signal: 'width' }, y: { scale: 'y', value: 0 }, stroke: { value: theme.other }, strokeWidth: { value: 2 } } } },
          ...[['a', 'e', 2], ['b', 'd', 7]].map(([from, to, w]) => ({ type: 'rule', from: { data: 'r' }, encode: { enter: { x: { scale: 'x', field: 'mode' }, y: { scale: 'y', field: from }, y2: { scale: 'y', field: to }, stroke: { value: theme.main }, strokeWidth: { value: w }, strokeOpacity: { value: w > 5 ? 0.6 : 1 } } } })),
          { type: 'rule', from: { data: 'r' }, encode: { enter: { x: { scale: 'x', field: 'mode', offset: -7 }, x2: { scale: 'x', field: 'mode', offset: 7 }, y: { scale: 'y', field: 'c' }, stroke: { value: theme.ink }, strokeWidth: { value: 1.5 } } } },
        ],
      }),
    }];
  }

  function emulator(run) {
    const counts = run.summary.emulator?.counts;
    if (!counts) return [];
    const rows = Object.entries(counts).flatMap(([n, c]) => c.modes.map((m) => ({ ...m, n: n + (n === '1' ? ' damage' : ' damages') })));
    const values = rows.filter((r) => r.rmse > 0);
    if (!values.length) return [];
    const positive = values.flatMap((v) => [v.rmse, v.noise]).filter((v) => v > 0);
    return [{
      id: 'emulator-error', section: 'emulator', wide: true, title: 'Error of the emulator for each mode, and noise of the data',
      caption: 'Root-mean-square error on finite-element runs outside the training set of the emulator. If points are near the short strokes (the noise), the emulator error affects the results.',
      table: () => ({ head: ['damages', 'mode', 'rmse [Hz]', 'largest error [Hz]', 'Q²', 'rmse / effect', 'noise [Hz]'], rows: rows.map((r) => [r.n, r.mode, r.rmse, r.max_error, r.q2, r.relative_rmse, r.noise]) }),
      spec: (width, theme) => frame(width, 190, theme, {
        data: [{ name: 'e', values }, { name: 'noise', values: values.filter((v) => v.noise > 0 && v.n === values[0].n) }],
        scales: [{ name: 'x', type: 'point', domain: [...new Set(values.map((v) => v.mode))], range: 'width', padding: 0.6 },
          { name: 'y', type: 'log', domain: [Math.min(...positive) / 1.5, Math.max(...positive) * 1.5], range: 'height' },
          { name: 'n', type: 'ordinal', domain: [...new Set(values.map((v) => v.n))], range: theme.series }],
        axes: [{ orient: 'bottom', scale: 'x', title: 'mode', domain: false, ticks: false }, axisY('error [Hz]', { format: '~r', values: powersOfTen(positive) })],
        legends: [circles(width, [...new Set(values.map((v) => v.n))], 'n')],
        marks: [
          { type: 'rule', from: { data: 'noise' }, encode: { enter: { x: { scale: 'x', field: 'mode', offset: -9 }, x2: { scale: 'x', field: 'mode', offset: 9 }, y: { scale: 'y', field: 'noise' }, stroke: { value: theme.ink }, strokeWidth: { value: 2 } } } },
          { type: 'symbol', from: { data: 'e' }, encode: { enter: { x: { scale: 'x', field: 'mode' }, y: { scale: 'y', field: 'rmse' }, fill: { scale: 'n', field: 'n' }, size: { value: 55 } } } },
        ],
      }),
    }];
  }

  return { beam, structure, jointFigures, residuals, emulator };
})(kit);
