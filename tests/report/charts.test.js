// The charts without a page: formats of numbers, chains, and layouts in little space.
const test = require('node:test');
const assert = require('node:assert/strict');
const fs = require('node:fs');
const path = require('node:path');
const vm = require('node:vm');

const folder = path.join(__dirname, '../../apps/report');
const files = fs.readFileSync(path.join(folder, 'assets.cmake'), 'utf8').match(/charts(_\w+)?\.js/g);
const script = files.map((name) => fs.readFileSync(path.join(folder, name), 'utf8')).join('');
// What is made within the script is copied: other prototypes are not equal.
const { charts, kit, modelCharts, chainCharts, recordCharts, samplingCharts } = vm.runInNewContext(script + '; ({ charts, kit, modelCharts, chainCharts, recordCharts, samplingCharts })');
const copied = (x) => JSON.parse(JSON.stringify(x));
const light = kit.themes.light;

test('numbers are in one style', () => {
  for (const [x, words] of [[0.00000537427, '5.374e-6'], [1.65e-9, '1.65e-9'], [1e9, '1e9'], [123456, '123500'], [0.00012, '0.00012'], [0, '0'], [NaN, '–']])
    assert.equal(kit.number(x), words);
  assert.equal(kit.restyled('log_uniform [1e-06, 2e+07]'), 'log_uniform [1e-6, 2e7]');
  assert.equal(kit.restyled('half_normal 8.3381394383476665e+06, uniform [0, 0.013331581068898441], 0.00012345678'), 'half_normal 8.3381e6, uniform [0, 0.013332], 0.00012345678');
});

test('R² is 1 only where nothing is left, and p never 0', () => {
  assert.equal(kit.r2(0.99997), '0.99997'); // was "1"
  assert.equal(kit.r2(0.99999999), '0.99999999');
  assert.equal(kit.r2(1 - 1e-13), '> 0.999999999');
  assert.equal(kit.r2(1), '1');
  assert.equal(kit.r2(-0.28), '-0.28');
  assert.equal(kit.pValue(0), '< 1e-15');
  assert.equal(kit.pValue(0.031), '0.031');
});

test('ticks are plain from a thousandth to a million, and otherwise powers without a plus', () => {
  const axis = (low, high) => kit.axisX(null, { format: kit.tickFormat(low, high) });
  assert.equal(axis(0, 20000).format, '.12~g'); // "20000", not "20,000"
  assert.match(axis(0, 1e-5).format, /e$/);
  assert.match(JSON.stringify(axis(0, 1e-5).encode), /'e\+', 'e'/);
  assert.equal(kit.axisX(null, { format: undefined }).format, '.12~g');
});

test('ticks of logarithmic axes lie within them and are two or more', () => {
  for (const [low, high, ticks] of [[3e-5, 2e2, [1e-4, 1e-3, 0.01, 0.1, 1, 10, 100].filter((_, i) => i % 2 === 0)], [0.5, 30, [1, 10]], [1.5, 8, [2, 5]], [2.1, 2.3, [2.1, 2.3]]])
    assert.deepEqual(copied(kit.powersOfTen([low, high])), ticks);
});

test('a prediction without noise does not squeeze the spectrum of what was measured', () => {
  const spectrum = Array.from({ length: 50 }, (_, i) => [i + 1, 100 / (i + 1), 100 * 10 ** -i, 1e-2]);
  const made = { draws: { responses: [{ name: 'y', unit: 'm', history: [[0, 1, 0, null, 1, null, 2, 0], [1, 2, 1, null, 2, null, 3, 0]], autocorrelation: [0], spectrum, samples: 99 }] } };
  const spec = recordCharts.responses(made).find((f) => f.id === 'spectrum-y').spec(700, light);
  assert.deepEqual(copied(spec.scales.find((s) => s.name === 'y').domain), [2.5e-3, 200]);
  // Lines end at the frame: a group of one line is clipped to the size of the chart, not to its own zero size.
  const [group] = spec.marks;
  assert.deepEqual([group.clip, group.encode.enter.height.signal, group.marks[0].clip], [true, 'height', undefined]);
});

test('a legend has a column for every name that there is room for, and no name is cut', () => {
  const long = ['Duffing with quadratic stiffness', 'linear'];
  assert.equal(kit.strokes(300, long).columns, 1);
  assert.equal(kit.strokes(700, long).columns, 2);
  assert.ok(kit.frame(300, 100, light, {}).config.legend.labelLimit > 200);
});

// A run with these models; the last one is the most probable.
function run(masses, links, found = {}, more = {}) {
  return { laws: { contact: [{ name: 'stiffness', unit: 'N/m' }, { name: 'gap', unit: 'm' }], coulomb: [{ name: 'force', unit: 'N' }] },
    draws: {}, summary: { models: [{ name: 'm', probability: 1 }], parameters: { m: found }, links: {}, data: {},
      wheeltap: { case: { models: [{ name: 'm', masses, links }] } }, ...more } };
}
const drawing = (made, width) => chainCharts.chain(made)[0].spec(width, light);
const named = (spec, name) => copied(spec.data.find((d) => d.name === name).values);

test('masses have their values, and what was found its median and unit', () => {
  const made = run([1e9, 'm'], [{ between: [0, 1], stiffness: 'k' }], { m: { q50: 5.3713e-6 }, k: { q50: 0.99 } },
    { unknowns: { m: [{ label: 'm', unit: 'kg' }, { label: 'k', unit: 'V/V' }] } });
  const spec = drawing(made, 700);
  assert.deepEqual(named(spec, 'm').map((m) => m.text), ['mass 1: 1e9 kg', 'mass 2: m = 5.371e-6 kg']); // was "100000…", "mass 2: m"
  assert.deepEqual(named(spec, 'l')[0].text, ['0 – 1', 'stiffness k = 0.99 V/V']);
});

test('what the case states is in the units of the run', () => {
  const spec = drawing(run([1], [{ between: [0, 1], stiffness: 50, contact: { stiffness: 7, gap: 0.01 } }], {}, { data: { units: { force: 'V', length: 'mV/g' } } }), 700);
  assert.deepEqual(named(spec, 'l')[0].text, ['0 – 1', 'stiffness 50 V/(mV/g)', 'contact: stiffness 7 V/(mV/g), gap 0.01 (mV/g)']);
  const unknown = drawing(run([1], [{ between: [0, 1], stiffness: 50 }], {}, { data: { units: null } }), 700);
  assert.deepEqual(named(unknown, 'l')[0].text, ['0 – 1', 'stiffness 50']);
});

test('each law has a symbol of its own, and a damper alone no law at rest', () => {
  const path_of = (link) => named(drawing(run([1], [{ between: [0, 1], ...link }]), 700), 'l')[0].path;
  const paths = [{ stiffness: 1 }, { damping: 1 }, { coulomb: 1 }, { contact: { stiffness: 1, gap: 1, side: 'closing' } }, { contact: { stiffness: 1, gap: 1, side: 'opening' } },
    { bouc_wen: { stiffness: 1 } }, { cubic: 1 }].map(path_of);
  assert.equal(new Set(paths).size, paths.length);
  const at_rest = (tension) => chainCharts.laws(run([1], [], {}, { links: { m: [{ between: [0, 1], extension: [-1, 1], tension: { 'q2.5': tension, q50: tension, 'q97.5': tension } }] } }));
  assert.equal(at_rest([0, 0]).length, 0);
  assert.equal(at_rest([-1, 1]).length, 1);
});

test('terms that were found stand in the chain with their coefficients', () => {
  const term = (name, label, link, parameters) => ({ name, label, link, parameters: Object.fromEntries(parameters.map((p) => [p, {}])) });
  const name = 'base + contact 0-2 + contact closing 0-2 + coulomb 2-1';
  const made = run([9, 1], [{ between: [0, 2], damping: 3 }, { between: [2, 1] }]);
  Object.assign(made.summary, {
    models: [{ name, probability: 1 }],
    unknowns: { [name]: [['contact stiffness 0-2', 'N/m'], ['contact gap 0-2', 'm'], ['coulomb force 2-1', 'N']].map(([label, unit]) => ({ label, unit })) },
    parameters: { [name]: { 'contact stiffness 0-2': { q50: 5 }, 'contact gap 0-2': { q50: 0.1 }, 'contact stiffness closing 0-2': { q50: 6 },
      'contact gap closing 0-2': { q50: 0.2 }, 'coulomb force 2-1': { q50: 10 } } },
    terms: [term('contact', 'contact 0-2', [0, 2], ['contact stiffness 0-2', 'contact gap 0-2']),
      term('contact closing', 'contact closing 0-2', [0, 2], ['contact stiffness closing 0-2', 'contact gap closing 0-2']),
      term('coulomb', 'coulomb 2-1', [2, 1], ['coulomb force 2-1']), term('coulomb', 'coulomb 0-2', [0, 2], ['coulomb force 0-2'])],
  });
  made.summary.wheeltap.case.models[0].name = 'base';
  const lines = named(drawing(made, 1000), 'l').map((l) => l.text);
  assert.ok(lines.some((l) => l.includes('Coulomb friction = 10 N')), JSON.stringify(lines));
  const all = lines.flat().join(' ').replace(/ +/g, ' ');
  assert.match(all, /contact: stiffness = 5 N\/m, gap = 0.1 m/);
  assert.match(all, /contact, closing: stiffness = 6, gap = 0.2/);
  assert.ok(!all.includes('0-2'), all);
});

test('a chain that stands on nothing has no ground', () => {
  const texts = (links) => JSON.stringify(drawing(run([1, 1], links), 700).marks);
  assert.match(texts([{ between: [0, 1], stiffness: 1 }]), /"ground"/);
  assert.doesNotMatch(texts([{ between: [1, 2], stiffness: 1 }]), /"ground"/);
});

test('words of a chain stand beneath it where they have no room beside it, uncut', () => {
  const made = run([1e9, 100], [{ between: [0, 2], contact: { gap: 'g_close', stiffness: 'k' } }, { between: [2, 1], coulomb: 'F' }], { g_close: { q50: 0.002699 }, k: { q50: 5081000 }, F: { q50: 10010 } });
  for (const width of [300, 368, 700, 1000]) {
    const spec = drawing(made, width);
    const lines = named(spec, 'l').flatMap((l) => l.text);
    assert.ok(!lines.join('').includes('…'), `${width} px: ${lines}`);
    const { x, limit } = spec.marks.find((m) => m.type === 'text' && m.from?.data === 'l').encode.enter;
    for (const line of lines) assert.ok(x.value + 6.2 * line.length <= width && 6.2 * line.length <= limit.value, `${width} px: ${line}`);
    for (const l of named(spec, 'l')) assert.ok(l.y + 13 * (l.text.length - 1) < spec.height, `${width} px: ${l.text} below the chart`);
  }
  assert.equal(named(drawing(made, 700), 'l')[1].text[0], '2 – 1'); // as the case names it
});

test('a value is not beside the stroke of the prior, and a long name stands on two lines', () => {
  const made = run([1], []);
  made.summary.models = [{ name: 'linear', probability: 0.0001, prior: 0.5, mcse: 0 }, { name: 'Duffing with quadratic stiffness', probability: 0.9999, prior: 0.5, mcse: 0 }];
  const spec = modelCharts.modelProbabilities(made).spec(368, light);
  const label = spec.marks.find((m) => m.type === 'text').encode.enter;
  assert.deepEqual([label.x.signal, label.align.value], ['width', 'right']);
  assert.deepEqual(copied(spec.scales.find((s) => s.name === 'names').range), [['linear'], ['Duffing with', 'quadratic stiffness']]);
});

test('a legend names a prior only where one is drawn', () => {
  const p = { name: 'ar[1]', bins: { from: 0, width: 1, n: 2 }, density: [0.5, 0.5] };
  const names = (more) => copied(samplingCharts.marginal('m', { ...p, ...more }).spec(300, light).scales.find((s) => s.name === 'who').domain);
  assert.deepEqual(names({}), ['posterior']);
  assert.deepEqual(names({ prior: { words: 'uniform [0, 2]', x: [0, 2], density: [0.5, 0.5] } }), ['posterior', 'prior']);
});

test('the MAC of an update shows every pair that was compared, and no other', () => {
  const { modeCharts } = vm.runInNewContext(script + '; ({ modeCharts })');
  const run = { summary: { data: { mac: [[0.99, 0.02, 0.1], [null, null, null], [0.01, 0.2, 0.97]], shapes: [[1, 0.5], [null, null], [1, -1]], computed_shapes: [[0.98, 0.52], [null, null], [1.02, -0.9]], sensors: ['B, x', 'C, x'] } } };
  const [mac] = modeCharts.mac(run);
  assert.deepEqual(copied(mac.table().rows), [[1, 0.99, 0.02, 0.1], [3, 0.01, 0.2, 0.97]]);
  assert.equal(mac.spec(400, light).data[0].values.length, 6);
  const shapes = modeCharts.shapes(run);
  assert.deepEqual(copied(shapes.map((s) => s.title)), ['Shape of mode 1', 'Shape of mode 3']);
  assert.deepEqual(copied(modeCharts.mac({ summary: { data: {} } })), []);
});

test('a chart that is added to the list is a figure of the page', () => {
  const summary = { wheeltap: { case: {} }, models: [{ name: 'm', probability: 1 }], parameters: {}, diagnostics: { acceptance: {} } };
  const run = { summary, draws: { pairs: {} }, unknowns: {}, responses: {} };
  const added = (r) => [{ id: 'count', group: 'results', title: `${r.summary.models.length} model`, spec: () => ({}), table: () => [] }];
  charts.ofResults.push(added);
  try {
    assert.deepEqual(copied(charts.figures(run).filter((f) => f.id === 'count').map((f) => f.title)), ['1 model']);
  } finally {
    charts.ofResults.pop();
  }
});
