// Charts of draws: posteriors of parameters, histories, model visits and acceptance.
const samplingCharts = (({ percent, fewNames, restyled, slug, unit, strokes, circles, legend, tickFormat, frame, linear, axisX, axisY, heat, cellTable }) => {
  function marginal(model, p, fraction) {
    const x0 = p.bins.from, w = p.bins.width, shown = p.prior ? ['posterior', 'prior'] : ['posterior'];
    return {
      id: `marginal-${slug(model)}-${slug(p.name)}`, section: 'parameters', group: model, title: p.name + unit(p.name, p.unit),
      caption: p.prior ? `Prior: ${restyled(p.prior.words)}${p.prior.ordered ? ', in increasing order' : ''}.` : '',
      table: () => ({ head: ['from', 'to', 'posterior density'], rows: p.density.map((d, i) => [x0 + i * w, x0 + (i + 1) * w, d]) }),
      spec: (width, theme) => frame(width, 130, theme, {
        data: [{ name: 'h', values: [{ x: x0, d: 0 }, ...p.density.flatMap((d, i) => [{ x: x0 + i * w, d }, { x: x0 + (i + 1) * w, d }]), { x: x0 + p.bins.n * w, d: 0 }] },
          { name: 'prior', values: p.prior ? p.prior.x.map((x, i) => ({ x, d: p.prior.density[i] })) : [] }],
        scales: [linear('x', [x0 - 0.05 * w * p.bins.n, x0 + 1.05 * w * p.bins.n], 'width'),
          linear('y', [0, 1.05 * Math.max(...p.density, ...(p.prior ? p.prior.density.filter((d) => d < 3 * Math.max(...p.density)) : []))], 'height'),
          { name: 'who', type: 'ordinal', domain: shown, range: [theme.main, theme.other] }],
        axes: [axisX(null, { format: fraction ? '%' : tickFormat(x0, x0 + p.bins.n * w), tickCount: { signal: 'max(3, width / 100)' } }), axisY(null, { tickCount: 3, labels: false })],
        legends: [strokes(width, shown)],
        marks: [
          { type: 'area', from: { data: 'h' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 'd' }, y2: { scale: 'y', value: 0 }, fill: { value: theme.main }, fillOpacity: { value: 0.75 } } } },
          { type: 'line', clip: true, from: { data: 'prior' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 'd' }, stroke: { value: theme.other }, strokeWidth: { value: 2 } } } },
        ],
      }),
    };
  }
  function pair(model, p, isShare) {
    return {
      id: `pair-${slug(model)}-${slug(p.x)}-${slug(p.y)}`, section: 'pairs', group: model, title: `${p.y} against ${p.x}`, caption: '',
      table: () => cellTable(p.x, p.y, p.bins_x, p.bins_y, p.cells),
      spec: (width, theme) => heat(width, 180, theme, { x: p.bins_x, y: p.bins_y, cells: p.cells, root: true, xTitle: p.x + unit(p.x, p.x_unit), yTitle: p.y + unit(p.y, p.y_unit),
        xFormat: isShare(p.x) ? '%' : undefined, yFormat: isShare(p.y) ? '%' : undefined }),
    };
  }

  function history(id, section, group, title, chains, draws, line, fraction) {
    const values = chains.flatMap((c, i) => c.map(([t, v]) => ({ t, v, c: 'chain ' + (i + 1) })));
    const names = chains.map((_, i) => 'chain ' + (i + 1));
    const all = values.map((d) => d.v);
    const low = Math.min(...all), high = Math.max(...all), pad = 0.04 * (high - low || 1);
    return {
      id, section, group, title, caption: '',
      table: () => ({ head: ['chain', 'draw', title], rows: chains.flatMap((c, i) => c.map(([t, v]) => [i + 1, t, v])) }),
      spec: (width, theme) => frame(width, 130, theme, {
        data: [{ name: 'd', values }],
        scales: [linear('x', [1, draws], 'width'), linear('y', [low - pad, high + pad], 'height'),
          { name: 'c', type: 'ordinal', domain: names, range: theme.series }],
        axes: [axisX('draw'), axisY(null, { format: fraction ? '%' : tickFormat(low, high) })],
        legends: names.length > 8 ? [] : [{ ...circles(width, names, 'c'), symbolSize: 40 }],
        marks: [line
          ? { type: 'group', from: { facet: { name: 'one', data: 'd', groupby: 'c' } }, marks: [{ type: 'line', from: { data: 'one' }, encode: { enter: {
            x: { scale: 'x', field: 't' }, y: { scale: 'y', field: 'v' }, stroke: { scale: 'c', field: 'c' }, strokeWidth: { value: 0.8 }, strokeOpacity: { value: 0.7 } } } }] }
          : { type: 'symbol', from: { data: 'd' }, encode: { enter: { x: { scale: 'x', field: 't' }, y: { scale: 'y', field: 'v' }, fill: { scale: 'c', field: 'c' }, size: { value: 5 }, fillOpacity: { value: 0.6 } } } }],
      }),
    };
  }
  function visits(run) {
    const { step, chains } = run.draws.visits;
    const names = fewNames(run.summary.models);
    const used = [...new Set(chains.flat().sort((a, b) => a - b).map((m) => names[m]))];
    // Consecutive draws of one model form one bar.
    const values = chains.flatMap((c, i) => {
      const bars = [];
      c.forEach((m, n) => {
        const last = bars[bars.length - 1];
        if (last && last.m === names[m]) last.to = (n + 1) * step;
        else bars.push({ c: i + 1, m: names[m], from: n * step, to: (n + 1) * step });
      });
      return bars;
    });
    return {
      id: 'model-visits', section: 'sampling', wide: true, title: 'Model of each draw',
      caption: `One row per chain${step === 1 ? "" : `, one draw in ${step}`}. If the colours alternate over the whole length of all rows, the chains move freely between models.`,
      table: () => ({ head: ['draw', ...chains.map((_, i) => 'chain ' + (i + 1))], rows: chains[0].map((_, n) => [n * step + 1, ...chains.map((c) => names[c[n]])]) }),
      spec: (width, theme) => frame(width, Math.max(60, 22 * chains.length), theme, {
        data: [{ name: 'v', values }],
        scales: [linear('x', [0, run.draws.draws], 'width'), { name: 'y', type: 'band', domain: chains.map((_, i) => i + 1), range: 'height', padding: 0.2 },
          { name: 'm', type: 'ordinal', domain: used, range: theme.series }],
        axes: [axisX('draw'), { orient: 'left', scale: 'y', title: 'chain', domain: false, ticks: false }],
        legends: [legend(width, used, { fill: 'm', symbolType: 'square' })],
        marks: [{ type: 'rect', from: { data: 'v' }, encode: { enter: { x: { scale: 'x', field: 'from' }, x2: { scale: 'x', field: 'to' }, y: { scale: 'y', field: 'c' }, height: { scale: 'y', band: 1 }, fill: { scale: 'm', field: 'm' } } } }],
      }),
    };
  }
  function running(run) {
    const { draws, probability } = run.draws.visits.running;
    const names = run.summary.models.map((m) => m.name);
    const few = fewNames(run.summary.models);
    const used = names.map((_, m) => m).filter((m) => few[m] === names[m] && probability.some((row) => row[m] > 0));
    return {
      id: 'running-probability', section: 'sampling', wide: true, title: 'Probability of each model as draws accumulate',
      caption: 'If the lines are level, further draws would change the probabilities only slightly.',
      table: () => ({ head: ['draws per chain', ...names], rows: draws.map((d, i) => [d, ...probability[i]]) }),
      spec: (width, theme) => frame(width, 150, theme, {
        data: [{ name: 'd', values: used.flatMap((m) => draws.map((t, i) => ({ t, p: probability[i][m], m: names[m] }))) }],
        scales: [linear('x', [0, run.draws.draws], 'width'), linear('y', [0, 1], 'height'), { name: 'm', type: 'ordinal', domain: used.map((m) => names[m]), range: theme.series }],
        axes: [axisX('draws per chain'), axisY(null, { format: '%' })],
        legends: [strokes(width, used.map((m) => names[m]), 'm')],
        marks: [{ type: 'group', from: { facet: { name: 'one', data: 'd', groupby: 'm' } }, marks: [{ type: 'line', from: { data: 'one' }, encode: { enter: {
          x: { scale: 'x', field: 't' }, y: { scale: 'y', field: 'p' }, stroke: { scale: 'm', field: 'm' }, strokeWidth: { value: 2 } } } }] }],
      }),
    };
  }
  function acceptance(run) {
    const moves = Object.entries(run.summary.diagnostics.acceptance?.moves || {}).filter(([, m]) => m && m.proposed > 0);
    if (!moves.length) return [];
    return [{
      id: 'acceptance', section: 'sampling', wide: true, title: 'Acceptance of each kind of move', caption: 'The fraction of accepted proposals.',
      table: () => ({ head: ['move', 'proposed', 'accepted', 'rate'], rows: moves.map(([n, m]) => [n, m.proposed, m.accepted, m.rate]) }),
      spec: (width, theme) => frame(width, 22 * moves.length, theme, {
        data: [{ name: 'm', values: moves.map(([name, m]) => ({ name, rate: m.rate, label: percent(m.rate) })) }],
        scales: [linear('x', [0, 1], [0, { signal: 'width - 52' }]), { name: 'y', type: 'band', domain: { data: 'm', field: 'name' }, range: 'height', padding: 0.3 }],
        axes: [axisX(null, { format: '%', grid: true, tickCount: width < 480 ? 3 : 5, labelFlush: false }), { orient: 'left', scale: 'y', domain: false, ticks: false, labelLimit: width * 0.45, labelColor: theme.ink }],
        marks: [
          { type: 'rect', from: { data: 'm' }, encode: { enter: { x: { scale: 'x', value: 0 }, x2: { scale: 'x', field: 'rate' }, y: { scale: 'y', field: 'name' }, height: { scale: 'y', band: 1 }, fill: { value: theme.main } } } },
          { type: 'text', from: { data: 'm' }, encode: { enter: { x: { scale: 'x', field: 'rate', offset: 6 }, y: { scale: 'y', field: 'name', band: 0.5 }, baseline: { value: 'middle' }, text: { field: 'label' } } } },
        ],
      }),
    }];
  }

  return { marginal, pair, history, visits, running, acceptance };
})(kit);
