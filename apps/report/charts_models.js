// Charts that compare models: probabilities, evidences, and probabilities over a sweep.
const modelCharts = (({ percent, inLines, nameRoom, namesInLines, circles, frame, linear, axisX, axisY }) => {
  function modelProbabilities(run) {
    const all = run.summary.models;
    const shown = all.length <= 14 ? all : [...all].sort((a, b) => b.probability - a.probability).slice(0, 14);
    const keys = [...new Set(all.flatMap((m) => Object.keys(m)))].filter((k) => all.every((m) => typeof m[k] !== 'object' || m[k] === null));
    // Values have a separate column, because readers could mistake a value beside a bar for the prior.
    const label = (m) => (m.passed_over ? 'not evaluated' : m.mcse === null && m.basis ? 'not known' : percent(m.probability) + (m.basis === 'evidence' ? ' ᵉ' : ''));
    const room = 14 + 7 * Math.max(...shown.map((m) => label(m).length));
    return {
      id: 'model-probabilities', section: 'models', wide: true, title: 'Probability of each model',
      caption: `Bars: the posterior probability; whiskers: twice its Monte Carlo error; short strokes: the prior.${all.some((m) => m.basis === 'evidence') ? ' Values marked ᵉ, their bars and their whiskers come from the evidence, not from draws.' : ''}${shown.length < all.length ? ` The ${shown.length} most probable of ${all.length}.` : ''}`,
      table: () => ({ head: keys, rows: all.map((m) => keys.map((k) => m[k])) }),
      spec: (width, theme) => frame(width, 34 * shown.length, theme, {
        data: [{ name: 'm', values: shown.map((m, i) => ({ ...m, i, label: label(m), low: Math.max(0, m.probability - 2 * (m.mcse || 0)), high: Math.min(1, m.probability + 2 * (m.mcse || 0)) })) }],
        scales: [linear('x', [0, 1], [0, { signal: `width - ${room}` }]),
          { name: 'y', type: 'band', domain: { data: 'm', field: 'i' }, range: 'height', padding: 0.35 },
          { name: 'names', type: 'ordinal', domain: shown.map((_, i) => i), range: shown.map((m) => inLines(m.name, nameRoom(width))) }],
        axes: [axisX(null, { format: '%', grid: true, tickCount: width < 480 ? 3 : 5, labelFlush: false }),
          { orient: 'left', scale: 'y', domain: false, ticks: false, labelLimit: nameRoom(width), labelFontSize: 12, labelColor: theme.ink,
            labelPadding: 6, encode: namesInLines }],
        marks: [
          { type: 'rect', from: { data: 'm' }, encode: { enter: { x: { scale: 'x', value: 0 }, x2: { scale: 'x', field: 'probability' },
            y: { scale: 'y', field: 'i' }, height: { scale: 'y', band: 1 }, fill: { value: theme.main }, cornerRadius: { value: 1 },
            tooltip: { signal: "datum.name + ': ' + datum.label" } } } },
          { type: 'rule', from: { data: 'm' }, encode: { enter: { x: { scale: 'x', field: 'low' }, x2: { scale: 'x', field: 'high' },
            y: { scale: 'y', field: 'i', band: 0.5 }, stroke: { value: theme.ink }, strokeWidth: { value: 1.5 } } } },
          { type: 'rule', from: { data: 'm' }, encode: { enter: { x: { scale: 'x', field: 'prior' }, y: { scale: 'y', field: 'i', offset: -3 },
            y2: { scale: 'y', field: 'i', band: 1, offset: 3 }, stroke: { value: theme.other }, strokeWidth: { value: 2 } } } },
          { type: 'text', from: { data: 'm' }, encode: { enter: { x: { signal: 'width' }, align: { value: 'right' },
            y: { scale: 'y', field: 'i', band: 0.5 }, baseline: { value: 'middle' }, text: { field: 'label' }, fontSize: { value: 12 }, fontWeight: { value: 600 } } } },
        ],
      }),
    };
  }

  // Probabilities of the models by each method, side by side.
  function evidence(run) {
    const methods = Object.entries(run.summary.evidence || {}).filter(([, rows]) => Array.isArray(rows) && rows.some((r) => typeof r.probability === 'number'));
    if (!methods.length || run.summary.models.length === 1) return [];
    const models = run.summary.models;
    const values = [['chains', models.map((m) => ({ model: m.name, p: m.probability, se: m.mcse }))],
      ...methods.map(([method, rows]) => [method, rows.map((r) => ({ model: r.model, p: r.probability, se: r.probability_error }))])]
      .flatMap(([method, rows]) => rows.filter((r) => typeof r.p === 'number').map((r) => ({ ...r, method, i: models.findIndex((m) => m.name === r.model),
        low: Math.max(0, r.p - 2 * (r.se || 0)), high: Math.min(1, r.p + 2 * (r.se || 0)) })));
    const all = ['chains', ...methods.map(([m]) => m)];
    return [{
      id: 'evidence', section: 'models', wide: true, title: 'Probabilities from independent evidences',
      caption: 'Probabilities from the chains, and from methods that compute the evidence of each model separately. Whiskers: twice the standard error. The results should agree.',
      table: () => ({ head: ['method', 'model', 'ln evidence', 'standard error', 'ln Bayes factor', 'probability', 'error of the probability', 'likelihood evaluations'],
        rows: methods.flatMap(([method, rows]) => rows.map((r) => [method, r.model, r.log_evidence, r.standard_error, r.log_bayes_factor, r.probability, r.probability_error, r.likelihood_evaluations])) }),
      spec: (width, theme) => frame(width, (14 * all.length + 12) * models.length, theme, {
        data: [{ name: 'v', values }],
        scales: [linear('x', [0, 1], [0, { signal: 'width - 12' }]), { name: 'y', type: 'band', domain: models.map((_, i) => i), range: 'height', padding: 0.2 },
          { name: 'names', type: 'ordinal', domain: models.map((_, i) => i), range: models.map((m) => inLines(m.name, nameRoom(width))) },
          { name: 'sub', type: 'point', domain: all, range: [0, { signal: "bandwidth('y')" }], padding: 0.5 }, { name: 'm', type: 'ordinal', domain: all, range: theme.series }],
        axes: [axisX(null, { format: '%', grid: true, tickCount: width < 480 ? 3 : 5, labelFlush: false }),
          { orient: 'left', scale: 'y', domain: false, ticks: false, labelLimit: nameRoom(width), labelFontSize: 12, labelColor: theme.ink, labelPadding: 9, encode: namesInLines }],
        legends: [circles(width, all, 'm')],
        marks: [
          { type: 'rule', from: { data: 'v' }, encode: { enter: { x: { scale: 'x', field: 'low' }, x2: { scale: 'x', field: 'high' }, y: { scale: 'y', field: 'i', offset: { scale: 'sub', field: 'method' } }, stroke: { scale: 'm', field: 'method' }, strokeWidth: { value: 2 } } } },
          { type: 'symbol', from: { data: 'v' }, encode: { enter: { x: { scale: 'x', field: 'p' }, y: { scale: 'y', field: 'i', offset: { scale: 'sub', field: 'method' } }, fill: { scale: 'm', field: 'method' }, size: { value: 55 } } } },
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
    // An axis for zero and values over decades: linear up to the smallest positive value, then logarithmic.
    const smallest = Math.min(...rows.map((r) => r.value).filter((v) => v > 0));
    const fromZero = numeric && Math.min(...rows.map((r) => r.value)) === 0 && Math.max(...rows.map((r) => r.value)) > 30 * smallest;
    const x = { name: 'x', type: many ? 'log' : fromZero ? 'symlog' : 'linear', ...(fromZero ? { constant: smallest } : {}), domain: [Math.min(...rows.map(at)), Math.max(...rows.map(at))], range: 'width', padding: 10, zero: false };
    const lines = (id, title, caption, yTitle, values, group, domain, format, table) => ({
      id, section: 'sweep', wide: true, title, caption, table,
      spec: (width, theme) => frame(width, 200, theme, {
        data: [{ name: 'd', values }],
        scales: [x, linear('y', domain, 'height'), { name: 'g', type: 'ordinal', domain: group, range: theme.series }],
        axes: [axisX(path + (numeric ? '' : ' (number of the value)'), fromZero ? { values: rows.map((r) => r.value), tickCount: undefined } : {}), axisY(yTitle, { format })],
        legends: [circles(width, group, 'g')],
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
      out.push(lines('sweep-bayes-factor', 'Logarithm of the Bayes factor', 'Above zero, the data favour the first model. A point is missing if the chains have no draws of one of the models and give only a bound of the factor.', 'ln B',
        factors, [...new Set(factors.map((f) => f.g))], [Math.min(0, ...factors.map((f) => f.low)), Math.max(0, ...factors.map((f) => f.high))], undefined,
        () => ({ head: [path, 'models', 'ln Bayes factor', 'low', 'high'], rows: factors.map((f) => [f.x, f.g, f.v, f.low, f.high]) })));
    }
    return out;
  }
  const shownValue = (v) => (typeof v === 'number' ? v : JSON.stringify(v));

  return { modelProbabilities, evidence, sweep };
})(kit);
