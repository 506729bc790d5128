// Opens the report of every run under WHEELTAP_RUNS in headless Chromium. Every chart exists and is not
// empty, in light and dark schemes, at phone and desktop widths. There are no network requests, numbers
// equal those of summary.json, and input appears as text.
const test = require('node:test');
const assert = require('node:assert/strict');
const fs = require('node:fs');
const path = require('node:path');
const { chromium } = require('playwright-core');

const root = process.env.WHEELTAP_RUNS;
const shots = process.env.WHEELTAP_SHOTS;
const runs = fs.readdirSync(root).filter((name) => fs.existsSync(path.join(root, name, 'report.html')));
let browser;
test.before(async () => {
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM || '/usr/bin/chromium', args: ['--no-sandbox'] });
});
test.after(() => browser.close());

async function open(name, width, colorScheme) {
  const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme });
  const page = await context.newPage();
  const complaints = [];
  const requests = [];
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) complaints.push(message.text()); });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('dialog', (dialog) => { complaints.push('dialog: ' + dialog.message()); dialog.dismiss(); });
  page.on('request', (request) => { if (!/^(data|blob):/.test(request.url())) requests.push(request.url()); });
  await page.goto('file://' + path.join(root, name, 'report.html'));
  await page.waitForSelector(".chart svg");
  await page.waitForSelector('html[data-ready]', { timeout: 120000 });
  return { page, context, complaints, requests };
}

assert.ok(runs.length > 0, 'no runs to open');
// Figures of every report of a kind; names of channels and links follow.
const charts = {
  damage: ['model-probabilities', 'where', 'frequency-residuals', 'marginal-', 'model-visits', 'running-probability', 'log-posterior', 'acceptance'],
  sid: ['model-probabilities', 'chain', 'law-', 'force-displacement-', 'force-velocity-', 'restoring-force-', 'response-', 'residual-', 'spectrum-', 'frequency-response-', 'autocorrelation-', 'marginal-', 'model-visits', 'running-probability', 'log-posterior', 'acceptance'],
  sweep: ['sweep-probability'],
};
const compares = ['model-probabilities', 'model-visits', 'running-probability'];
test.describe('reports', { concurrency: 2 }, () => {
for (const name of runs) {
  const { sweep, wheeltap, models } = JSON.parse(fs.readFileSync(path.join(root, name, 'summary.json'), 'utf8'));
  const alone = models?.length === 1; // nothing to compare then
  // Both widths and both schemes everywhere; every combination where names are hostile.
  const looks = [[360, 'dark'], [1400, 'light']];
  if (['hostile', 'three-masses'].includes(name)) looks.push([360, 'light'], [1400, 'dark']);
  for (const [width, scheme] of looks) {
    test(`${name} at ${width} px, ${scheme}`, async () => {
      const { page, context, complaints, requests } = await open(name, width, scheme);
      assert.deepEqual(complaints, []);
      assert.equal(requests.length, 1, 'requests other than the page itself: ' + requests.join(' '));
      const drawn = await page.$$eval('.chart', (places) => places.map((place) => {
        // Axes have no fill and few marks: data are paths, rules and rects of the marks' groups.
        const marks = [...place.querySelectorAll('svg .mark-rect:not(.background) path, svg .mark-symbol path, svg .mark-line path, svg .mark-area path, svg .mark-rule line')]
          .filter((node) => !node.closest('.role-axis, .role-legend') && !/axis|legend/.test(node.parentNode.getAttribute('class')));
        const data = marks.filter((node) => node.tagName === 'line' || (node.getAttribute('d') || '').length > 4);
        return { id: place.id, drawn: data.length, bad: /NaN|undefined|Infinity/.test(place.innerHTML), wide: place.scrollWidth > place.clientWidth + 1 };
      }));
      for (const wanted of charts[sweep ? 'sweep' : wheeltap.command]) {
        if (alone && compares.includes(wanted)) continue;
        assert.ok(drawn.some((chart) => chart.id.startsWith('figure-' + wanted)), `no chart ${wanted}`);
      }
      for (const chart of drawn) {
        assert.ok(chart.drawn > 0, `${chart.id} is empty`);
        assert.ok(!chart.bad, `${chart.id} draws NaN`);
        assert.ok(!chart.wide, `${chart.id} is wider than its place`);
      }
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'the page scrolls sideways');
      if (shots) await page.screenshot({ path: path.join(shots, `${name}-${width}-${scheme}.png`), fullPage: true });
      await context.close();
    });
  }

  if (sweep) test(`${name}: numbers are those of summary.json`, async () => {
    const { page, context } = await open(name, 1000, 'light');
    await page.click('[data-figure=sweep-probability] summary');
    const table = await page.$$eval('[data-figure=sweep-probability] tbody tr', (rows) => rows.map((row) => [...row.children].map((c) => Number(c.dataset.value))));
    assert.deepEqual(table.map((row) => row.slice(1)), sweep.rows.map((r) => r.models.flatMap((m) => [m.probability, m.mcse])));
    await context.close();
  });
  else test(`${name}: numbers are those of summary.json`, async () => {
    const summary = JSON.parse(fs.readFileSync(path.join(root, name, 'summary.json'), 'utf8'));
    const { page, context } = await open(name, 1000, 'light');
    if (!alone) {
      await page.click('[data-figure=model-probabilities] summary');
      const table = await page.$$eval('[data-figure=model-probabilities] tr', (rows) => rows.map((row) => [...row.children].map((c) => c.dataset.value ?? c.textContent)));
      const column = table[0].indexOf('probability');
      assert.deepEqual(table.slice(1).map((row) => row[0]), summary.models.map((m) => m.name));
      assert.deepEqual(table.slice(1).map((row) => Number(row[column])), summary.models.map((m) => m.probability));
    }
    const shown = await page.$$eval('#parameters section.model', (models) => Object.fromEntries(models.map((model) => [model.getAttribute('aria-label'),
      [...model.querySelector('table')?.querySelectorAll('tbody tr') ?? []].map((row) => [...row.children].map((c) => c.dataset.value ?? c.textContent))])));
    for (const [model, parameters] of Object.entries(summary.parameters)) {
      const rows = Object.entries(parameters);
      assert.equal(shown[model].length, rows.length);
      rows.forEach(([parameter, values], i) => {
        const unit = summary.unknowns?.[model]?.find((u) => u.label === parameter)?.unit;
        assert.equal(shown[model][i][0], parameter + (unit && unit !== '1' ? ` [${unit.replace('^2', '²').replace('^3', '³')}]` : ''));
        assert.equal(Number(shown[model][i][1]), values.mean);
        assert.equal(Number(shown[model][i][3]), values['q2.5']);
      });
    }
    const said = await page.textContent('#warnings');
    for (const warning of summary.diagnostics.warnings) assert.ok(said.includes(warning));
    assert.equal(await page.textContent('h1'), summary.title || 'Untitled run');
    assert.ok((await page.textContent('#about')).includes(String(summary.wheeltap.seed)));
    await context.close();
  });

  test(`${name}: opens within 2 s`, async () => {
    // Processor time of the page's thread until all figures exist: independent of the load of the machine.
    const context = await browser.newContext({ viewport: { width: 1400, height: 900 } });
    const page = await context.newPage();
    const session = await context.newCDPSession(page);
    await session.send('Performance.enable', { timeDomain: 'threadTicks' });
    await page.goto('file://' + path.join(root, name, 'report.html'));
    await page.waitForSelector('html[data-ready]', { timeout: 60000 });
    const { metrics } = await session.send('Performance.getMetrics');
    const seconds = metrics.find((m) => m.name === 'TaskDuration').value;
    await context.close();
    assert.ok(seconds > 0 && seconds < 2, `drawing took ${seconds} s of processor time`);
  });

  test(`${name}: below 3 MB, and every control has a name and takes the keyboard`, async () => {
    assert.ok(fs.statSync(path.join(root, name, 'report.html')).size < 3e6);
    const { page, context } = await open(name, 1000, 'light');
    const unnamed = await page.$$eval('button, summary, a[href]', (nodes) => nodes.filter((n) => !(n.textContent.trim() || n.getAttribute('aria-label')) || n.tabIndex < 0).length);
    assert.equal(unnamed, 0);
    await page.emulateMedia({ media: 'print' });
    assert.ok((await page.pdf()).length > 10000);
    await context.close();
  });
}

});

test('hostile names are text', { skip: !runs.includes('hostile') }, async () => {
  const { page, context, complaints } = await open('hostile', 360, 'light');
  assert.deepEqual(complaints, []);
  assert.match(await page.textContent('h1'), /<script>.*<\/script>/);
  assert.match(await page.textContent('#about'), /<script>window.hacked = 2<!-- "quotes" 'ticks' ضرر 🏗️ x{120}/u);
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  assert.equal(await page.$$eval('main img, h1 *', (nodes) => nodes.length), 0);
  await context.close();
});
