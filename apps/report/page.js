// Builds the page from the run's data. Everything from input is inserted as text.
(() => {
  const run = JSON.parse(document.getElementById('run').textContent);
  const { summary, draws = {}, told = [], resolution = '' } = run;
  const main = document.getElementById('content');
  const about = summary.wheeltap;
  const { number, percent, pValue, r2 } = charts;

  function element(name, properties = {}, ...children) {
    const node = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
      if (key === 'class') node.className = value;
      else if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
      else node.setAttribute(key, value);
    }
    node.append(...children.filter((c) => c !== null && c !== undefined));
    return node;
  }
  // A cell is a text, a number, or a number with the text that shows it: { value, text }.
  const plain = (cell) => (cell && typeof cell === 'object' && 'value' in cell ? cell.value : cell);
  const shown = (x) => (x && typeof x === 'object' && 'text' in x ? x.text : typeof x === 'number' ? (Number.isInteger(x) ? String(x) : number(x, 4)) : x === null || x === undefined ? '–' : String(x));

  // Values keep all their digits in data-value and in copied tables.
  function table({ head, rows, caption }) {
    // Columns with text are left-aligned.
    const words = head.map((_, i) => rows.some((row) => typeof plain(row[i]) === 'string'));
    const body = rows.map((row) => element('tr', {}, ...row.map((cell, i) => {
      const name = i === 0 && typeof plain(cell) !== 'number';
      const node = element(name ? 'th' : 'td', name ? { scope: 'row', dir: 'auto' } : {}, shown(cell));
      if (typeof plain(cell) === 'number') node.dataset.value = plain(cell);
      else {
        if (words[i]) node.classList.add('words');
        if (String(cell).length > 24) node.classList.add('long');
      }
      return node;
    })));
    return element('table', {}, caption ? element('caption', {}, element('span', {}, caption)) : null,
      element('thead', {}, element('tr', {}, ...head.map((h, i) => element('th', words[i] ? { scope: 'col', class: 'words' } : { scope: 'col' }, h)))), element('tbody', {}, ...body));
  }
  const tabSeparated = (data) => rowsOf(data).map((row) => row.map((c) => (c === null || c === undefined ? '' : String(c))).join('\t')).join('\n');
  async function copy(text, button) {
    const label = button.textContent;
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      const area = element('textarea');
      area.value = text;
      document.body.append(area);
      area.select();
      document.execCommand('copy');
      area.remove();
    }
    button.textContent = 'Copied';
    setTimeout(() => { button.textContent = label; }, 1500);
  }
  const rowsOf = ({ head, rows }) => [head, ...rows].map((row) => row.map(plain));
  const scrolled = (data, tall) => element('div', { class: 'scroll' + (tall ? ' tall' : ''), tabindex: '0', role: 'region', 'aria-label': data.caption || 'table' }, table(data));
  function copyable(data) {
    const button = element('button', { type: 'button' }, 'Copy the table');
    button.addEventListener('click', () => copy(tabSeparated(data), button));
    return element('div', {}, scrolled(data, true), button, ' ', exporting.csvButton(data.caption || 'table', () => rowsOf(data)));
  }

  // ---- figures ----------------------------------------------------------------------------
  const all = charts.figures(run);
  const drawn = [];
  let theme = null;
  const wantedTheme = () => charts.themes[!matchMedia('print').matches && matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light'];

  function draw(one) {
    const width = Math.floor(one.place.clientWidth);
    if (width < 40) return;
    one.width = width;
    one.view?.finalize();
    one.place.replaceChildren();
    one.view = new vega.View(vega.parse(one.figure.spec(width, theme)), { renderer: 'svg', container: one.place, hover: true });
    one.view.run();
    const svg = one.place.querySelector('svg');
    svg?.setAttribute('aria-label', one.figure.name || one.figure.title);
  }
  function figureElement(figure, level) {
    const name = figure.name || figure.title; // for uses outside of its section
    const place = element('div', { class: 'chart', id: 'figure-' + figure.id });
    const one = { figure, place };
    drawn.push(one);
    one.light = async () => {
      const view = new vega.View(vega.parse(figure.spec(figure.wide ? 720 : 380, charts.themes.light)), { renderer: 'none' });
      const text = await view.toSVG(), [width, height] = ['width', 'height'].map((key) => Number(new RegExp(`^<svg[^>]* ${key}="([\\d.]+)"`).exec(text)[1]));
      return { text, width, height };
    };
    const saveButtons = exporting.figureButtons(name, one.light);
    const numbers = element('details', {}, element('summary', { 'aria-label': 'Numbers: ' + name }, 'Numbers'));
    numbers.addEventListener('toggle', () => {
      if (numbers.childElementCount > 1) return;
      const data = figure.table();
      const button = element('button', { type: 'button' }, 'Copy the table');
      button.addEventListener('click', () => copy(tabSeparated(data), button));
      numbers.append(scrolled({ ...data, caption: name }), button, ' ', exporting.csvButton(name, () => rowsOf(data)));
    });
    const zoom = [];
    if (figure.zoom) {
      const [first, last] = figure.zoom;
      const go = (change) => () => {
        let [a, b] = change(...one.view.signal('shown'));
        const span = Math.min(b - a, last - first);
        a = Math.max(first, Math.min(a, last - span));
        one.view.signal('shown', [a, a + span]).run();
      };
      for (const [label, change] of [['Zoom in', (a, b) => [a + (b - a) / 4, b - (b - a) / 4]], ['Zoom out', (a, b) => [a - (b - a) / 2, b + (b - a) / 2]],
        ['Earlier', (a, b) => [a - (b - a) / 2, b - (b - a) / 2]], ['Later', (a, b) => [a + (b - a) / 2, b + (b - a) / 2]], ['All', () => [first, last]]])
        zoom.push(element('button', { type: 'button', onclick: go(change) }, label));
    }
    return element('figure', { class: figure.wide ? 'wide' : '', 'data-figure': figure.id },
      element('h' + level, { dir: 'auto' }, figure.title), figure.caption ? element('figcaption', { dir: 'auto' }, figure.caption) : null,
      place, element('div', { class: 'tools' }, ...zoom, ...saveButtons, numbers));
  }
  const grid = (list, level = 3, more = '') => element('div', { class: 'figures' + more }, ...list.map((f) => figureElement(f, level)));
  const of = (section, group) => all.filter((f) => f.section === section && (group === undefined || f.group === group));

  function section(id, title, lead, ...content) {
    const filled = content.filter(Boolean);
    if (!filled.length) return;
    main.append(element('section', { id, 'aria-labelledby': id + '-title' }, element('h2', { id: id + '-title' }, title), lead ? element('p', { class: 'lead' }, lead) : null, ...filled));
    document.getElementById('contents').append(element('a', { href: '#' + id }, title));
  }

  // As many digits as distinguish the ends of the interval; a copied table keeps all digits.
  const digits = (row, key) => {
    const x = row[key];
    if (key.startsWith('ess')) return String(Math.round(x));
    if (key === 'rhat') return x.toFixed(4);
    const width = row['q97.5'] - row['q2.5'];
    if (key === 'sd' || !(width > 0)) return number(x, 3);
    const magnitude = Math.max(...['q2.5', 'q50', 'q97.5'].map((k) => Math.abs(row[k])));
    return number(x, Math.min(10, Math.max(3, Math.ceil(Math.log10(magnitude / width)) + 3)));
  };
  const parameterRows = (rows, unknowns) => {
    const titled = (name) => name + charts.bracketed((unknowns || []).find((u) => u.label === name)?.unit);
    const keys = [...new Set(Object.values(rows).flatMap((r) => Object.keys(r)))].filter((k) => Object.values(rows).every((r) => typeof r[k] !== 'object' || r[k] === null));
    return { head: ['parameter', ...keys.map((k) => ({ 'q2.5': '2.5 %', q50: '50 %', 'q97.5': '97.5 %', ess_bulk: 'ESS bulk', ess_tail: 'ESS tail', rhat: 'R-hat', prior_overlap: 'prior overlap' })[k] || k)],
      rows: Object.entries(rows).map(([name, r]) => [titled(name), ...keys.map((k) => (typeof r[k] === 'number' ? { value: r[k], text: digits(r, k) } : r[k]))]) };
  };

  const worded = (x, words) => (typeof x === 'number' ? { value: x, text: words(x) } : null);
  // Natural frequencies and damping ratios of a chain's linear part.
  function modesTable(rows) {
    if (!Array.isArray(rows) || !rows.length) return [];
    const cells = (r) => ['q50', 'q2.5', 'q97.5'].map((key) => worded(r?.[key], () => digits(r, key)));
    return [copyable({ head: ['mode', 'frequency [Hz]', '2.5 %', '97.5 %', 'damping ratio', '2.5 %', '97.5 %'], caption: 'Modes of the linear part of the chain: median and 95 % interval',
      rows: rows.map((m, i) => [i + 1, ...cells(m.frequency_hz), ...cells(m.damping_ratio)]) })];
  }

  // A sentence without line breaks within "--warmup".
  const prose = (text) => String(text).split(/(--[a-z][a-z-]*)/).map((part, i) => (i % 2 ? element('code', { class: 'option' }, part) : part));

  // Intervals of each parameter, from the likelihood with white residuals and from windows, and the interval to use.
  const windowRows = (rows, unknowns) => {
    const windowed = Object.entries(rows).filter(([, r]) => r.between_windows);
    if (!windowed.length) return null;
    const unit = (name) => charts.bracketed((unknowns || []).find((u) => u.label === name)?.unit);
    const interval = (r) => (r ? { value: `${r['q2.5']} to ${r['q97.5']}`, text: `${digits(r, 'q2.5')} to ${digits(r, 'q97.5')}` } : '-');
    return { head: ['parameter', 'this run', 'longer records', 'a further window', 'windows scatter by', 'use'],
      rows: windowed.map(([name, r]) => [name + unit(name), interval(r), interval(r.between_windows.whole), interval(r.between_windows),
        { value: r.between_windows.scatter.times_own_interval, text: `${number(r.between_windows.scatter.times_own_interval, 2)} times` }, r.between_windows.use]),
      caption: '95 % intervals. This run: the posterior. Longer records: the value that the estimate approaches as the record length increases. A further window: the value that a further window would give. Scatter: standard deviation of the estimates between windows, divided by the posterior standard deviations within windows' };
  };

  // ---- sections ---------------------------------------------------------------------------
  function caseNotes() {
    const notes = [summary.notes || []].flat();
    return notes.length ? [element('h3', { class: 'apart' }, 'Notes in the case'), ...notes.map((n) => element('p', { dir: 'auto' }, n))] : [];
  }
  function bayesFactors() {
    const rows = summary.log_bayes_factors || [];
    if (!rows.length) return [];
    const said = (r) => (typeof r.log_bayes_factor === 'number' ? { value: r.log_bayes_factor, text: r.log_bayes_factor.toFixed(2) } : r.evaluated === false ? 'not evaluated' : 'not known');
    return [element('h3', { class: 'apart' }, 'Bayes factors'),
      copyable({ head: ['model', 'against', 'ln Bayes factor', 'Monte Carlo error', 'from', 'never visited'], caption: 'Above zero, the data favour the first model',
        rows: rows.map((r) => [r.model, r.against, said(r), typeof r.mcse === 'number' ? { value: r.mcse, text: number(r.mcse, 2) } : null, r.basis, r.never_visited]) })];
  }
  function evidenceTable() {
    const rows = Object.entries(summary.evidence || {}).flatMap(([method, list]) => (Array.isArray(list) ? list : []).map((r) => [method, r.model,
      ...[[r.log_evidence, 6], [r.standard_error, 2], [r.log_bayes_factor, 5], [r.probability, 4], [r.probability_error, 2], [r.likelihood_evaluations, 8]].map(([x, n]) => (typeof x === 'number' ? { value: x, text: number(x, n) } : null)),
      (r.warnings || []).join(' ') || 'none']));
    if (!rows.length) return [];
    return [element('h3', { class: 'apart' }, 'Evidence of each model'),
      copyable({ head: ['method', 'model', 'ln evidence', '±', 'ln Bayes factor', 'P(model)', '±', 'likelihood evaluations', 'warnings'], rows, caption: 'ln Bayes factors are against the first model; ± is one standard error' })];
  }
  // Tables of an update: measured modes with their information, and predicted modes.
  function updateTables() {
    if (about.command !== 'update') return [];
    const of = (x, n) => (typeof x === 'number' ? { value: x, text: number(x, n) } : null);
    const predicted = summary.predictions || [];
    const inside = (p) => (p.inside === null ? '–' : p.inside ? 'inside' : 'outside');
    const solutions = summary.solutions || [];
    const range = (e) => ({ value: e.q50, text: `${digits(e, 'q50')} (${digits(e, 'q2.5')} to ${digits(e, 'q97.5')})` });
    return [...(solutions.length ? [element('h3', { class: 'apart' }, 'Separate solutions'), copyable({
      head: ['parameter', ...solutions.map((s, i) => `solution ${i + 1} (${percent(s.probability)})`)],
      rows: Object.keys(solutions[0].parameters).map((name) => [name, ...solutions.map((s) => range(s.parameters[name]))]), caption: 'Median and 95 % interval of each parameter within each solution, and the probability of the solution' })] : []),
    element('h3', { class: 'apart' }, 'Each measured mode'), copyable({
      head: ['mode', 'measured [Hz]', 'sd [Hz]', 'model [Hz]', 'off by [sd]', 'computed mode', 'MAC', 'p of the shape', 'information [nats]', 'largest shift without it', 'by [posterior sd]'],
      rows: (summary.data?.modes || []).map((m) => [m.mode, of(m.observed, 6), of(m.sd, 3), of(m.mean, 6), of(m.standardised_residual, 3), m.spurious > 0.5 ? `none (P ${number(m.spurious, 3)})` : m.computed_mode, of(m.shape?.mac?.q50, 4), of(m.shape?.p, 3),
        of(m.without_it?.information_nats, 3), (m.without_it?.reliable && m.without_it.moves) || '–', m.without_it?.reliable ? of(m.without_it.by_sd, 2) : null]), caption: 'Frequencies and shapes, and the change of the posterior if the data lack this mode' }),
    ...(predicted.length ? [element('h3', { class: 'apart' }, 'Predicted modes'), copyable({ head: ['mode', 'model [Hz]', '2.5 % [Hz]', '97.5 % [Hz]', 'held out [Hz]', 'in the interval'],
      rows: predicted.map((p) => [p.mode, of(p.frequency_hz.q50, 5), of(p.measurement_hz['q2.5'], 5), of(p.measurement_hz['q97.5'], 5), of(p.held_out_hz, 6), inside(p)]), caption: 'Predicted frequency of the model, and 95 % prediction interval of a measured frequency' })] : [])];
  }
  // Table of a damage run with states: every mode of each state.
  function statesTable() {
    const rows = (summary.data?.modes || []).filter((m) => m.state);
    if (!rows.length) return [];
    const of = (x, n) => (typeof x === 'number' ? { value: x, text: number(x, n) } : null);
    return [element('h3', { class: 'apart' }, 'Each measured mode'), copyable({ head: ['state', 'mode', 'measured [Hz]', 'sd [Hz]', 'model [Hz]', 'off by [sd]'],
      rows: rows.map((m) => [m.state, m.mode_of_state, of(m.observed, 6), of(m.sd, 3), of(m.mean, 6), of(m.standardised_residual, 3)]), caption: 'Frequencies of every state. Off by: measured minus model frequency, in standard deviations of the measurement and model errors together' })];
  }
  // Table of a damage run: the answer without each measured mode.
  function contributionsTable() {
    const rows = summary.damage ? (summary.data?.modes || []).filter((m) => m.without_it) : [];
    if (rows.length < 2) return [];
    const best = [...summary.models].sort((a, b) => b.probability - a.probability)[0];
    const states = rows.some((m) => m.state), shaped = rows.some((m) => m.shape);
    const said = ({ information_nats: x, reliable }) => (typeof x === 'number' ? { value: x, text: (reliable ? '' : '> ') + number(x, 2) } : null);
    return [element('h3', { class: 'apart' }, 'Information of each mode'), copyable({
      head: [...(states ? ['state'] : []), 'mode', ...(shaped ? ['MAC'] : []), 'information [nats]', `P(${best.name}) without it`],
      rows: rows.map((m) => [...(states ? [m.state ?? ''] : []), states ? m.mode_of_state : m.mode, ...(shaped ? [m.shape ? { value: m.shape.mac.q50, text: number(m.shape.mac.q50, 4) } : null] : []),
        said(m.without_it), m.without_it.reliable ? worded(m.without_it.probability, percent) : '–']),
      caption: `Change of the posterior without the mode; with all modes, the probability of ${best.name} is ${percent(best.probability)}. –: the draws cannot determine such a large change` })];
  }
  function baselineTable() {
    const rows = Object.entries(summary.baseline?.parameters || {});
    const error = summary.baseline?.model_error;
    if (!rows.length && !error) return [];
    const of = (x, n) => (typeof x === 'number' ? { value: x, text: number(x, n) } : null);
    const table = copyable({ head: ['parameter', 'prior', '2.5 %', '50 %', '97.5 %', 'contracted by'],
      rows: rows.map(([name, p]) => [name, p.prior, of(p.posterior['q2.5'], 6), of(p.posterior.q50, 6), of(p.posterior['q97.5'], 6), { value: p.contraction, text: `${Math.round(100 * Math.max(0, p.contraction))} %` }]), caption: '0 %: the data contain no information about the value; 100 %: the prior has no effect' });
    return [element('h3', { class: 'apart' }, 'The intact structure'), ...(rows.length ? [table] : []),
      element('p', { class: 'lead' }, [summary.baseline.check.statement, error].filter(Boolean).join(' '))];
  }
  // The count with neighbouring damages counted as one, if it differs.
  function mergedCounts() {
    const all = summary.damage?.merged;
    const kinds = !all ? [] : all.probability_of_count ? [[null, all]] : Object.entries(all);
    const rows = kinds.filter(([, m]) => m.probability_merged >= 0.005).flatMap(([kind, m]) => Object.entries(m.probability_of_count)
      .map(([n, p]) => [kind === null ? n : `${n} (${kind})`, { value: p, text: charts.probability(p) }]));
    return rows.length ? [element('h3', { class: 'apart' }, 'Neighbouring damages counted as one'),
      copyable({ head: ['count', 'probability'], rows, caption: 'If one longer damage explains the data as well as several adjacent damages, these damages count as one' })] : [];
  }
  // Models whose probability does not come from draws.
  function toldByEvidence() {
    if (!told.length) return [];
    const list = element('ul', { class: 'warnings' }, ...told.map((t) => element('li', { dir: 'auto' }, t)));
    return [told.length > 6 ? element('details', {}, element('summary', {}, `${told.length} models without draws, and their probabilities from evidence`), list) : list];
  }
  // Parallel tempering, if the run used it.
  function ladder(d) {
    if (!d.ladder) return [];
    const trips = d.ladder.round_trips;
    const barrier = typeof d.ladder.barrier === 'number' ? ` The barrier between prior and posterior is ${number(d.ladder.barrier, 3)}: parallel tempering needs about this number of temperatures, and works better with twice as many.` : '';
    return [element('p', {}, d.ladder.while_drawing
      ? `The draws come from parallel tempering: replicas went ${trips} times from the prior to the posterior and back. With fewer than about ten round trips, each chain may explore a different region.${barrier}`
      : `The run used tempering in warm-up only: the draws come from chains without tempering.${barrier}`)];
  }
  function runSections() {
    const d = summary.diagnostics;
    const warnings = d.warnings || [];
    const several = summary.models.length > 1; // a single model needs no comparison
    const p = summary.data?.posterior_predictive_p;
    section('warnings', 'Convergence and warnings', null,
      element('p', {}, d.converged ? 'The chains have converged: ' : 'The chains have not converged: ',
        `largest R-hat ${number(d.rhat_max, 5)} (must be below 1.01), effective sample size of the model ${number(d.ess_model, 4)}` +
        (typeof d.ess_log_posterior === 'number' ? `, of the log posterior ${number(d.ess_log_posterior, 4)} (must exceed 400)` : '') +
        (d.round_trips > 0 ? `; ${d.round_trips} round trips between the smallest and the largest model` : '') + '.'),
      resolution ? element('p', {}, ...prose(`Resolution of the searches: ${resolution}. More searches (--search) refine the resolution.`)) : null,
      warnings.length ? element('ul', { class: 'warnings' }, ...warnings.map((w) => element('li', { dir: 'auto' }, ...prose(w)))) : element('p', {}, 'No warnings.'),
      ...(d.notes || []).map((n) => element('p', { dir: 'auto' }, ...prose(n))), ...caseNotes());

    const evidences = [...mergedCounts(), ...toldByEvidence(), ...bayesFactors(), ...evidenceTable()];
    if (several || evidences.length) section('models', summary.damage ? 'Number of damages' : several ? 'Model probabilities' : 'Evidence', null, grid(of('models')), ...evidences);

    const mirrored = d.symmetry?.statement;
    // Charts of a link form one group.
    const links = [...new Set(of('where').map((f) => f.group).filter(Boolean))];
    const whole = of('where').filter((f) => !f.group);
    section('where', summary.damage ? 'Location and severity' : 'The structure', mirrored, whole.length ? grid(whole) : null, ...links.flatMap((key) => {
      const lead = of('where', key).find((f) => f.lead)?.lead;
      return [element('h3', { class: 'apart' }, `Link ${key}`), lead ? element('p', { class: 'lead' }, lead) : null, grid(of('where', key), 4, ' pairs')];
    }));

    if (summary.structure?.drawing?.modes?.length) section('shapes', 'Mode shapes', null, shapeView(summary.structure, element));

    const folded = summary.damage?.folded;
    section('fit', 'Data and model', typeof p === 'number' ? `Posterior predictive p-value ${pValue(p)}: the probability that data simulated from these models deviate from the models at least as much as the measured data do. Below 0.005, no model here explains the data.` : null,
      of('fit').length ? grid(of('fit')) : null);

    const fits = Object.entries(summary.fit_at_mean || summary.fit || {}).filter(([, rows]) => Array.isArray(rows) && rows.length && rows.every((r) => r && typeof r === 'object'));
    document.getElementById('fit')?.append(...updateTables(), ...statesTable(), ...contributionsTable());
    if (fits.length) {
      document.getElementById('fit')?.append(element('h3', { class: 'apart' }, 'Fit of each model at its posterior mean'), copyable({
        head: ['model', 'channel', 'rmse', 'nrmse', 'R²', 'noise sd', 'residuals white? p'],
        rows: fits.flatMap(([model, rows]) => rows.map((r) => [model, r.channel, r.rmse, r.nrmse, worded(r.r2, r2), r.noise_sd, worded(r.whiteness?.p_value, pValue)])), caption: 'Residuals of each response channel' }));
    }
    const perModel = Object.keys(summary.parameters).flatMap((model) => {
      const probability = summary.models.find((m) => m.name === model)?.probability;
      const out = [element('h3', { dir: 'auto' }, several ? `${model} (${charts.probability(probability)})` : model)];
      if (Object.keys(summary.parameters[model]).length) out.push(copyable({ ...parameterRows(summary.parameters[model], summary.unknowns?.[model]), caption: 'Posterior given this model' }));
      else out.push(element('p', { class: 'lead' }, 'No parameters.'));
      out.push(...modesTable(summary.modes?.[model]));
      const windows = windowRows(summary.parameters[model], summary.unknowns?.[model]);
      if (windows) out.push(copyable(windows));
      if (folded?.[model]) out.push(copyable({ ...parameterRows(folded[model]), caption: 'Folded: distances of the locations from the nearer end, so that mirror images coincide' }));
      if (of('parameters', model).length) out.push(grid(of('parameters', model), 4));
      if (of('pairs', model).length) out.push(element('h4', {}, 'Pairs'), grid(of('pairs', model), 4));
      return [element('section', { class: 'model', 'aria-label': model }, ...out)];
    });
    section('parameters', 'Parameters', 'Posterior and prior. A posterior that equals its prior is not a result.', ...baselineTable(), ...perModel);

    const histories = [...new Set(of('histories').map((f) => f.group))].flatMap((model) => [element('h4', { dir: 'auto' }, `Histories given ${model}`), grid(of('histories', model), 4)]);
    const rhats = d.rhat && Object.keys(d.rhat).length ? copyable({ head: ['quantity', 'R-hat'], rows: Object.entries(d.rhat), caption: 'R-hat of the quantities that all models share, and of the parameters within each model' }) : null;
    section('sampling', 'Sampling', 'Converged chains look alike, have no trend and change often between models.', ...ladder(d), grid(of('sampling')), ...histories, rhats ? element('h4', {}, 'Convergence') : null, rhats);

    section('emulator', 'The emulator', null, of('emulator').length ? grid(of('emulator')) : null);
  }
  function sweepSections() {
    const { path, rows } = summary.sweep;
    const warnings = rows.flatMap((r) => r.warnings.map((w) => `${path} = ${JSON.stringify(r.value)}: ${w}`));
    section('warnings', 'Warnings', null, warnings.length ? element('ul', { class: 'warnings' }, ...warnings.map((w) => element('li', { dir: 'auto' }, ...prose(w)))) : element('p', {}, 'No warnings.'));
    section('sweep', 'The sweep', null, grid(of('sweep')), ...toldByEvidence());
    section('parameters', 'Parameters', null, ...rows.flatMap((r) => [element('h3', { class: 'apart' }, `${path} = ${JSON.stringify(r.value)}`),
      ...Object.entries(r.parameters).filter(([, list]) => Object.keys(list).length).map(([model, list]) => copyable({ ...parameterRows(list), caption: model }))]));
  }
  if (summary.sweep) sweepSections();
  else runSections();

  const command = about.command_line || `wheeltap ${about.command} ${about.case_file || 'CASE'} --seed ${about.seed}`;
  const facts = [['Case', about.case_file], ['Wheeltap', about.version], ['Seed', about.seed], ['Machine', about.machine], ['Written', draws.created_at], ['Data', summary.data?.origin],
    ['Chains', summary.cost && `${summary.cost.chains ?? draws.chains} of ${summary.cost.draws_a_chain ?? draws.draws} draws`],
    ['Likelihood evaluations', summary.cost?.likelihood_evaluations], ['Time', summary.cost && `${number(summary.cost.wall_seconds, 3)} s`]];
  const again = element('button', { type: 'button' }, 'Copy');
  again.addEventListener('click', () => copy(command, again));
  section('about', 'About this run', null,
    element('dl', {}, ...facts.filter(([, v]) => v !== undefined && v !== null && v !== '').flatMap(([k, v]) => [element('dt', {}, k), element('dd', { dir: 'auto' }, String(v))]),
      element('dt', {}, 'Command'), element('dd', {}, element('code', {}, command), ' ', again)),
    element('details', {}, element('summary', {}, 'The case'), element('pre', {}, JSON.stringify(about.case, null, 1))));

  const title = document.querySelector('h1').textContent;
  document.querySelector('header').append(element('div', { class: 'tools' }, ...exporting.pageButtons(title, () => [document.querySelector('header'), main],
    (picture) => drawn.find((one) => one.place.contains(picture))?.light() ?? exporting.svgOf(picture))));

  // ---- drawing ----------------------------------------------------------------------------
  function drawAll() {
    theme = wantedTheme();
    for (const one of drawn) draw(one);
  }
  // Draws the first figures first; the rest follows without blocking the page.
  async function drawInTurn() {
    theme = wantedTheme();
    let since = performance.now();
    for (const one of drawn) {
      if (one.width === undefined) draw(one);
      if (performance.now() - since < 50) continue;
      await new Promise((go) => setTimeout(go));
      since = performance.now();
    }
    document.documentElement.dataset.ready = 'true';
  }
  drawInTurn();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawAll);
  matchMedia('print').addEventListener('change', drawAll);
  let waiting = 0;
  new ResizeObserver(() => {
    cancelAnimationFrame(waiting);
    waiting = requestAnimationFrame(() => {
      for (const one of drawn) if (one.width !== undefined && Math.floor(one.place.clientWidth) !== one.width) draw(one);
    });
  }).observe(main);
})();
