// The figures of a report as Vega specifications: charts.figures(run) lists them, each with
// spec(width, theme) and table() of the same numbers. Nothing here touches the page.
const charts = (() => {
  // Okabe & Ito's colours, which remain apart for colour-blind readers.
  const themes = {
    light: {
      ink: '#17212b', soft: '#56636f', grid: '#e4e8ec', paper: '#ffffff', main: '#0072b2', other: '#d55e00',
      series: ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#7a6a00', '#000000'],
      heat: ['#dbe9f5', '#08306b'],
    },
    dark: {
      ink: '#e6ecf1', soft: '#a3b1bd', grid: '#2a3540', paper: '#11181f', main: '#56b4e9', other: '#ff9b52',
      series: ['#56b4e9', '#ff9b52', '#2fc79a', '#e79ac4', '#f0e442', '#0a86cf', '#c9b458', '#ffffff'],
      heat: ['#17364c', '#c8ecff'],
    },
  };

  const number = (x, digits = 4) =>
    typeof x === 'number' && isFinite(x) ? String(+x.toPrecision(digits)) : '–';
  const percent = (p) => (p > 0.999 ? '> 99.9 %' : p >= 0 && p < 0.001 ? '< 0.1 %' : `${+(100 * p).toPrecision(3)} %`);
  // "P = 75 %", "P > 99.9 %".
  const probability = (p) => 'P ' + (/^[<>]/.test(percent(p)) ? '' : '= ') + percent(p);
  const slug = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '').slice(0, 60) || 'figure';
  // Reductions are fractions; people read percent.
  const isFraction = (name) => /(^|\s)reduction(\[|$)/.test(name);
  const bracketed = (known) => (known && known !== '1' ? ` [${known.replace(/\^2/g, '²').replace(/\^3/g, '³')}]` : '');
  const unit = (name, known) => (/(^|\s)location(\[|$)/.test(name) ? ' [m]' : bracketed(known));
  const short = (text, n) => ([...text].length > n ? [...text].slice(0, n - 1).join('') + '…' : text);

  function frame(width, height, theme, body) {
    return {
      width, height, background: null, padding: 2,
      autosize: { type: 'fit-x', contains: 'padding', resize: false },
      config: {
        font: 'system-ui, "Segoe UI", "Noto Sans", sans-serif',
        axis: {
          labelColor: theme.soft, titleColor: theme.soft, titleFontWeight: 400, domainColor: theme.soft,
          tickColor: theme.soft, gridColor: theme.grid, labelFontSize: 11, titleFontSize: 12, labelOverlap: true,
          titlePadding: 6, tickSize: 4, labelFlush: true,
        },
        legend: { labelColor: theme.soft, titleColor: theme.soft, labelFontSize: 11, titleFontSize: 11, titleFontWeight: 400,
          orient: 'top', direction: 'horizontal', labelLimit: Math.max(90, width / 3), columns: width < 480 ? 2 : 4 },
        text: { fill: theme.ink, fontSize: 11 },
      },
      ...body,
    };
  }
  const linear = (name, domain, range, more) => ({ name, type: 'linear', domain, range, zero: false, nice: false, ...more });
  const powersOfTen = (values) => {
    const [a, b] = [Math.min(...values), Math.max(...values)].map((v) => Math.floor(Math.log10(v)));
    const step = Math.max(1, Math.ceil((b - a) / 5));
    return Array.from({ length: Math.floor((b + 1 - a) / step) + 1 }, (_, i) => 10 ** (a + i * step));
  };
  const axisX = (title, more) => ({ orient: 'bottom', scale: 'x', title, tickCount: { signal: 'max(2, width / 90)' }, ...more });
  const axisY = (title, more) => ({ orient: 'left', scale: 'y', title, grid: true, domain: false, ticks: false, tickCount: 4, ...more });

  // ---- how many ---------------------------------------------------------------------------
  function modelProbabilities(run) {
    const all = run.summary.models;
    const shown = all.length <= 14 ? all
      : all.filter((m) => [...all].sort((a, b) => b.probability - a.probability).slice(0, 14).includes(m));
    const keys = [...new Set(all.flatMap((m) => Object.keys(m)))].filter((k) => all.every((m) => typeof m[k] !== 'object' || m[k] === null));
    return {
      id: 'model-probabilities', section: 'models', wide: true, title: 'Probability of each model',
      caption: `Bars: the posterior probability; whiskers: twice its Monte Carlo error; short strokes: the prior.${all.some((m) => m.basis === 'evidence') ? ' Where the draws cannot say, bar and whisker are those of the evidence.' : ''}${shown.length < all.length ? ` The ${shown.length} most probable of ${all.length}.` : ''}`,
      table: () => ({ head: keys, rows: all.map((m) => keys.map((k) => m[k])) }),
      spec: (width, theme) => frame(width, 34 * shown.length, theme, {
        data: [{ name: 'm', values: shown.map((m, i) => ({ ...m, i, label: m.mcse === null && m.basis ? 'not known' : percent(m.probability) + (m.basis === 'evidence' ? ', by its evidence' : ''),
          low: Math.max(0, m.probability - 2 * (m.mcse || 0)), high: Math.min(1, m.probability + 2 * (m.mcse || 0)) })) }],
        scales: [linear('x', [0, 1], [0, { signal: 'width - 52' }]),
          { name: 'y', type: 'band', domain: { data: 'm', field: 'i' }, range: 'height', padding: 0.35 },
          { name: 'names', type: 'ordinal', domain: shown.map((_, i) => i), range: shown.map((m) => short(m.name, 60)) }],
        axes: [axisX(null, { format: '%', grid: true, tickCount: width < 480 ? 3 : 5, labelFlush: false }),
          { orient: 'left', scale: 'y', domain: false, ticks: false, labelLimit: Math.max(80, width * 0.36), labelFontSize: 12, labelColor: theme.ink,
            labelPadding: 6, encode: { labels: { update: { text: { signal: "scale('names', datum.value)" } } } } }],
        marks: [
          { type: 'rect', from: { data: 'm' }, encode: { enter: { x: { scale: 'x', value: 0 }, x2: { scale: 'x', field: 'probability' },
            y: { scale: 'y', field: 'i' }, height: { scale: 'y', band: 1 }, fill: { value: theme.main }, cornerRadius: { value: 1 },
            tooltip: { signal: "datum.name + ': ' + datum.label" } } } },
          { type: 'rule', from: { data: 'm' }, encode: { enter: { x: { scale: 'x', field: 'low' }, x2: { scale: 'x', field: 'high' },
            y: { scale: 'y', field: 'i', band: 0.5 }, stroke: { value: theme.ink }, strokeWidth: { value: 1.5 } } } },
          { type: 'rule', from: { data: 'm' }, encode: { enter: { x: { scale: 'x', field: 'prior' }, y: { scale: 'y', field: 'i', offset: -3 },
            y2: { scale: 'y', field: 'i', band: 1, offset: 3 }, stroke: { value: theme.other }, strokeWidth: { value: 2 } } } },
          { type: 'text', from: { data: 'm' }, encode: { enter: { x: { signal: "max(scale('x', datum.high), scale('x', datum.prior)) + 7" },
            y: { scale: 'y', field: 'i', band: 0.5 }, baseline: { value: 'middle' }, text: { field: 'label' }, fontSize: { value: 12 }, fontWeight: { value: 600 } } } },
        ],
      }),
    };
  }

  // ---- where ------------------------------------------------------------------------------
  function beam(run, kind, inclusion, several) {
    const { length, supports } = run.summary.beam;
    const step = length / inclusion.length;
    const truth = (kind.truth || []).map((t) => ({ x: t.location }));
    const top = Math.max(...inclusion, 1e-9);
    return {
      id: 'where' + (several ? '-' + slug(kind.name) : ''), section: 'where', wide: true,
      title: several ? `Where the ${kind.plural} are` : `Where along the beam the ${kind.plural} are`,
      caption: `Expected number of ${kind.plural} in each element, all counts together, above the beam (length to scale) and its supports.${truth.length ? ' Arrows: the truth that the data were simulated from.' : ''}`,
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

  // A two-dimensional histogram, densities as shades; empty cells show the paper.
  function heat(width, height, theme, { x, y, xTitle, yTitle, xDomain, yDomain, xFormat, yFormat, cells, legend, root }) {
    const values = cells.map(([i, j, d]) => ({ x0: x.from + i * x.width, x1: x.from + (i + 1) * x.width,
      y0: y.from + j * y.width, y1: y.from + (j + 1) * y.width, d }));
    const top = Math.max(...values.map((v) => v.d));
    return frame(width, height, theme, {
      data: [{ name: 'c', values }],
      scales: [linear('x', xDomain || [x.from, x.from + x.n * x.width], 'width'), linear('y', yDomain || [y.from, y.from + y.n * y.width], 'height'),
        { name: 'heat', type: root ? 'sqrt' : 'linear', domain: [0, top], range: theme.heat, interpolate: 'lab', zero: true }],
      axes: [axisX(xTitle, { format: xFormat, grid: true }), axisY(yTitle, { format: yFormat })],
      legends: legend ? [{ fill: 'heat', type: 'gradient', title: legend, gradientLength: Math.min(220, width * 0.5), values: [0, top / (root ? 4 : 2), top], format: '.2~r' }] : [],
      marks: [{ type: 'rect', from: { data: 'c' }, encode: { enter: { x: { scale: 'x', field: 'x0' }, x2: { signal: "scale('x', datum.x1) + 0.4" },
        y: { scale: 'y', field: 'y1' }, y2: { signal: "scale('y', datum.y0) + 0.4" }, fill: { scale: 'heat', field: 'd' } } } }],
    });
  }
  const cellTable = (xName, yName, bx, by, cells) => ({
    head: [xName, yName, 'density'],
    rows: cells.map(([i, j, d]) => [bx.from + (i + 0.5) * bx.width, by.from + (j + 0.5) * by.width, d]),
  });

  function jointFigures(run) {
    const out = [];
    for (const joint of run.draws.joint) {
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
          caption: view.count ? '' : `Expected number of ${kind.plural} per metre and unit of ${joint.severity}. Separate islands are separate explanations of the same data, such as a place and its mirror image.`,
          table: () => cellTable('location [m]', joint.severity, joint.bins_x, joint.bins_y, view.cells),
          spec: (width, theme) => heat(width, width < 480 ? 190 : 230, theme, {
            x: joint.bins_x, y: joint.bins_y, cells: view.cells, root: true, xTitle: 'location [m]', yTitle: yName, yFormat: fraction ? '%' : undefined,
            legend: 'density' }),
        });
      }
    }
    return out;
  }

  // The chain of masses and links of a system-identification model.
  const linkOrder = ['stiffness', 'damping'];
  const linkKeys = (link) => Object.keys(link).filter((k) => k !== 'between')
    .sort((a, b) => (linkOrder.indexOf(a) + 1 || 9) - (linkOrder.indexOf(b) + 1 || 9));
  // A coefficient that was found stands with its posterior median.
  const linkWords = (link, found) => linkKeys(link).map((k) => k.replace(/_/g, ' ') + (typeof link[k] === 'object' ? '' : ' ' + link[k])
    + (found[link[k]] ? ' = ' + number(found[link[k]].q50, 3) : '')).join(', ');
  // A spring from (x, y0) up to (x, y1).
  const springPath = (x, y0, y1) => {
    const turns = 6, lead = 6, step = (y0 - y1 - 2 * lead) / turns;
    const zigzag = Array.from({ length: turns }, (_, i) => `L${x + (i % 2 ? -5 : 5)},${y0 - lead - (i + 0.5) * step}`).join('');
    return `M${x},${y0}L${x},${y0 - lead}${zigzag}L${x},${y1 + lead}L${x},${y1}`;
  };
  function chain(run) {
    const cased = run.summary.wheeltap.case.models || [];
    const best = [...run.summary.models].sort((a, b) => b.probability - a.probability)[0];
    const model = cased.find((m) => m.name === best.name);
    if (!model || !Array.isArray(model.masses)) return [];
    const n = model.masses.length;
    const links = (model.links || []).map((l, i) => ({ i, a: Math.min(...l.between), b: Math.max(...l.between), words: linkWords(l, run.summary.parameters[best.name] || {}), between: l.between }));
    return [{
      id: 'chain', section: 'where', wide: true, title: `The chain of the most probable model, “${short(best.name, 60)}”`,
      caption: 'Masses and the links between them, with the laws that each link has; what was found stands with its median. 0 is the ground or the moving base.',
      table: () => ({ head: ['between', 'laws'], rows: (model.links || []).map((l) => [l.between.join(' and '), linkKeys(l).map((k) => `${k}: ${typeof l[k] === 'object' ? JSON.stringify(l[k]) : l[k]}`).join(', ')]) }),
      spec: (width, theme) => {
        // A row a mass, from the ground up: readable at any width.
        // On a phone a line for each law.
        const lines = (l) => (width < 480 ? [l.between.join(' – '), ...l.words.split(', ')] : [`${l.between.join(' – ')}: ${l.words}`]).map((t) => short(t, Math.floor(width / 7)));
        const row = Math.max(62, 38 + 12 * Math.max(...links.map((l) => lines(l).length))), height = row * n + 40;
        const yOf = (k) => height - 16 - k * row;
        return frame(width, height, theme, {
          data: [{ name: 'm', values: model.masses.map((m, i) => ({ y: yOf(i + 1), text: `mass ${i + 1}: ${m}${typeof m === 'number' ? ' kg' : ''}` })) },
            { name: 'l', values: links.map((l) => ({ x: 70 + 14 * (l.b - l.a > 1 ? 4 : 0), y0: yOf(l.a) - (l.a ? 15 : 0), y1: yOf(l.b) + 15,
              spring: springPath(70 + 14 * (l.b - l.a > 1 ? 4 : 0), yOf(l.a) - (l.a ? 15 : 0), yOf(l.b) + 15),
              text: lines(l) })) }],
          marks: [
            { type: 'rect', encode: { enter: { x: { value: 0 }, x2: { value: 140 }, y: { value: height - 16 }, y2: { value: height - 6 }, fill: { value: theme.soft } } } },
            { type: 'path', from: { data: 'l' }, encode: { enter: { path: { field: 'spring' }, stroke: { value: theme.main }, strokeWidth: { value: 2 }, strokeJoin: { value: 'round' } } } },
            { type: 'text', from: { data: 'l' }, encode: { enter: { x: { field: 'x', offset: 12 }, y: { signal: '(datum.y0 + datum.y1) / 2 - 6 * (length(datum.text) - 1)' }, baseline: { value: 'middle' }, text: { field: 'text' }, lineHeight: { value: 12 }, limit: { value: width - 90 } } } },
            { type: 'rect', from: { data: 'm' }, encode: { enter: { x: { value: 10 }, x2: { value: 130 }, y: { field: 'y', offset: -15 }, y2: { field: 'y', offset: 15 }, fill: { value: theme.paper }, stroke: { value: theme.ink }, cornerRadius: { value: 3 } } } },
            { type: 'text', from: { data: 'm' }, encode: { enter: { x: { value: 70 }, y: { field: 'y' }, align: { value: 'center' }, baseline: { value: 'middle' }, text: { field: 'text' }, limit: { value: 112 }, fontSize: { value: 12 } } } },
          ],
        });
      },
    }];
  }

  // ---- parameters -------------------------------------------------------------------------
  function marginal(model, p) {
    const x0 = p.bins.from, w = p.bins.width;
    const fraction = isFraction(p.name);
    return {
      id: `marginal-${slug(model)}-${slug(p.name)}`, section: 'parameters', group: model, title: p.name + unit(p.name, p.unit),
      caption: p.prior ? `Prior: ${p.prior.words}${p.prior.ordered ? ', in increasing order' : ''}.` : '',
      table: () => ({ head: ['from', 'to', 'posterior density'], rows: p.density.map((d, i) => [x0 + i * w, x0 + (i + 1) * w, d]) }),
      spec: (width, theme) => frame(width, 130, theme, {
        data: [{ name: 'h', values: [{ x: x0, d: 0 }, ...p.density.flatMap((d, i) => [{ x: x0 + i * w, d }, { x: x0 + (i + 1) * w, d }]), { x: x0 + p.bins.n * w, d: 0 }] },
          { name: 'prior', values: p.prior ? p.prior.x.map((x, i) => ({ x, d: p.prior.density[i] })) : [] }],
        scales: [linear('x', [x0 - 0.05 * w * p.bins.n, x0 + 1.05 * w * p.bins.n], 'width'),
          linear('y', [0, 1.05 * Math.max(...p.density, ...(p.prior ? p.prior.density.filter((d) => d < 3 * Math.max(...p.density)) : []))], 'height'),
          { name: 'who', type: 'ordinal', domain: ['posterior', 'prior'], range: [theme.main, theme.other] }],
        axes: [axisX(null, { format: fraction ? '%' : undefined, tickCount: 4 }), axisY(null, { tickCount: 3, labels: false })],
        legends: [{ stroke: 'who', symbolType: 'stroke', symbolStrokeWidth: 3 }],
        marks: [
          { type: 'area', from: { data: 'h' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 'd' }, y2: { scale: 'y', value: 0 }, fill: { value: theme.main }, fillOpacity: { value: 0.75 } } } },
          { type: 'line', clip: true, from: { data: 'prior' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 'd' }, stroke: { value: theme.other }, strokeWidth: { value: 2 } } } },
        ],
      }),
    };
  }
  function pair(model, p) {
    return {
      id: `pair-${slug(model)}-${slug(p.x)}-${slug(p.y)}`, section: 'pairs', group: model, title: `${p.y} against ${p.x}`, caption: '',
      table: () => cellTable(p.x, p.y, p.bins_x, p.bins_y, p.cells),
      spec: (width, theme) => heat(width, 180, theme, { x: p.bins_x, y: p.bins_y, cells: p.cells, root: true, xTitle: p.x + unit(p.x, p.x_unit), yTitle: p.y + unit(p.y, p.y_unit),
        xFormat: isFraction(p.x) ? '%' : undefined, yFormat: isFraction(p.y) ? '%' : undefined }),
    };
  }

  // ---- the sampler ------------------------------------------------------------------------
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
        axes: [axisX('draw'), axisY(null, { format: fraction ? '%' : undefined })],
        legends: names.length > 8 ? [] : [{ fill: 'c', symbolType: 'circle', symbolSize: 40 }],
        marks: [line
          ? { type: 'group', from: { facet: { name: 'one', data: 'd', groupby: 'c' } }, marks: [{ type: 'line', from: { data: 'one' }, encode: { enter: {
            x: { scale: 'x', field: 't' }, y: { scale: 'y', field: 'v' }, stroke: { scale: 'c', field: 'c' }, strokeWidth: { value: 0.8 }, strokeOpacity: { value: 0.7 } } } }] }
          : { type: 'symbol', from: { data: 'd' }, encode: { enter: { x: { scale: 'x', field: 't' }, y: { scale: 'y', field: 'v' }, fill: { scale: 'c', field: 'c' }, size: { value: 5 }, fillOpacity: { value: 0.6 } } } }],
      }),
    };
  }
  function visits(run) {
    const { step, chains } = run.draws.visits;
    const names = run.summary.models.map((m) => m.name);
    const used = [...new Set(chains.flat())].sort((a, b) => a - b);
    // Neighbouring draws in one model are one bar.
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
      caption: `One row a chain${step === 1 ? "" : `, one draw in ${step}`}. Colours that alternate everywhere, alike in all rows, mean that the chains move freely between models.`,
      table: () => ({ head: ['draw', ...chains.map((_, i) => 'chain ' + (i + 1))], rows: chains[0].map((_, n) => [n * step + 1, ...chains.map((c) => names[c[n]])]) }),
      spec: (width, theme) => frame(width, Math.max(60, 22 * chains.length), theme, {
        data: [{ name: 'v', values }],
        scales: [linear('x', [0, run.draws.draws], 'width'), { name: 'y', type: 'band', domain: chains.map((_, i) => i + 1), range: 'height', padding: 0.2 },
          { name: 'm', type: 'ordinal', domain: used.map((m) => names[m]), range: theme.series }],
        axes: [axisX('draw'), { orient: 'left', scale: 'y', title: 'chain', domain: false, ticks: false }],
        legends: [{ fill: 'm', symbolType: 'square' }],
        marks: [{ type: 'rect', from: { data: 'v' }, encode: { enter: { x: { scale: 'x', field: 'from' }, x2: { scale: 'x', field: 'to' }, y: { scale: 'y', field: 'c' }, height: { scale: 'y', band: 1 }, fill: { scale: 'm', field: 'm' } } } }],
      }),
    };
  }
  function running(run) {
    const { draws, probability } = run.draws.visits.running;
    const names = run.summary.models.map((m) => m.name);
    const used = names.map((_, m) => m).filter((m) => probability.some((row) => row[m] > 0));
    return {
      id: 'running-probability', section: 'sampling', wide: true, title: 'Probability of each model as draws accumulate',
      caption: 'Lines that have become level say that more draws would change little.',
      table: () => ({ head: ['draws a chain', ...names], rows: draws.map((d, i) => [d, ...probability[i]]) }),
      spec: (width, theme) => frame(width, 150, theme, {
        data: [{ name: 'd', values: used.flatMap((m) => draws.map((t, i) => ({ t, p: probability[i][m], m: names[m] }))) }],
        scales: [linear('x', [0, run.draws.draws], 'width'), linear('y', [0, 1], 'height'), { name: 'm', type: 'ordinal', domain: used.map((m) => names[m]), range: theme.series }],
        axes: [axisX('draws a chain'), axisY(null, { format: '%' })],
        legends: [{ stroke: 'm', symbolType: 'stroke', symbolStrokeWidth: 3 }],
        marks: [{ type: 'group', from: { facet: { name: 'one', data: 'd', groupby: 'm' } }, marks: [{ type: 'line', from: { data: 'one' }, encode: { enter: {
          x: { scale: 'x', field: 't' }, y: { scale: 'y', field: 'p' }, stroke: { scale: 'm', field: 'm' }, strokeWidth: { value: 2 } } } }] }],
      }),
    };
  }
  function acceptance(run) {
    const moves = Object.entries(run.summary.diagnostics.acceptance?.moves || {}).filter(([, m]) => m && m.proposed > 0);
    if (!moves.length) return [];
    return [{
      id: 'acceptance', section: 'sampling', wide: true, title: 'Acceptance of each kind of move', caption: 'The share of proposals that were accepted.',
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

  // ---- data against model -----------------------------------------------------------------
  function residuals(run) {
    const rows = (run.draws.predictive.frequency || []).filter((r) => typeof r.observed === 'number');
    if (!rows.length) return [];
    const bySd = rows.every((r) => typeof r.sd === 'number' && r.sd > 0);
    const scaled = (r, f) => (f - r.observed) / (bySd ? r.sd : r.observed);
    const values = rows.map((r) => {
      const [a, b, c, d, e] = r.quantiles.map((q) => scaled(r, q));
      return { mode: r.mode, a, b, c, d, e };
    });
    const extent = 1.08 * Math.max(...values.flatMap((v) => [Math.abs(v.a), Math.abs(v.e)]));
    return [{
      id: 'frequency-residuals', section: 'fit', wide: true, title: 'Replicated frequencies less the measured ones',
      caption: `What the models found would measure, noise included: thick 50 %, thin 95 %, stroke the median. ${bySd ? 'In standard deviations of the data' : 'Relative to the measured frequency'}; the line at zero is the measurement, and bars that miss it are modes that the models cannot explain.`,
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

  // |H1| of data and model over the coherence of the data, one frequency axis.
  function transfer(r, t) {
    const positive = t.rows.flatMap((row) => [row[1], row[2]]).filter((v) => v > 0);
    const top = Math.max(...positive) * 2, low = Math.max(Math.min(...positive), Math.max(...positive) * 1e-6);
    const unit = t.unit.replace(/\^2/g, '²');
    return {
      id: `frequency-response-${slug(r.name)}-${slug(t.name)}`, section: 'fit', title: `Frequency response: ${r.name} to ${t.name}`,
      caption: `H1 to the ${t.role}, of the data and of the predicted median (${t.segments} averages), over the coherence of the data.`,
      table: () => ({ head: ['frequency [Hz]', `|H1| data [${unit}]`, `|H1| model [${unit}]`, 'phase data [rad]', 'phase model [rad]', 'coherence'], rows: t.rows }),
      spec: (width, theme) => frame(width, 230, theme, {
        data: [{ name: 'h', values: ['data', 'predicted'].flatMap((who, k) => t.rows.filter((row) => row[k + 1] > 0).map((row) => ({ f: row[0], v: row[k + 1], who }))) },
          { name: 'c', values: t.rows.map((row) => ({ f: row[0], v: row[5] })) }],
        scales: [linear('x', [t.rows[0][0] < 0.2 * t.rows[t.rows.length - 1][0] ? 0 : t.rows[0][0], t.rows[t.rows.length - 1][0]], 'width'),
          { name: 'y', type: 'log', domain: [low, top], range: [150, 0], clamp: true }, linear('c', [0, 1], [230, 178]),
          { name: 'who', type: 'ordinal', domain: ['data', 'predicted'], range: [theme.ink, theme.other] }],
        axes: [axisX('frequency [Hz]'), axisY(unit, { format: '.0e', values: powersOfTen(positive), titleAnchor: 'end', titleAlign: 'right' }),
          axisY('coherence', { scale: 'c', values: [0, 0.5, 1], titleAnchor: 'start', titleAlign: 'left' })],
        legends: [{ stroke: 'who', symbolType: 'stroke', symbolStrokeWidth: 3 }],
        marks: [
          { type: 'group', from: { facet: { name: 'one', data: 'h', groupby: 'who' } }, marks: [{ type: 'line', from: { data: 'one' }, encode: { enter: { x: { scale: 'x', field: 'f' }, y: { scale: 'y', field: 'v' }, stroke: { scale: 'who', field: 'who' }, strokeWidth: { value: 1.4 } } } }] },
          { type: 'area', from: { data: 'c' }, encode: { enter: { x: { scale: 'x', field: 'f' }, y: { scale: 'c', field: 'v' }, y2: { scale: 'c', value: 0 }, fill: { value: theme.main }, fillOpacity: { value: 0.5 } } } },
        ],
      }),
    };
  }
  // The laws that the links were found to have, one chart a link, one band a model.
  function laws(run) {
    const found = Object.entries(run.summary.links || {});
    const units = run.summary.data?.units || (run.summary.data?.units === null ? {} : { force: 'N', length: 'm' });
    const [force, length] = [bracketed(units.force), bracketed(units.length)];
    const keys = [...new Set(found.flatMap(([, links]) => links.map((l) => l.between.join(' – '))))];
    return keys.map((key) => {
      const lines = found.flatMap(([model, links]) => links.filter((l) => l.between.join(' – ') === key).map((l) => ({ model, ...l })));
      const values = lines.flatMap((l) => l.extension.map((e, i) => ({ model: l.model, e, a: l.tension['q2.5'][i], m: l.tension.q50[i], b: l.tension['q97.5'][i] })));
      const span = (pick) => [Math.min(...values.map(pick[0])), Math.max(...values.map(pick[1]))];
      const [low, high] = span([(v) => v.a, (v) => v.b]);
      const models = [...new Set(lines.map((l) => l.model))];
      return {
        id: 'law-' + slug(key), section: 'where', title: `Law of link ${key}`,
        caption: '',
        table: () => ({ head: ['model', `extension${length}`, `2.5 %${force}`, `50 %${force}`, `97.5 %${force}`], rows: values.map((v) => [v.model, v.e, v.a, v.m, v.b]) }),
        spec: (width, theme) => frame(width, 170, theme, {
          data: [{ name: 'd', values }],
          scales: [linear('x', span([(v) => v.e, (v) => v.e]), 'width'), linear('y', low < high ? [low, high] : [low - 1, high + 1], 'height'),
            { name: 'm', type: 'ordinal', domain: models, range: theme.series }],
          axes: [axisX(`extension${length}`), axisY(`tension${force}`)],
          legends: [{ stroke: 'm', symbolType: 'stroke', symbolStrokeWidth: 3 }],
          marks: [{ type: 'group', from: { facet: { name: 'one', data: 'd', groupby: 'model' } }, marks: [
            { type: 'area', from: { data: 'one' }, encode: { enter: { x: { scale: 'x', field: 'e' }, y: { scale: 'y', field: 'a' }, y2: { scale: 'y', field: 'b' }, fill: { scale: 'm', field: 'model' }, fillOpacity: { value: 0.3 } } } },
            { type: 'line', from: { data: 'one' }, encode: { enter: { x: { scale: 'x', field: 'e' }, y: { scale: 'y', field: 'm' }, stroke: { scale: 'm', field: 'model' }, strokeWidth: { value: 1.8 } } } }] }],
        }),
      };
    });
  }

  function responses(run) {
    return (run.draws.responses || []).flatMap((r) => {
      const label = `${r.name}${r.unit ? ` [${r.unit.replace('^2', '²')}]` : ''}`;
      const values = r.history.map(([t, y, a, m, b]) => ({ t, y, a, m, b }));
      const span = [values[0].t, values[values.length - 1].t];
      const y = [Math.min(...values.map((v) => Math.min(v.y, v.a))), Math.max(...values.map((v) => Math.max(v.y, v.b)))];
      const line = (field, color, width, dash) => ({ type: 'line', clip: true, from: { data: 'd' }, encode: { update: { x: { scale: 'x', field: 't' }, y: { scale: 'y', field },
        stroke: { value: color }, strokeWidth: { value: width }, strokeDash: { value: dash || [] } } } });
      const bound = 1.96 / Math.sqrt(r.samples);
      const rho = r.autocorrelation.map((v, i) => ({ lag: i + 1, v }));
      const deep = Math.min(-bound, ...r.autocorrelation) * 1.1, high = Math.max(bound, ...r.autocorrelation) * 1.1;
      const positive = r.spectrum.flatMap((s) => s.slice(1)).filter((v) => v > 0);
      return [
        {
          id: 'response-' + slug(r.name), section: 'fit', wide: true, zoom: span, title: `Measured and predicted: ${label}`,
          caption: `Dark line: measured; colour: median and 95 % band of what the models found would measure, noise included. Drag to zoom, double-click for the whole record, or use the buttons.${r.bucket > 1 ? ` Each point stands for up to ${r.bucket} samples and keeps their extremes.` : ''}`,
          table: () => ({ head: ['time [s]', 'measured', '2.5 %', '50 %', '97.5 %'], rows: r.history }),
          spec: (width, theme) => frame(width, 220, theme, {
            signals: [
              { name: 'shown', value: span, on: [
                { events: 'window:mouseup', update: "drag && abs(drag[1] - drag[0]) > 4 ? [invert('x', min(drag[0], drag[1])), invert('x', max(drag[0], drag[1]))] : shown" },
                { events: 'dblclick', update: JSON.stringify(span) }] },
              { name: 'drag', value: null, on: [
                { events: 'mousedown', update: '[x(), x()]' },
                { events: '[mousedown, window:mouseup] > window:mousemove!', update: '[drag[0], clamp(x(), 0, width)]' },
                { events: { signal: 'shown' }, update: 'null' }] },
            ],
            data: [{ name: 'd', values }],
            scales: [linear('x', { signal: 'shown' }, 'width'), linear('y', y, 'height'),
              { name: 'who', type: 'ordinal', domain: ['measured', 'predicted'], range: [theme.ink, theme.other] }],
            axes: [axisX('time [s]'), axisY(label)],
            legends: [{ stroke: 'who', symbolType: 'stroke', symbolStrokeWidth: 3 }],
            marks: [
              { type: 'area', clip: true, from: { data: 'd' }, encode: { update: { x: { scale: 'x', field: 't' }, y: { scale: 'y', field: 'a' }, y2: { scale: 'y', field: 'b' }, fill: { value: theme.other }, fillOpacity: { value: 0.3 } } } },
              line('m', theme.other, 1.5), line('y', theme.ink, 0.9),
              { type: 'rect', encode: { update: { x: { signal: 'drag ? min(drag[0], drag[1]) : 0' }, x2: { signal: 'drag ? max(drag[0], drag[1]) : 0' }, y: { value: 0 }, y2: { signal: 'height' }, fill: { value: theme.main }, fillOpacity: { value: 0.2 } } } },
            ],
          }),
        },
        {
          id: 'spectrum-' + slug(r.name), section: 'fit', title: `Spectrum: ${r.name}`, caption: 'Power spectral density of the data, of the predicted median and of what is left.',
          table: () => ({ head: ['frequency [Hz]', 'data', 'predicted', 'residual'], rows: r.spectrum }),
          spec: (width, theme) => frame(width, 170, theme, {
            data: [{ name: 'd', values: ['data', 'predicted', 'residual'].flatMap((who, k) => r.spectrum.filter((s) => s[k + 1] > 0).map((s) => ({ f: s[0], v: s[k + 1], who }))) }],
            scales: [linear('x', [0, r.spectrum[r.spectrum.length - 1][0]], 'width'), { name: 'y', type: 'log', domain: [Math.max(Math.min(...positive), Math.max(...positive) * 1e-9), Math.max(...positive) * 2], range: 'height', clamp: true },
              { name: 'who', type: 'ordinal', domain: ['data', 'predicted', 'residual'], range: [theme.ink, theme.other, theme.main] }],
            axes: [axisX('frequency [Hz]'), axisY(r.unit ? (r.unit === 'm' ? 'm²/Hz' : `(${r.unit.replace('^2', '²')})²/Hz`) : null, { format: '.0e', values: powersOfTen(positive) })],
            legends: [{ stroke: 'who', symbolType: 'stroke', symbolStrokeWidth: 3, columns: 3 }],
            marks: [{ type: 'group', from: { facet: { name: 'one', data: 'd', groupby: 'who' } }, marks: [{ type: 'line', from: { data: 'one' }, encode: { enter: { x: { scale: 'x', field: 'f' }, y: { scale: 'y', field: 'v' }, stroke: { scale: 'who', field: 'who' }, strokeWidth: { value: 1.2 } } } }] }],
          }),
        },
        ...(r.transfer || []).filter((t) => t.rows.some((row) => row[1] > 0)).map((t) => transfer(r, t)),
        {
          id: 'autocorrelation-' + slug(r.name), section: 'fit', title: `Autocorrelation of the residuals: ${r.name}`, caption: 'Outside the shaded band, white residuals would lie one time in twenty. Many outside mean that the model misses something, and that its intervals are too narrow.',
          table: () => ({ head: ['lag', 'autocorrelation'], rows: rho.map((v) => [v.lag, v.v]) }),
          spec: (width, theme) => frame(width, 170, theme, {
            data: [{ name: 'd', values: rho }],
            scales: [linear('x', [0, rho.length + 1], 'width'), linear('y', [deep, high], 'height')],
            axes: [axisX('lag [samples]', { domain: false }), axisY(null)],
            marks: [
              { type: 'rect', encode: { enter: { x: { value: 0 }, x2: { signal: 'width' }, y: { scale: 'y', value: -bound }, y2: { scale: 'y', value: bound }, fill: { value: theme.other }, fillOpacity: { value: 0.18 } } } },
              { type: 'rule', from: { data: 'd' }, encode: { enter: { x: { scale: 'x', field: 'lag' }, y: { scale: 'y', value: 0 }, y2: { scale: 'y', field: 'v' }, stroke: { value: theme.main }, strokeWidth: { value: Math.max(1.5, Math.min(5, width / 100)) } } } },
            ],
          }),
        },
      ];
    });
  }

  // What each way of computing the models' probabilities found, side by side.
  function evidence(run) {
    const methods = Object.entries(run.summary.evidence || {}).filter(([, rows]) => Array.isArray(rows) && rows.some((r) => typeof r.probability === 'number'));
    if (!methods.length) return [];
    const models = run.summary.models;
    const values = [['chains', models.map((m) => ({ model: m.name, p: m.probability, se: m.mcse }))],
      ...methods.map(([method, rows]) => [method, rows.map((r) => ({ model: r.model, p: r.probability, se: r.probability_error }))])]
      .flatMap(([method, rows]) => rows.filter((r) => typeof r.p === 'number').map((r) => ({ ...r, method, i: models.findIndex((m) => m.name === r.model),
        low: Math.max(0, r.p - 2 * (r.se || 0)), high: Math.min(1, r.p + 2 * (r.se || 0)) })));
    const all = ['chains', ...methods.map(([m]) => m)];
    return [{
      id: 'evidence', section: 'models', wide: true, title: 'The same probabilities from evidences computed apart',
      caption: 'The chains beside methods that compute the evidence of each model on its own; whiskers: twice the standard error. They should agree.',
      table: () => ({ head: ['method', 'model', 'ln evidence', 'standard error', 'ln Bayes factor', 'probability', 'error of the probability', 'likelihood evaluations'],
        rows: methods.flatMap(([method, rows]) => rows.map((r) => [method, r.model, r.log_evidence, r.standard_error, r.log_bayes_factor, r.probability, r.probability_error, r.likelihood_evaluations])) }),
      spec: (width, theme) => frame(width, (14 * all.length + 12) * models.length, theme, {
        data: [{ name: 'v', values }],
        scales: [linear('x', [0, 1], [0, { signal: 'width - 12' }]), { name: 'y', type: 'band', domain: models.map((_, i) => i), range: 'height', padding: 0.2 },
          { name: 'names', type: 'ordinal', domain: models.map((_, i) => i), range: models.map((m) => short(m.name, 60)) },
          { name: 'sub', type: 'point', domain: all, range: [0, { signal: "bandwidth('y')" }], padding: 0.5 }, { name: 'm', type: 'ordinal', domain: all, range: theme.series }],
        axes: [axisX(null, { format: '%', grid: true, tickCount: width < 480 ? 3 : 5, labelFlush: false }),
          { orient: 'left', scale: 'y', domain: false, ticks: false, labelLimit: Math.max(80, width * 0.36), labelFontSize: 12, labelColor: theme.ink, labelPadding: 9, encode: { labels: { update: { text: { signal: "scale('names', datum.value)" } } } } }],
        legends: [{ fill: 'm', symbolType: 'circle' }],
        marks: [
          { type: 'rule', from: { data: 'v' }, encode: { enter: { x: { scale: 'x', field: 'low' }, x2: { scale: 'x', field: 'high' }, y: { scale: 'y', field: 'i', offset: { scale: 'sub', field: 'method' } }, stroke: { scale: 'm', field: 'method' }, strokeWidth: { value: 2 } } } },
          { type: 'symbol', from: { data: 'v' }, encode: { enter: { x: { scale: 'x', field: 'p' }, y: { scale: 'y', field: 'i', offset: { scale: 'sub', field: 'method' } }, fill: { scale: 'm', field: 'method' }, size: { value: 55 } } } },
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
      id: 'emulator-error', section: 'emulator', wide: true, title: 'Error of the emulator for each mode, against the noise of the data',
      caption: 'Root-mean-square error on finite-element runs that it was not trained on. Where points come near the short strokes, the noise, the emulator blurs the answer.',
      table: () => ({ head: ['damages', 'mode', 'rmse [Hz]', 'largest error [Hz]', 'Q²', 'rmse / effect', 'noise [Hz]'], rows: rows.map((r) => [r.n, r.mode, r.rmse, r.max_error, r.q2, r.relative_rmse, r.noise]) }),
      spec: (width, theme) => frame(width, 190, theme, {
        data: [{ name: 'e', values }, { name: 'noise', values: values.filter((v) => v.noise > 0 && v.n === values[0].n) }],
        scales: [{ name: 'x', type: 'point', domain: [...new Set(values.map((v) => v.mode))], range: 'width', padding: 0.6 },
          { name: 'y', type: 'log', domain: [Math.min(...positive) / 1.5, Math.max(...positive) * 1.5], range: 'height' },
          { name: 'n', type: 'ordinal', domain: [...new Set(values.map((v) => v.n))], range: theme.series }],
        axes: [{ orient: 'bottom', scale: 'x', title: 'mode', domain: false, ticks: false }, axisY('error [Hz]', { format: '~r', values: powersOfTen(positive) })],
        legends: [{ fill: 'n', symbolType: 'circle' }],
        marks: [
          { type: 'rule', from: { data: 'noise' }, encode: { enter: { x: { scale: 'x', field: 'mode', offset: -9 }, x2: { scale: 'x', field: 'mode', offset: 9 }, y: { scale: 'y', field: 'noise' }, stroke: { value: theme.ink }, strokeWidth: { value: 2 } } } },
          { type: 'symbol', from: { data: 'e' }, encode: { enter: { x: { scale: 'x', field: 'mode' }, y: { scale: 'y', field: 'rmse' }, fill: { scale: 'n', field: 'n' }, size: { value: 55 } } } },
        ],
      }),
    }];
  }

  function sweep(run) {
    const { path, rows } = run.summary.sweep;
    const names = rows[0].models.map((m) => m.name);
    const numeric = rows.every((r) => typeof r.value === 'number');
    const at = (r, i) => (numeric ? r.value : i + 1);
    const many = numeric && rows.length > 2 && Math.min(...rows.map((r) => r.value)) > 0 && Math.max(...rows.map((r) => r.value)) > 30 * Math.min(...rows.map((r) => r.value));
    // Values over decades that begin at zero: linear up to the smallest, then logarithmic.
    const smallest = Math.min(...rows.map((r) => r.value).filter((v) => v > 0));
    const fromZero = numeric && Math.min(...rows.map((r) => r.value)) === 0 && Math.max(...rows.map((r) => r.value)) > 30 * smallest;
    const x = { name: 'x', type: many ? 'log' : fromZero ? 'symlog' : 'linear', ...(fromZero ? { constant: smallest } : {}), domain: [Math.min(...rows.map(at)), Math.max(...rows.map(at))], range: 'width', padding: 10, zero: false };
    const lines = (id, title, caption, yTitle, values, group, domain, format, table) => ({
      id, section: 'sweep', wide: true, title, caption, table,
      spec: (width, theme) => frame(width, 200, theme, {
        data: [{ name: 'd', values }],
        scales: [x, linear('y', domain, 'height'), { name: 'g', type: 'ordinal', domain: group, range: theme.series }],
        axes: [axisX(path + (numeric ? '' : ' (number of the value)'), fromZero ? { values: rows.map((r) => r.value), tickCount: undefined } : {}), axisY(yTitle, { format })],
        legends: [{ fill: 'g', symbolType: 'circle' }],
        marks: [
          { type: 'rule', from: { data: 'd' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 'low' }, y2: { scale: 'y', field: 'high' }, stroke: { scale: 'g', field: 'g' }, strokeWidth: { value: 2 } } } },
          { type: 'group', from: { facet: { name: 'one', data: 'd', groupby: 'g' } }, marks: [{ type: 'line', from: { data: 'one' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 'v' }, stroke: { scale: 'g', field: 'g' }, strokeWidth: { value: 1.5 } } } }] },
          { type: 'symbol', from: { data: 'd' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 'v' }, fill: { scale: 'g', field: 'g' }, size: { value: 45 } } } },
        ],
      }),
    });
    const out = [lines('sweep-probability', 'Probability of each model', 'Whiskers: twice the Monte Carlo error.', null,
      rows.flatMap((r, i) => r.models.map((m) => ({ x: at(r, i), v: m.probability, g: m.name, low: Math.max(0, m.probability - 2 * (m.mcse || 0)), high: Math.min(1, m.probability + 2 * (m.mcse || 0)) }))),
      names, [0, 1], '%', () => ({ head: [path, ...names.flatMap((n) => [`P(${n})`, 'Monte Carlo error'])], rows: rows.map((r) => [shownValue(r.value), ...r.models.flatMap((m) => [m.probability, m.mcse])]) }))];
    const factors = rows.flatMap((r, i) => (r.log_bayes_factors || []).filter((b) => typeof b.log_bayes_factor === 'number').map((b) => ({ x: at(r, i), v: b.log_bayes_factor, g: `${b.model} against ${b.against}`,
      low: b.log_bayes_factor - 2 * (b.mcse || 0), high: b.log_bayes_factor + 2 * (b.mcse || 0) })));
    for (const [i, r] of rows.entries()) {
      for (const [method, list] of Object.entries(r.evidence || {})) {
        for (const e of list.slice(1)) if (typeof e.log_bayes_factor === 'number') factors.push({ x: at(r, i), v: e.log_bayes_factor, g: `${e.model} against ${list[0].model}, ${method}`, low: e.log_bayes_factor, high: e.log_bayes_factor });
      }
    }
    if (factors.length) {
      out.push(lines('sweep-bayes-factor', 'Logarithm of the Bayes factor', 'Above zero the data favour the model named first. Missing points: a model was never visited, so that the chains only bound the factor.', 'ln B',
        factors, [...new Set(factors.map((f) => f.g))], [Math.min(0, ...factors.map((f) => f.low)), Math.max(0, ...factors.map((f) => f.high))], undefined,
        () => ({ head: [path, 'models', 'ln Bayes factor', 'low', 'high'], rows: factors.map((f) => [f.x, f.g, f.v, f.low, f.high]) })));
    }
    return out;
  }
  const shownValue = (v) => (typeof v === 'number' ? v : JSON.stringify(v));

  function figures(run) {
    if (run.summary.sweep) return sweep(run);
    const { summary, draws } = run;
    const out = [modelProbabilities(run)];
    if (summary.damage) {
      const several = summary.kinds.length > 1;
      for (const kind of summary.kinds) {
        const inclusion = (several ? summary.damage.inclusion_by_element[kind.name] : summary.damage.inclusion_by_element)?.overall;
        if (inclusion?.length) out.push(beam(run, kind, inclusion, several));
      }
      out.push(...jointFigures(run));
    } else {
      out.push(...chain(run), ...laws(run));
    }
    out.push(...evidence(run));
    out.push(...residuals(run), ...responses(run));
    for (const [model, list] of Object.entries(draws.parameters)) {
      for (const p of list) out.push(marginal(model, p));
      for (const p of draws.pairs[model] || []) out.push(pair(model, p));
    }
    out.push(visits(run), running(run));
    if (draws.log_posterior) out.push(Object.assign(history('log-posterior', 'sampling', null, 'log posterior', draws.log_posterior, draws.draws, true), { wide: true }));
    out.push(...acceptance(run));
    for (const [model, list] of Object.entries(draws.parameters)) {
      for (const p of list) out.push(history(`history-${slug(model)}-${slug(p.name)}`, 'histories', model, p.name + unit(p.name, p.unit), p.history, draws.draws, false, isFraction(p.name)));
    }
    out.push(...emulator(run));
    // Two names may shorten to one.
    const seen = new Map();
    for (const f of out) {
      const n = (seen.get(f.id) || 0) + 1;
      seen.set(f.id, n);
      if (n > 1) f.id += '-' + n;
    }
    return out;
  }
  return { figures, themes, number, percent, probability, bracketed };
})();
