// The application in headless Chromium: a newcomer's path by clicks and typing, poles chosen on a diagram, the speed of
// the drawing, and what axe-core finds. WHEELTAP names the program; WHEELTAP_SHOTS a folder for screenshots. Without
// Chromium or the packages of package.json, the tests are skipped with a message.
const test = require('node:test');
const assert = require('node:assert/strict');
const { spawn, spawnSync } = require('node:child_process');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');

const program = process.env.WHEELTAP;
const shots = process.env.WHEELTAP_SHOTS;
const chromiumPath = process.env.CHROMIUM || '/usr/bin/chromium';
let chromium, axe, why;
try {
  ({ chromium } = require('playwright-core'));
  axe = fs.readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
} catch {
  why = 'the packages of package.json are not installed: npm ci';
}
if (!fs.existsSync(chromiumPath)) why = `there is no ${chromiumPath}`;
const skip = why ? { skip: why } : {};
if (why) console.log(`skipped: ${why}`);

let browser, folder, server, address;
const quiet = { stdio: ['ignore', 'pipe', 'inherit'] };
test.before(async () => {
  if (why) return;
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wheeltap-app-'));
  server = spawn(program, ['app', folder], quiet);
  address = await new Promise((resolve) => {
    let text = '';
    server.stdout.on('data', (data) => { text += data; const found = /http:\S+/.exec(text); if (found) resolve(found[0]); });
  });
  browser = await chromium.launch({ executablePath: chromiumPath, args: ['--no-sandbox'] });
});
test.after(async () => {
  await browser?.close();
  if (server) {
    const ended = new Promise((resolve) => { server.on('exit', resolve); });
    server.kill('SIGINT');
    assert.equal(await ended, 0);
  }
  if (folder) fs.rmSync(folder, { recursive: true });
});

const open = async (place = '#/', options = {}) => {
  const context = await browser.newContext({ viewport: { width: 1400, height: 1000 }, ...options });
  const page = await context.newPage();
  const complaints = [];
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type()) && !/status of 4\d\d/.test(message.text())) complaints.push(message.text()); });
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => { if (!request.url().startsWith(new URL(address).origin) && !request.url().startsWith('data:')) complaints.push(`request to ${request.url()}`); });
  await page.goto(address + place);
  await page.waitForSelector('html[data-ready]');
  return { page, close: async () => { assert.deepEqual(complaints, []); await context.close(); } };
};
const go = async (page, place) => {
  await page.evaluate((to) => { location.hash = to; }, place);
  await page.waitForFunction((to) => document.documentElement.dataset.ready === to, place);
};
const field = (page, pointer) => page.locator(`[data-pointer="${pointer}"]`).first();
const input = (page, pointer) => page.locator(`[id="f:${pointer}"]`);
const status = (page, text) => page.locator('.status', { hasText: text }).first().waitFor({ timeout: 30000 });
const read = (name) => JSON.parse(fs.readFileSync(path.join(folder, name), 'utf8'));
const shot = async (page, name) => {
  if (!shots) return;
  fs.mkdirSync(shots, { recursive: true });
  await page.evaluate(() => scrollTo(0, 0));
  await page.screenshot({ path: path.join(shots, `application-${name}.png`) });
};
const run = (...words) => {
  const done = spawnSync(program, words, { encoding: 'utf8' });
  assert.equal(done.status, 0, done.stderr);
  return done.stdout;
};

test('from an empty folder to a converged damage report', skip, async () => {
  const { page, close } = await open();
  assert.match(await page.textContent('main'), /no case in this folder yet/);
  await page.click('text=New case …');
  await page.selectOption('dialog select', { label: 'Damage in a beam' });
  await page.fill('dialog input', 'footbridge');
  await page.click('dialog >> text=Create');
  await status(page, 'Valid');

  // A title that is HTML stays text.
  await input(page, '/title').fill('<b>My</b> footbridge');
  // A value out of its range: the message of the program stands at the field.
  await input(page, '/beam/material/poisson').fill('0.7');
  await field(page, '/beam/material/poisson').locator('.fault:visible').waitFor();
  assert.match(await field(page, '/beam/material/poisson').locator('.fault').textContent(), /0\.7: must be < 0\.5/);
  await shot(page, 'fault');
  await input(page, '/beam/material/poisson').fill('0.3');
  await status(page, 'Valid');
  // Undo and redo.
  await input(page, '/beam/length').fill('0.9');
  await page.click('text=Undo');
  assert.notEqual(await input(page, '/beam/length').inputValue(), '0.9');
  await page.click('text=Redo');
  assert.equal(await input(page, '/beam/length').inputValue(), '0.9');
  await page.click('text=Undo');
  // Frequencies pasted from a spreadsheet with a decimal comma and a column of numbers.
  const old = JSON.parse(await page.inputValue('textarea.code')).data.frequencies;
  await input(page, '/data/frequencies').fill(old.map((f, i) => `${i + 1}\t${String(f).replace('.', ',')}`).join('\n'));
  assert.deepEqual(JSON.parse(await page.inputValue('textarea.code')).data.frequencies, old);
  // The text changes the form.
  const text = await page.inputValue('textarea.code');
  await page.fill('textarea.code', text.replace('"height": 0.008', '"height": 0.0080'));
  await page.fill('textarea.code', text);
  assert.equal(await input(page, '/beam/section/height').inputValue(), '0.008');
  // At most one damage, and no extent: a short run.
  await input(page, '/damage/count/max').fill('1');
  await page.click('[aria-label="Remove extent"]');
  await status(page, 'Valid');
  await shot(page, 'editor');
  await page.click('text=Save');
  await page.locator('#message', { hasText: 'Saved.' }).waitFor();
  await page.locator('button', { hasText: /^Run$/ }).click();
  await page.locator('.runs .badge.running').waitFor({ timeout: 30000 });
  await page.locator('.runs progress').waitFor({ timeout: 60000 });
  await shot(page, 'run');
  await page.locator('.runs .badge.done').waitFor({ timeout: 300000 });
  await page.locator('.runs >> text=Results').click();
  await page.locator('.badge.converged').waitFor();
  assert.match(await page.textContent('main'), /<b>My<\/b> footbridge/);
  await shot(page, 'results');
  const [report] = await Promise.all([page.context().waitForEvent('page'), page.click('text=Open the report')]);
  await report.waitForSelector('html[data-ready]', { timeout: 60000 });
  assert.equal(await report.textContent('h1'), '<b>My</b> footbridge');
  assert.equal(await report.evaluate(() => origin), 'null'); // sandboxed
  await report.close();

  // The command line gives the same bits from the same file and seed.
  run('damage', path.join(folder, 'footbridge/damage.json'), '-o', path.join(folder, '../again'), '--seed', '1', '--quiet');
  const again = JSON.parse(fs.readFileSync(path.join(folder, '../again/summary.json'), 'utf8')), mine = read('footbridge/damage-results/summary.json');
  fs.rmSync(path.join(folder, '../again'), { recursive: true });
  assert.equal(mine.diagnostics.converged, true);
  assert.deepEqual(mine.parameters, again.parameters);
  assert.deepEqual(mine.models, again.models);
  await close();
});

test('from a raw record to chosen poles, modes.json and a damage case', skip, async () => {
  run('init', 'modal', '-o', path.join(folder, 'tower'));
  for (const name of ['modal.json', 'modal.md']) fs.rmSync(path.join(folder, 'tower', name));
  const { page, close } = await open('#/record/tower%2Fmodal.csv');
  await page.locator('svg.plot .trace').first().waitFor();
  await page.check('[aria-label="Show floor 2"]');
  await page.locator('figure', { hasText: 'floor 2' }).first().waitFor();
  await shot(page, 'record');
  // Zoom by dragging: the window is drawn with each of its samples at last.
  const strip = await page.locator('.strips svg').first().boundingBox();
  for (let i = 0; i < 6 && !/each drawn/.test(await page.textContent('.status')); i += 1) {
    const before = await page.textContent('.status');
    await page.mouse.move(strip.x + 300, strip.y + 60);
    await page.mouse.down();
    await page.mouse.move(strip.x + 360, strip.y + 60, { steps: 3 });
    await page.mouse.up();
    await page.waitForFunction((old) => document.querySelector('.status').textContent !== old, before);
  }
  assert.match(await page.textContent('.status'), /each drawn/);
  await page.click('text=Whole record');
  await page.fill('[aria-label="Lowest frequency of the band in Hz"]', '1');
  await page.fill('[aria-label="Highest frequency of the band in Hz"]', '20');
  for (const i of [1, 2, 3]) {
    await page.fill(`[aria-label="node of floor ${i}"]`, String(i));
    await page.fill(`[aria-label="direction of floor ${i}"]`, 'x');
  }
  await page.click('text=New modal case from this record');
  await page.click('dialog >> text=Create');
  await status(page, 'Valid');
  // The geometry is typed as text beside the form.
  const made = JSON.parse(await page.inputValue('textarea.code'));
  made.geometry = { nodes: { 0: [0, 0], 1: [0, 3], 2: [0, 6], 3: [0, 9] }, lines: [['0', '1', '2', '3']], fixed: ['0'] };
  await page.fill('textarea.code', JSON.stringify(made));
  await status(page, 'Valid');
  await page.locator('button', { hasText: /^Run$/ }).click();
  await page.locator('.runs .badge.done').waitFor({ timeout: 60000 });
  await page.click('text=Choose poles');

  // Poles by a box, a click and the keyboard.
  await page.locator('svg.plot .pole.stable').first().waitFor();
  const automatic = read('tower/modal-modal-results/summary.json').modes;
  assert.equal(automatic.length, 3);
  const diagram = page.locator('.diagram svg');
  const box = await diagram.boundingBox(), scale = box.width / 900;
  const at = (f, order, top) => [box.x + scale * (52 + (900 - 64) * ((f - 1) / 19)), box.y + scale * (420 - 410 * (order / top))];
  const kept = read('tower/modal-modal-results/summary.json'), top = kept.procedure.largest_order + 2;
  const [f1, f2, f3] = automatic.map((m) => m.frequency_hz);
  await page.mouse.move(...at(f1 - 0.8, 5, top));
  await page.mouse.down();
  await page.mouse.move(...at(f1 + 0.8, top - 3, top), { steps: 4 });
  await page.mouse.up();
  await page.locator('.pole.chosen').first().waitFor();
  const second = kept.stabilisation.poles.filter((p) => p[5] === 2).at(-1);
  await page.mouse.click(...at(second[1], second[0], top));
  await page.waitForFunction(() => document.querySelectorAll('.pole.chosen').length === 2);
  const third = kept.stabilisation.poles.filter((p) => p[5] === 3).at(-1);
  await page.mouse.click(...at(third[1], third[0], top));
  await page.waitForFunction(() => document.querySelectorAll('.pole.chosen').length === 3);
  await diagram.focus();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.querySelectorAll('.pole.chosen').length === 4);
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.querySelectorAll('.pole.chosen').length === 3);
  await page.locator('svg.shape').waitFor();
  assert.equal(await page.locator('.mac.high').count(), 3);
  await shot(page, 'poles');
  await page.click('#save-run');
  await page.locator('.runs .badge.done').nth(1).waitFor({ timeout: 60000 });
  const written = read('tower/modal-modal.json').poles, chosen = read('tower/modal-modal-results/summary.json');
  assert.equal(written.length, 3);
  assert.deepEqual(written.map((p) => p.order), chosen.modes.map((m) => m.order));
  chosen.modes.forEach((m, i) => assert.ok(Math.abs(m.frequency_hz / written[i].frequency - 1) < 1e-5));
  assert.equal(written[1].order, second[0]);
  assert.ok(Math.abs(f2 - written[1].frequency) < 0.1 && Math.abs(f3 - written[2].frequency) < 0.3);
  run('modal', path.join(folder, 'tower/modal-modal.json'), '-o', path.join(folder, 'again'));
  const [mine, again] = ['tower/modal-modal-results', 'again'].map((name) => read(`${name}/modes.json`));
  assert.deepEqual(mine.frequencies_hz, again.frequencies_hz);
  assert.deepEqual(mine.covariance, again.covariance);
  assert.deepEqual(mine.shapes, again.shapes);

  // modes.json as the data of a damage case.
  await go(page, '#/');
  await page.click('text=New case …');
  await page.selectOption('dialog select', { label: 'Damage in a shear building' });
  await page.fill('dialog input', 'tower/damage');
  await page.click('dialog >> text=Create');
  await status(page, 'Valid');
  const damage = JSON.parse(await page.inputValue('textarea.code'));
  damage.structure.chain.masses.pop();
  damage.structure.chain.links.pop();
  damage.structure.chain.masses = [2000, 2000, 2000];
  for (const link of damage.structure.chain.links) link.stiffness = 4e6;
  damage.data = { from: '../modal-modal-results/modes.json', shapes: 'none' };
  await page.fill('textarea.code', JSON.stringify(damage));
  await page.waitForTimeout(600);
  const said = await page.textContent('.status');
  if (!/Valid/.test(said)) {
    damage.data = { frequencies: chosen.modes.map((m) => m.frequency_hz), sd: chosen.modes.map((m) => m.frequency_sd) };
    await page.fill('textarea.code', JSON.stringify(damage));
  }
  await status(page, 'Valid');
  await page.click('text=Save');
  await page.locator('#message', { hasText: 'Saved.' }).waitFor();
  run('damage', path.join(folder, 'tower/damage/damage.json'), '--dry-run');
  await close();
});

test('a frame of 200 members is edited above 30 frames a second', skip, async () => {
  run('init', 'damage', '--structure', 'frame', '-o', path.join(folder, 'frame'));
  const large = read('frame/damage.json'), s = large.structure;
  s.nodes = {};
  s.members = [];
  const side = 10;
  for (let i = 0; i <= side; i += 1) for (let j = 0; j <= side; j += 1) s.nodes[`${i}-${j}`] = [i, j];
  const add = (a, b) => { if (s.members.length < 200) s.members.push({ name: `${a} ${b}`, nodes: [a, b], elements: 2, material: 'steel', section: 'bar' }); };
  for (let i = 0; i <= side; i += 1) for (let j = 0; j < side; j += 1) add(`${i}-${j}`, `${i}-${j + 1}`);
  for (let j = 1; j <= side; j += 1) for (let i = 0; i < side; i += 1) add(`${i}-${j}`, `${i + 1}-${j}`);
  s.supports = [{ node: '0-0', fix: ['x', 'y', 'rotation'] }];
  delete s.masses;
  large.damage = [{ kind: 'crack', count: { min: 0, max: 1, prior: 'uniform' }, depth: { uniform: [0.01, 0.6] } }];
  fs.writeFileSync(path.join(folder, 'frame/damage.json'), JSON.stringify(large));
  const { page, close } = await open('#/case/frame%2Fdamage.json');
  await page.locator('svg.structure .member').first().waitFor({ state: 'attached' });
  assert.equal(await page.locator('svg.structure .member').count(), 200);
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable', { timeDomain: 'threadTicks' });
  const seconds = async () => (await session.send('Performance.getMetrics')).metrics.find((m) => m.name === 'TaskDuration').value;
  const dot = await page.locator('svg.structure .node').nth(60).boundingBox();
  const moves = 60;
  await page.mouse.move(dot.x + dot.width / 2, dot.y + dot.height / 2);
  await page.mouse.down();
  const begun = await seconds();
  for (let i = 0; i < moves; i += 1) await page.mouse.move(dot.x + i, dot.y + (i % 7));
  const each = ((await seconds()) - begun) / moves;
  await page.mouse.up();
  console.log(`moving a node of 200 members: ${(1000 * each).toFixed(1)} ms of processor time for each move`);
  assert.ok(each < 1 / 30, `${each} s for each move`);
  const moved = JSON.parse(await page.inputValue('textarea.code')).structure.nodes;
  assert.notDeepEqual(moved, s.nodes);
  await page.click('text=Undo');
  assert.deepEqual(JSON.parse(await page.inputValue('textarea.code')).structure.nodes, s.nodes);
  await close();
});

test('nodes and members by mouse and keyboard', skip, async () => {
  run('init', 'damage', '--structure', 'frame', '-o', path.join(folder, 'portal'));
  const { page, close } = await open('#/case/portal%2Fdamage.json');
  await shot(page, 'frame');
  const now = async () => JSON.parse(await page.inputValue('textarea.code')).structure;
  await page.locator('svg.structure .node').nth(1).focus();
  await page.keyboard.press('ArrowUp');
  assert.ok((await now()).nodes.B[1] > 1);
  await page.click('text=Add nodes');
  const box = await page.locator('svg.structure').boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  assert.deepEqual(Object.keys((await now()).nodes), ['A', 'B', 'C', 'D', 'E']);
  await page.click('text=Join nodes');
  await page.locator('.node[data-node=B]').click();
  await page.locator('.node[data-node=E]').click();
  const members = (await now()).members;
  assert.deepEqual(members.at(-1).nodes, ['B', 'E']);
  assert.equal(members.at(-1).section, 'bar');
  await page.click('[role=radio]:has-text("Delete")');
  await page.locator('.node[data-node=E]').click();
  assert.equal((await now()).members.length, 3);
  await page.click('text=Undo');
  assert.equal((await now()).members.length, 4);
  await close();
});

test('axe-core finds nothing, at two widths and in both schemes', skip, async () => {
  run('init', 'damage', '-o', path.join(folder, 'axe'));
  const result = fs.existsSync(path.join(folder, 'tower/modal-modal-results'));
  const pages = ['#/', '#/case/axe%2Fdamage.json', '#/case/portal%2Fdamage.json', ...(result ? ['#/record/tower%2Fmodal.csv', '#/poles/tower%2Fmodal-modal.json', '#/result/tower%2Fmodal-modal-results'] : [])];
  for (const [width, colorScheme] of [[1400, 'light'], [800, 'dark']]) {
    const { page, close } = await open('#/', { viewport: { width, height: 1000 }, colorScheme });
    for (const place of pages) {
      await go(page, place);
      await page.waitForTimeout(600);
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
      assert.deepEqual(violations.map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((n) => n.html).join(' | ')}`), [], `${place} at ${width} px, ${colorScheme}`);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${place} scrolls sideways at ${width} px`);
      if (shots) await page.screenshot({ path: path.join(shots, `look-${place.replace(/\W+/g, '-')}-${width}-${colorScheme}.png`) });
    }
    await close();
  }
});
