// What becomes of each channel of a record, in headless Chromium: role, place, direction and sign, set in the list and on
// the drawn structure of modal and damage cases. application_kit.js names the environment.
const test = require('node:test');
const assert = require('node:assert/strict');
const fs = require('node:fs');
const { application, skip, axe, shots } = require('./application_kit.js');
const path = require('node:path');

const { at, open, go, status, read, shot, run } = application(test);
const write = (name, json) => { fs.mkdirSync(path.dirname(at(name)), { recursive: true }); fs.writeFileSync(at(name), JSON.stringify(json)); };
const node = (page, name) => page.locator(`.channels .node[data-node="${name}"]`);
const arrows = (page) => page.locator('.channels svg.structure .sensor');
const field = (page, what, channel) => page.locator(`[aria-label="${what} of ${channel}"]`);
const save = async (page) => {
  await page.locator('.channels button', { hasText: /^Save$/ }).click();
  await page.locator('#message', { hasText: 'Saved.' }).waitFor();
};
const ready = async (page, valid = 'Valid') => { await page.locator('.channels .status', { hasText: valid }).waitFor({ timeout: 30000 }); };
const select = (page, channel) => page.click(`.channels td [aria-label$=": select ${channel}"]`);

test('a new modal case: nodes of a drawn line by mouse and keyboard', skip, async () => {
  run('init', 'modal', '-o', at('tower'));
  fs.renameSync(at('tower/modal.json'), at('starter.json'));
  const { page, close } = await open('#/record/tower%2Fmodal.csv');
  await page.locator('text=Channels without a position (3)').waitFor();
  assert.equal(await page.locator('.channels svg.structure').count(), 0);
  await page.selectOption('[aria-label="Structure to draw"]', 'line');
  await page.click('dialog >> text=Draw');
  await node(page, '3').waitFor();
  // By mouse; the direction is x until another one is chosen.
  await node(page, '1').click();
  await page.locator('text=Channels without a position (2)').waitFor();
  assert.equal(await field(page, 'node', 'floor 1').inputValue(), '1');
  assert.equal(await field(page, 'direction', 'floor 1').inputValue(), 'x');
  // By keyboard only: the next channel, the node above, its sign.
  await page.locator('.chooser button', { hasText: 'Next without a position: floor 2' }).focus();
  await page.keyboard.press('Enter');
  await page.locator('.channels svg.structure .place[tabindex="0"]').focus();
  await page.keyboard.press('ArrowUp');
  await page.keyboard.press('Enter');
  await page.locator('text=Channels without a position (1)').waitFor();
  const placed = await field(page, 'node', 'floor 2').inputValue();
  assert.equal(placed, await page.evaluate(() => document.activeElement.dataset.node)); // the focus stays on the node
  await field(page, 'node', 'floor 2').fill('2');
  await page.locator('.chooser [data-direction="-x"]').focus();
  await page.keyboard.press(' ');
  assert.equal(await field(page, 'direction', 'floor 2').inputValue(), '-x');
  // By typing.
  await field(page, 'node', 'floor 3').fill('3');
  await field(page, 'direction', 'floor 3').selectOption('x');
  await page.locator('text=Every sensor and force has a position').waitFor();
  assert.equal(await arrows(page).count(), 3);
  await ready(page);
  // A column that is no sensor has no place; undo gives the place back.
  await page.selectOption('[aria-label="Role of floor 3"]', 'ignore');
  assert.equal(await arrows(page).count(), 2);
  assert.equal(await field(page, 'node', 'floor 3').count(), 0);
  await page.click('.channels >> text=Undo');
  assert.equal(await field(page, 'node', 'floor 3').inputValue(), '3');
  // A force needs another method: the message stands at the role.
  await page.selectOption('[aria-label="Role of floor 3"]', 'force');
  await page.locator('.channels td .fault:visible', { hasText: 'this method uses responses only' }).waitFor();
  assert.equal(await page.getAttribute('[aria-label="Role of floor 3"]', 'aria-invalid'), 'true');
  assert.equal(await page.locator('.channels .sensor.force').count(), 1);
  await page.keyboard.press('Control+z');
  await ready(page);
  await page.locator('section.channels').scrollIntoViewIfNeeded();
  await page.fill('[aria-label="Lowest frequency of the band in Hz"]', '1');
  await page.fill('[aria-label="Highest frequency of the band in Hz"]', '20');
  await page.click('text=New modal case from this record');
  await page.click('dialog >> text=Create');
  await page.locator('textarea.code').waitFor();
  await status(page, 'Valid');
  const made = read('tower/modal-modal.json');
  assert.deepEqual(made.record.channels, [1, 2, 3].map((i) => ({ column: `floor ${i}`, role: 'response', node: String(i), direction: i === 2 ? '-x' : 'x' })));
  assert.deepEqual(made.geometry, { nodes: { 0: [0, 0], 1: [0, 3], 2: [0, 6], 3: [0, 9] }, lines: [['0', '1', '2', '3']], fixed: ['0'] });
  assert.deepEqual(made.band, [1, 20]);
  // The drawing of the editor has the same arrows.
  assert.equal(await page.locator('svg.structure .sensor').count(), 3);
  run('modal', at('tower/modal-modal.json'), '-o', at('tower/modal-modal-results'));
  const { sensors } = read('tower/modal-modal-results/modes.json');
  assert.deepEqual(sensors.map((one) => one.direction), ['x', '-x', 'x']);
  await close();
});

test('the data viewer shows and changes the case that uses a record', skip, async () => {
  const { page, close } = await open('#/record/tower%2Fmodal.csv');
  await ready(page);
  assert.equal(await page.inputValue('[aria-label="Case"]'), 'tower/modal-modal.json');
  assert.equal(await arrows(page).count(), 3);
  const before = fs.readFileSync(at('tower/modal-modal.json'), 'utf8');
  // A node that does not exist: the message of the program stands at the field.
  await field(page, 'node', 'floor 2').fill('9');
  await page.locator('.channels td .fault:visible', { hasText: 'is not a node of the geometry' }).waitFor();
  const invalid = page.locator('.channels [aria-invalid]');
  assert.equal(await invalid.getAttribute('aria-label'), 'node of floor 2');
  assert.equal(await page.locator(`#${await invalid.getAttribute('aria-describedby')}`).textContent(), await page.locator('.channels td .fault:visible').textContent());
  assert.equal(await arrows(page).count(), 2);
  // Keys of one field are one step of undo.
  await field(page, 'node', 'floor 2').press('End');
  await page.keyboard.type('87');
  await page.click('.channels >> text=Undo');
  assert.equal(await field(page, 'node', 'floor 2').inputValue(), '2');
  await ready(page);
  await page.click('.channels >> text=Redo');
  assert.equal(await field(page, 'node', 'floor 2').inputValue(), '987');
  await page.click('.channels >> text=Undo');
  assert.equal(fs.readFileSync(at('tower/modal-modal.json'), 'utf8'), before); // not saved yet
  // Angles and their reverse.
  await select(page, 'floor 2');
  await page.click('.chooser [data-direction=angles]');
  assert.equal(await field(page, 'azimuth', 'floor 2').count(), 0); // the label names degrees
  assert.equal(await page.inputValue('[aria-label="azimuth of floor 2 in degrees"]'), '180');
  await page.fill('[aria-label="elevation of floor 2 in degrees"]', '10');
  await page.click('.chooser >> text=Reverse');
  await page.locator('.channels tr', { hasText: 'floor 1' }).locator('input[type=checkbox]').check();
  await ready(page);
  // Leaving asks, then keeps the page.
  page.once('dialog', (dialog) => dialog.dismiss());
  await page.evaluate(() => { location.hash = '#/'; });
  await page.waitForFunction(() => location.hash.includes('record'));
  await save(page);
  const { channels } = read('tower/modal-modal.json').record;
  assert.deepEqual(channels[1], { column: 'floor 2', role: 'response', node: '2', azimuth: 0, elevation: -10 });
  assert.equal(channels[0].reference, true);
  run('modal', at('tower/modal-modal.json'), '-o', at('again'), '--dry-run');
  // A case that changed on the disk is not replaced.
  fs.writeFileSync(at('tower/modal-modal.json'), before);
  await select(page, 'floor 3');
  await page.click('.chooser >> text=Reverse');
  await page.locator('.channels button', { hasText: /^Save$/ }).click();
  await page.locator('#message.bad', { hasText: 'has changed on the disk' }).waitFor();
  assert.equal(fs.readFileSync(at('tower/modal-modal.json'), 'utf8'), before);
  await page.click('.channels >> text=Undo');
  // The window and the band of the view, in the case.
  await page.fill('[aria-label="Highest frequency of the band in Hz"]', '15');
  await page.locator('[aria-label="Highest frequency of the band in Hz"]').blur();
  await page.click('text=Use this window and band in the case');
  await ready(page);
  await page.click('.channels >> text=Undo'); // leaves without a question
  await close();
});

test('the sensors of a damage case: a beam, a building and a frame', skip, async () => {
  const from = '../tower/modal-modal-results/modes.json';
  for (const [folder, structure] of [['beam', 'beam'], ['building', 'building'], ['portal', 'frame']]) run('init', 'damage', '--structure', structure, '-o', at(folder));
  const beam = read('beam/damage.json');
  beam.data = { from, sensors: [null, null, null] };
  write('beam/damage.json', beam);
  const { page, close } = await open('#/case/beam%2Fdamage.json');
  await page.click('text=Channels on the structure');
  await page.locator('.channels svg.structure .body').waitFor();
  assert.deepEqual(await page.locator('.channels tbody th').allTextContents(), ['floor 1', 'floor 2', 'floor 3']); // of modes.json
  // A click on the beam gives the selected channel its position, rounded; typing gives any position.
  const body = await page.locator('.channels svg.structure .body').boundingBox();
  await select(page, 'floor 2');
  await page.mouse.click(body.x + body.width / 2, body.y + body.height / 2);
  assert.equal(await field(page, 'position', 'floor 2').inputValue(), String(beam.beam.length / 2));
  await page.selectOption('[aria-label="Role of floor 3"]', 'response');
  await field(page, 'position', 'floor 3').fill('7');
  await page.locator('.channels td .fault:visible').waitFor();
  assert.equal(await page.getAttribute('[aria-label="position of floor 3"]', 'aria-invalid'), 'true');
  await field(page, 'position', 'floor 3').fill('0,7');
  await ready(page);
  await save(page);
  assert.deepEqual(read('beam/damage.json').data, { from, sensors: [null, { at: beam.beam.length / 2 }, { at: 0.7 }] });

  // A building: the masses of modes.json until one is changed; the sign of a mass is in its name.
  const building = read('building/damage.json');
  building.data = { from };
  building.structure.chain.masses = [2000, 2000, 2000];
  building.structure.chain.links = [1, 2, 3].map((i) => ({ name: `storey ${i}`, between: [i - 1, i], stiffness: 4e6 }));
  write('building/damage.json', building);
  await go(page, '#/channels/building%2Fdamage.json');
  await ready(page);
  assert.equal(await arrows(page).count(), 3);
  assert.match(await page.textContent('.chooser'), /from modes\.json/);
  await select(page, 'floor 3');
  await page.click('.chooser >> text=Reverse');
  await ready(page);
  await page.selectOption('[aria-label="Role of floor 1"]', 'ignore');
  await ready(page);
  await save(page);
  assert.deepEqual(read('building/damage.json').data.sensors, [null, { node: 'mass 2', direction: '-x' }, { node: 'mass 3', direction: '-x' }]);
  run('damage', at('building/damage.json'), '-o', at('building/none'), '--dry-run');

  // A frame: nodes and positions on members.
  const portal = read('portal/damage.json');
  Object.assign(portal.data, { shapes: portal.data.frequencies.map(() => [1, 0.5]), shape_sd: 0.02, sensors: [{ node: 'B', direction: 'x' }, { node: 'C', direction: 'x' }] });
  write('portal/damage.json', portal);
  await go(page, '#/channels/portal%2Fdamage.json');
  await ready(page);
  await select(page, 'sensor 2');
  const { members } = portal.structure, top = members.findIndex((one) => one.nodes.includes('B') && one.nodes.includes('C'));
  const line = await page.locator(`.channels .member[data-member="${top}"]`).boundingBox();
  await page.mouse.click(line.x + line.width / 4, line.y + line.height / 2);
  assert.equal(await field(page, 'node', 'sensor 2').inputValue(), members[top].name);
  await page.click('.chooser [data-direction="-y"]');
  await page.fill('[aria-label="distance of sensor 2 from the first node of the member in m"]', '0,3');
  await ready(page);
  assert.equal(await arrows(page).count(), 2);
  await field(page, 'node', 'sensor 1').fill(members[0].name); // a member, by its name
  await field(page, 'node', 'sensor 1').blur();
  await page.fill('[aria-label="distance of sensor 1 from the first node of the member in m"]', '9');
  await page.locator('.channels td .fault:visible', { hasText: 'is outside the member' }).waitFor();
  await page.click('.channels >> text=Undo');
  await page.click('.channels >> text=Undo');
  await ready(page);
  await save(page);
  assert.deepEqual(read('portal/damage.json').data.sensors, [{ node: 'B', direction: 'x' }, { direction: '-y', member: members[top].name, at: 0.3 }]);
  run('damage', at('portal/damage.json'), '-o', at('portal/none'), '--dry-run');
  await close();
});

test('set-ups on the structure of another case, in space, with names that are HTML', skip, async () => {
  const hostile = '<img src=x onerror=alert(1)>';
  const rows = Array.from({ length: 4000 }, (ignored, i) => [1, 2, 3].map((c) => (Math.sin(0.3 * c * i) + ((i * 7919 + c * 104729) % 1009) / 1009).toFixed(4)).join(','));
  for (const name of ['one', 'two']) {
    fs.mkdirSync(at('space'), { recursive: true });
    fs.writeFileSync(at(`space/${name}.csv`), `"${hostile} [m/s^2]",b [m/s^2],c [m/s^2]\n${rows.join('\n')}\n`);
  }
  write('space/frame.json', { kind: 'damage', title: 'x', structure: { dimension: 3, materials: { s: { young: 2e11, poisson: 0.3, density: 7850 } }, sections: { p: { shape: 'rectangle', width: 0.05, height: 0.02 } },
    nodes: { 1: [0, 0, 0], 2: [0, 0, 2], [hostile]: [1, 0, 2] }, members: [{ name: 'post', nodes: ['1', '2'], elements: 2, material: 's', section: 'p' }, { name: 'arm', nodes: ['2', hostile], elements: 2, material: 's', section: 'p' }],
    supports: [{ node: '1', fix: ['x', 'y', 'z', 'rx', 'ry', 'rz'] }] }, data: { frequencies: [3], cov: 0.01 }, damage: { kind: 'crack', count: { min: 0, max: 1, prior: 'uniform' }, depth: { uniform: [0.01, 0.6] } } });
  const channels = [{ column: 1, role: 'response', node: '2', direction: 'x', reference: true }, { column: 'b', role: 'response' }];
  write('space/set-ups.json', { kind: 'modal', records: ['one', 'two'].map((name) => ({ file: `${name}.csv`, sample_rate: 50, channels: structuredClone(channels) })), geometry: 'frame.json' });
  const { page, close } = await open('#/channels/space%2Fset-ups.json');
  await node(page, '2').waitFor();
  assert.equal(await page.locator('.channels tbody th').first().textContent(), `${hostile} [m/s^2]`); // column 1, by its name
  assert.equal(await page.locator('img').count(), 0);
  await page.locator('text=Columns of the file that the case does not use (1)').waitFor();
  // Turning the drawing by mouse picks no node.
  const where = () => node(page, hostile).getAttribute('cx'), seen = await where(), drawing = await page.locator('.channels svg.structure').boundingBox();
  await page.mouse.move(drawing.x + 200, drawing.y + 150);
  await page.mouse.down();
  await page.mouse.move(drawing.x + 260, drawing.y + 160, { steps: 6 });
  await page.mouse.up();
  assert.notEqual(await where(), seen);
  assert.equal(await page.locator('.channels button', { hasText: /^Undo$/ }).isDisabled(), true);
  // The second set-up: channel b, then the unused column c, which becomes a channel.
  await page.selectOption('.channels .buttons select', { index: 1 });
  await page.waitForFunction(() => !document.querySelector('.channels').inert);
  await select(page, 'b');
  await node(page, hostile).click();
  await select(page, 'c');
  await node(page, '2').click();
  assert.equal(await field(page, 'direction', 'c').inputValue(), 'y'); // x is taken at this node
  await page.click('.chooser [data-direction="-z"]');
  assert.equal(await arrows(page).count(), 3);
  await save(page);
  const made = read('space/set-ups.json');
  assert.deepEqual(made.records[0].channels, channels);
  assert.deepEqual(made.records[1].channels, [channels[0], { column: 'b', role: 'response', node: hostile, direction: 'x' }, { column: 'c', role: 'response', node: '2', direction: '-z' }]);
  assert.equal(made.geometry, 'frame.json');
  // The record does not state its sampling rate: the viewer takes it from the case, or as it is typed.
  await go(page, '#/record/space%2Ftwo.csv');
  await page.locator('figure', { hasText: 'Spectrum of' }).waitFor();
  assert.equal(await page.inputValue('[aria-label="Sampling rate in Hz"]'), '50');
  assert.equal(await page.locator('.channels .buttons select').evaluate((one) => one.selectedIndex), 1); // the set-up of this record
  await page.fill('[aria-label="Sampling rate in Hz"]', '');
  await page.locator('[aria-label="Sampling rate in Hz"]').blur();
  await page.locator('text=the file does not state its sampling rate').waitFor();
  await page.fill('[aria-label="Sampling rate in Hz"]', '100');
  await page.locator('[aria-label="Sampling rate in Hz"]').blur();
  await page.locator('figure', { hasText: 'Spectrum of' }).locator('text', { hasText: /^50$/ }).waitFor();
  // A modes.json that is not there: the message stays, and the list shows what the case states.
  write('space/gone.json', { ...read('beam/damage.json'), data: { from: 'none/modes.json', sensors: [{ at: 0.2 }] } });
  await go(page, '#/channels/space%2Fgone.json');
  await page.locator('#message.bad', { hasText: 'modes.json' }).waitFor();
  assert.equal(await arrows(page).count(), 1);
  await close();
});

test('angles of a modes.json stay in the modal case, and malformed cases break nothing', skip, async () => {
  fs.cpSync(at('tower/modal-modal-results'), at('turned-results'), { recursive: true });
  const modes = read('turned-results/modes.json');
  Object.assign(modes.sensors[1], { azimuth: 30, elevation: 0 });
  delete modes.sensors[1].direction;
  write('turned-results/modes.json', modes);
  const portal = read('portal/damage.json');
  portal.structure.nodes = { 1: [0, 0], 2: [0, 1], 3: [1, 1], 4: [1, 0] };
  portal.structure = JSON.parse(JSON.stringify(portal.structure).replaceAll('"A"', '"1"').replaceAll('"B"', '"2"').replaceAll('"C"', '"3"').replaceAll('"D"', '"4"'));
  portal.data = { from: 'turned-results/modes.json' };
  write('turned.json', portal);
  const { page, close } = await open('#/channels/turned.json');
  await page.locator('.channels tbody tr').nth(2).waitFor();
  await select(page, 'floor 3');
  await node(page, '4').click();
  await page.locator('#message.bad', { hasText: 'floor 2 of turned-results/modes.json has azimuth and elevation' }).waitFor();
  assert.equal(await page.locator('.channels button', { hasText: /^Undo$/ }).isDisabled(), true);
  assert.equal(await page.locator('.channels button', { hasText: /^Save$/ }).isDisabled(), true);
  const odd = [
    { kind: 'modal', record: { file: 'x.csv', channels: [null, 5, { column: 'a', role: 'weird' }] }, geometry: { nodes: { constructor: [0, 0], b: 'x' }, lines: [['b'], 5, ['constructor', 'zz']], fixed: 5 } },
    { kind: 'modal', records: [null, 5, { file: 7 }], geometry: '../../etc/passwd' },
    { kind: 'damage', structure: { nodes: { a: [0, 0] }, members: [{}, { nodes: ['a', 'q'], name: 'm' }] }, data: { from: 5, sensors: [1, 'x', null, { member: 'm', at: 1, direction: 5 }] } },
    { kind: 'sid', record: { file: 'a' }, models: 'x' }];
  page.on('dialog', (dialog) => dialog.accept());
  for (const [i, json] of odd.entries()) {
    write(`odd-${i}.json`, json);
    for (const view of ['case', 'channels']) await go(page, `#/${view}/odd-${i}.json`);
    for (const one of await page.locator('.channels tbody button').all()) {
      await one.click();
      if (await page.locator('.channels .node').count()) await page.locator('.channels .node').first().click();
    }
    await go(page, '#/');
  }
  await close();
});

test('the channels of a system identification are on its masses', skip, async () => {
  run('init', 'sid', '-o', at('sid'));
  const { page, close } = await open('#/record/sid%2Fsid.csv');
  await ready(page);
  assert.equal(await arrows(page).count(), 2);
  assert.equal(await page.locator('.channels .sensor.force').count(), 1);
  assert.equal(await page.locator('[aria-label="Lowest frequency of the band in Hz"]').isVisible(), false); // no band in such a case
  await field(page, 'mass', 'displacement [m]').fill('4');
  await page.locator('.channels td .fault:visible').waitFor();
  await select(page, 'displacement [m]');
  await page.locator('.channels svg.structure .place').click();
  await ready(page);
  // Another role and back: the message asks for the quantity, which went with the role.
  await page.selectOption('[aria-label="Role of displacement [m]"]', 'ignore');
  await page.selectOption('[aria-label="Role of displacement [m]"]', 'response');
  await page.locator('.channels svg.structure .place').click();
  await page.locator('.channels td .fault:visible', { hasText: 'must be "displacement"' }).waitFor();
  assert.equal(await page.getAttribute('[aria-label="quantity of displacement [m]"]', 'aria-invalid'), 'true');
  await page.selectOption('[aria-label="quantity of displacement [m]"]', 'velocity');
  await ready(page);
  await page.selectOption('[aria-label="Role of force [N]"]', 'base-acceleration');
  await save(page);
  assert.deepEqual(read('sid/sid.json').record.channels.slice(1), [{ column: 'force [N]', role: 'base-acceleration' }, { column: 'displacement [m]', role: 'response', mass: 1, quantity: 'velocity' }]);
  await close();
});

// A universal file of dataset 58: one function for each node. Functions of unequal length are separate tables.
const universal = (lengths) => Object.entries(lengths).map(([label, samples]) => {
  const values = Array.from({ length: samples }, (ignored, i) => (Math.sin(0.3 * i) + ((i * 7919) % 1009) / 1009).toExponential(5).replace(/e([+-])(\d)$/, 'E$10$2').padStart(13));
  const none = '         0    0    0    0 NONE                 NONE                ';
  return ['    -1', '    58', 'id', 'NONE', 'NONE', 'NONE', 'NONE', `    1         0    0         0 NONE      ${label.padStart(10)}   3 NONE               0   0`,
    `         2${String(samples).padStart(10)}         1  0.00000E+00  1.00000E-02  0.00000E+00`, '        17    0    0    0 Time                 s                   ', '        12    1    0    0 Acceleration         m/s2                ', none, none,
    ...Array.from({ length: Math.ceil(samples / 6) }, (ignored, i) => values.slice(6 * i, 6 * i + 6).join('')), '    -1', ''].join('\n');
}).join('');
const twoTables = (folder) => {
  fs.mkdirSync(at(folder), { recursive: true });
  fs.writeFileSync(at(folder, 'two.uff'), universal({ 11: 300, 12: 300, 21: 200, 22: 200 }));
  for (const name of ['a', 'b']) write(`${folder}/${name}.json`, { kind: 'modal', record: { file: 'two.uff', channels: [{ column: '11:+Z Acceleration', role: 'response' }] } });
};
const idle = (page) => page.waitForFunction(() => document.querySelector('.channels')?.inert === false);
const answered = (page) => { // the questions of the page, which are declined while `accept` is false
  const asked = { texts: [], accept: false };
  page.on('dialog', (dialog) => { asked.texts.push(dialog.message()); return asked.accept ? dialog.accept() : dialog.dismiss(); });
  return asked;
};
const viewed = (page) => page.locator('label', { hasText: /^Table / }).locator('select');

test('a changed draft of a modal case is not lost without a question', skip, async () => {
  twoTables('drafts');
  const { page, close } = await open('#/record/drafts%2Ftwo.uff');
  const asked = answered(page), leave = 'Leave without saving the case?', discard = 'Discard the roles and positions of the new modal case?';
  await page.selectOption('[aria-label="Case"]', { label: 'A new modal case' });
  const role = field(page, 'Role', '12:+Z Acceleration');
  await role.selectOption('ignore');
  const kept = async () => {
    assert.equal(await page.inputValue('[aria-label="Case"]'), 'A new modal case');
    assert.equal(await role.inputValue(), 'ignore');
    assert.equal(await viewed(page).evaluate((one) => one.selectedIndex), 0);
  };
  await page.selectOption('[aria-label="Case"]', 'drafts/a.json');
  assert.deepEqual(asked.texts, [leave]);
  await kept();
  await page.evaluate(() => { location.hash = '#/'; });
  await page.waitForFunction(() => location.hash.includes('record'));
  assert.deepEqual(asked.texts, [leave, leave]);
  await kept();
  const isHeld = () => page.evaluate(() => !dispatchEvent(new Event('beforeunload', { cancelable: true })));
  assert.equal(await isHeld(), true);
  await viewed(page).selectOption({ index: 1 });
  assert.deepEqual(asked.texts, [leave, leave, discard]);
  await kept();
  // After consent, the draft has the channels of the second table. A draft without changes is replaced without a question.
  asked.accept = true;
  await viewed(page).selectOption({ index: 1 });
  await field(page, 'Role', '22:+Z Acceleration').waitFor();
  assert.equal(await isHeld(), false);
  await viewed(page).selectOption({ index: 0 });
  await role.selectOption('ignore');
  assert.deepEqual(asked.texts, [leave, leave, discard, discard]);
  // A new case has the roles of the draft, which is then left without a question.
  await page.click('text=New modal case from this record');
  await page.click('dialog >> text=Create');
  await page.locator('textarea.code').waitFor();
  assert.deepEqual(asked.texts, [leave, leave, discard, discard]);
  assert.deepEqual(read('drafts/two-modal.json').record.channels.map((one) => one.role), ['response', 'ignore']);
  await close();
});

test('a declined question keeps the chosen case of a record', skip, async () => {
  twoTables('choice');
  const { page, close } = await open('#/record/choice%2Ftwo.uff');
  const asked = answered(page);
  await page.selectOption('[aria-label="Case"]', 'choice/b.json');
  await page.locator('a[href="#/case/choice%2Fb.json"]').waitFor();
  await idle(page);
  await field(page, 'Role', '11:+Z Acceleration').selectOption('ignore');
  await page.selectOption('[aria-label="Case"]', 'choice/a.json');
  assert.equal(asked.texts.length, 1);
  assert.equal(await page.inputValue('[aria-label="Case"]'), 'choice/b.json');
  await close();
});

test('the channels of a saved case do not depend on the viewed table', skip, async () => {
  twoTables('viewed');
  const { page, close } = await open('#/record/viewed%2Ftwo.uff');
  const unused = page.locator('.channels .rest', { hasText: 'Columns of the file that the case does not use' });
  assert.match(await unused.textContent(), /not use \(1\): 2 12:\+Z/);
  await viewed(page).selectOption({ index: 1 });
  await page.selectOption('[aria-label="Case"]', 'viewed/b.json');
  await page.locator('a[href="#/case/viewed%2Fb.json"]').waitFor();
  await idle(page);
  assert.match(await unused.textContent(), /not use \(1\): 2 12:\+Z/);
  // A new case has the channels of the viewed table.
  await page.selectOption('[aria-label="Case"]', { label: 'A new modal case' });
  await field(page, 'Role', '22:+Z Acceleration').waitFor();
  await close();
});

test('typing in another set-up, or again in a field, is another step of undo', skip, async () => {
  fs.mkdirSync(at('typing'), { recursive: true });
  for (const name of ['one', 'two']) fs.writeFileSync(at(`typing/${name}.csv`), `a,b,c\n${'1,2,3\n'.repeat(20)}`);
  const channels = ['a', 'b', 'c'].map((column) => ({ column, role: 'response', azimuth: 0, elevation: 0 }));
  write('typing/case.json', { kind: 'modal', records: ['one', 'two'].map((name) => ({ file: `${name}.csv`, sample_rate: 50, channels })) });
  const { page, close } = await open('#/channels/typing%2Fcase.json');
  const asked = answered(page), typed = field(page, 'node', 'c'), undo = page.locator('.channels button', { hasText: /^Undo$/ });
  const show = async (index) => { await page.selectOption('.channels .buttons select', { index }); await idle(page); };
  await typed.fill('5');
  await show(1);
  await typed.fill('6');
  await undo.click();
  await page.waitForFunction(() => document.querySelector('[aria-label="node of c"]').value === '');
  await show(0);
  assert.equal(await typed.inputValue(), '5');
  for (const what of ['node of c', 'azimuth of c in degrees', 'elevation of c in degrees']) {
    const input = page.locator(`[aria-label="${what}"]`);
    for (const text of ['10', '20']) {
      await input.fill(text);
      await input.blur();
    }
    await undo.click();
    assert.equal(await input.inputValue(), '10', what);
  }
  asked.accept = true;
  await close();
});

test('a case shows no other file for an absolute or an empty name', skip, async () => {
  const nodes = { 1: [0, 0], 2: [0, 2] }, channels = [{ column: 'a', role: 'response' }];
  write('names/frame.json', { kind: 'damage', structure: { nodes, members: [{ nodes: ['1', '2'] }] } });
  fs.writeFileSync(at('names/x.csv'), `a,b\n${'1,2\n'.repeat(20)}`);
  write('names/case.json', { kind: 'modal', records: [{ file: '/x.csv', channels }, { file: '', channels }], geometry: '/frame.json' });
  const { page, close } = await open('#/channels/names%2Fcase.json');
  assert.equal(await page.locator('a[href^="#/record/"]').count(), 0);
  for (const index of [0, 1]) {
    await page.selectOption('.channels .buttons select', { index });
    await idle(page);
    assert.deepEqual(await page.locator('.channels tbody th').allTextContents(), ['a']);
    assert.equal(await page.locator('.channels svg.structure').count(), 0);
    assert.equal(await page.locator('#message.bad').isVisible(), false);
  }
  await close();
});

const role = (page, column, value) => page.locator(`[aria-label="Role of ${column}"] input[value="${value}"]`);
const rolesNow = (page) => page.locator('.channels tbody tr').evaluateAll((rows) => Object.fromEntries(rows.map((row) => [row.querySelector('th').textContent, row.querySelector('input[type=radio]:checked')?.value ?? row.querySelector('.quiet')?.textContent])));

test('the columns of the table of a monitor case: ranges, missing values, plots and roles by click', skip, async () => {
  run('init', 'monitor', '-o', at('bridge'));
  const before = read('bridge/monitor.json');
  const { page, close } = await open('#/case/bridge%2Fmonitor.json');
  await page.click('text=Columns of the table');
  await ready(page);
  assert.deepEqual(await rolesNow(page), { hour: 'time', 'f1 [Hz]': 'feature', 'f2 [Hz]': 'feature', 'f3 [Hz]': 'feature', 'air [degC]': 'covariate' });
  // The fraction of missing values and the range are those of the file; each column has a plot, the selected one a large one.
  const lines = fs.readFileSync(at('bridge/monitor.csv'), 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
  const cells = page.locator('.channels tbody tr').nth(1).locator('td');
  await page.locator('.channels td.missing', { hasText: '%' }).first().waitFor();
  const empty = lines.filter((line) => line[1] === '').length, values = lines.map((line) => line[1]).filter((text) => text !== '').map(Number);
  assert.ok(empty > 0);
  assert.equal(await cells.nth(2).textContent(), `${Number((100 * empty / lines.length).toPrecision(3))} %`);
  assert.equal(await cells.nth(3).locator('.range').textContent(), `${Number(Math.min(...values).toPrecision(4))} to ${Number(Math.max(...values).toPrecision(4))}`);
  assert.equal(await page.locator('.channels svg.small').count(), 5);
  assert.match(await page.getAttribute('.channels .chooser svg.plot', 'aria-label'), /^f1 over hour$/);
  assert.equal(await page.locator('.channels .chooser text', { hasText: 'end of training' }).count(), 1);
  await shot(page, 'columns');
  // Roles by click; undo; a feature that returns keeps its name and its place.
  await page.click('[aria-label="Role of f2"] label:has-text("ignored")');
  await ready(page);
  await page.locator('text=2 features, 1 covariate; times in hour.').waitFor();
  await page.click('[aria-label="Role of f2"] label:has-text("feature")');
  await ready(page);
  assert.equal(await page.locator('.channels button', { hasText: /^Save$/ }).isDisabled(), true);
  // By keyboard.
  await role(page, 'f3', 'feature').focus();
  await page.keyboard.press('ArrowRight');
  assert.equal(await role(page, 'f3', 'covariate').evaluate((one) => one.checked && one === document.activeElement), true);
  await page.keyboard.press('Control+z');
  assert.equal(await role(page, 'f3', 'feature').isChecked(), true);
  // Only one column holds the times.
  await role(page, 'air', 'time').check();
  assert.equal(await role(page, 'hour', 'ignore').isChecked(), true);
  await page.locator('.channels .status.bad').waitFor();
  await page.click('.channels >> text=Undo');
  await role(page, 'hour', 'ignore').check();
  await page.locator('.channels .status.bad', { hasText: '/series/time' }).waitFor();
  await page.locator('text=no column of times').waitFor();
  await role(page, 'hour', 'time').check();
  await role(page, 'f1', 'ignore').check();
  await role(page, 'air', 'ignore').check();
  await ready(page);
  await save(page);
  const { covariates, ...series } = before.series;
  assert.deepEqual(read('bridge/monitor.json'), { ...before, series: { ...series, features: ['f2 [Hz]', 'f3 [Hz]'] } });
  run('monitor', at('bridge/monitor.json'), '-o', at('bridge/none'), '--dry-run');
  // The data viewer shows the case of the table as well.
  await go(page, '#/record/bridge%2Fmonitor.csv');
  await ready(page);
  assert.equal(await page.inputValue('[aria-label="Case"]'), 'bridge/monitor.json');
  await role(page, 'air', 'covariate').check();
  await ready(page);
  await save(page);
  assert.deepEqual(covariates, ['air [degC]']);
  assert.deepEqual(read('bridge/monitor.json').series.covariates, ['air']);
  await close();
});

test('columns of dates, texts, equal names and standard deviations, and the mode of each feature', skip, async () => {
  const date = (i) => new Date(Date.UTC(2026, 0, 1) + 36e5 * i).toISOString().slice(0, 16);
  const rows = Array.from({ length: 60 }, (ignored, i) => [date(i), (4 + 0.01 * Math.sin(i)).toFixed(4), (5 + 0.01 * Math.cos(i)).toFixed(4), '0.01', '0.02', (10 + i % 7).toFixed(1), 11 + i % 5, 'ok']);
  fs.mkdirSync(at('dated'), { recursive: true });
  fs.writeFileSync(at('dated/ø table #1.csv'), `date;f1 [Hz];f2 [Hz];sd 1;sd 2;air;air;<b>note</b>\n${rows.map((row) => row.join(';')).join('\n')}\n`);
  const beam = { length: 30, elements: 30, supports: 'simply-supported', material: { young: 30e9, poisson: 0.2, density: 2500 }, section: { shape: 'rectangle', width: 1, height: 0.6 } };
  write('dated/case.json', { kind: 'monitor', series: { file: 'ø table #1.csv', separator: ';', time: 'date', features: ['f1 [Hz]', 'f2 [Hz]'] }, learning: { until: '2026-01-02T12:00' }, beam,
    damage: { kind: 'reduction', count: { max: 1 }, location: { uniform: [0, 30] }, reduction: { uniform: [0, 0.8] } } });
  const { page, close } = await open('#/channels/dated%2Fcase.json');
  await ready(page);
  assert.deepEqual(Object.values(await rolesNow(page)), ['time', 'feature', 'feature', 'ignore', 'ignore', 'ignore', 'ignore', 'ignore']);
  assert.equal(await page.locator('.channels tbody tr').nth(7).locator('th').textContent(), '<b>note</b>');
  assert.equal(await role(page, '<b>note</b>', 'feature').isDisabled(), true);
  assert.match(await page.locator('.channels .range').first().textContent(), /^dates from 2026-01-01/);
  // One of two columns of a name, by its number.
  await role(page, 'air (column 7)', 'covariate').check();
  await ready(page);
  // Without the first feature, the second one is still mode 2.
  await role(page, 'f1', 'ignore').check();
  assert.equal(await page.inputValue('[aria-label="mode number of f2"]'), '2');
  await ready(page);
  await page.selectOption('[aria-label="standard deviation of f2"]', 'sd 2');
  await ready(page);
  assert.equal((await rolesNow(page))['sd 2'], 'standard deviation of f2 [Hz]');
  await save(page);
  const made = read('dated/case.json');
  assert.deepEqual(made.series, { file: 'ø table #1.csv', separator: ';', time: 'date', features: ['f2 [Hz]'], covariates: [7], sd: ['sd 2'] });
  assert.deepEqual(made.explanation, { modes: [2] });
  // Each feature needs a standard deviation: the message stands at its field.
  await role(page, 'f1', 'feature').check();
  assert.equal(await page.inputValue('[aria-label="mode number of f1"]'), '1');
  await page.locator('.channels td .fault:visible').waitFor();
  assert.equal(await page.getAttribute('[aria-label="standard deviation of f1"]', 'aria-invalid'), 'true');
  await page.selectOption('[aria-label="standard deviation of f1"]', 'sd 1');
  await ready(page);
  await page.fill('[aria-label="mode number of f1"]', '2');
  await page.locator('.channels td .fault:visible', { hasText: 'named twice' }).waitFor();
  await page.click('.channels >> text=Undo');
  await save(page);
  assert.deepEqual(read('dated/case.json').series, { file: 'ø table #1.csv', separator: ';', time: 'date', features: ['f1 [Hz]', 'f2 [Hz]'], covariates: [7], sd: ['sd 1', 'sd 2'] });
  // The table of times of raw records has no features.
  write('dated/tests.json', { kind: 'monitor', series: { modes: 'modes', times: 'ø table #1.csv', time: 'date' }, learning: { until: '2026-01-02T12:00' } });
  await go(page, '#/channels/dated%2Ftests.json');
  await page.locator('.channels tbody tr').nth(7).waitFor();
  assert.equal(await page.locator('.channels input[value=feature]').count(), 0);
  await role(page, 'sd 1', 'covariate').check();
  await save(page);
  assert.deepEqual(read('dated/tests.json').series.covariates, ['sd 1']);
  await close();
});

test('a case takes only a window of the samples that it reads', skip, async () => {
  const take = (page) => page.click('text=Use this window and band in the case'), unsaved = (page) => page.locator('.channels button', { hasText: /^Save$/ }).isEnabled();
  const refused = async (page, words) => {
    await take(page);
    await page.locator('#message.bad', { hasText: words }).waitFor();
    assert.equal(await unsaved(page), false);
  };
  const zoom = async (page, from, to) => {
    await page.locator('figure', { hasText: 'Spectrum of' }).waitFor();
    await page.evaluate(() => scrollTo(0, 0));
    const before = await page.textContent('.status'), isZoomed = () => page.waitForFunction((old) => document.querySelector('.status').textContent !== old, before, { timeout: 2000 }).then(() => true, () => false);
    for (let again = 0; again < 5; again += 1) { // a drag is lost if the plots are drawn again meanwhile
      const box = await page.locator('.strips svg').first().boundingBox();
      if (!box) continue;
      await page.mouse.move(box.x + from * box.width, box.y + 40);
      await page.mouse.down();
      await page.mouse.move(box.x + to * box.width, box.y + 40, { steps: 3 });
      await page.mouse.up();
      if (await isZoomed()) return;
    }
    assert.fail('the plot is not zoomed');
  };
  // Another table of the file.
  twoTables('window');
  const { page, close } = await open('#/record/window%2Ftwo.uff');
  await viewed(page).selectOption({ index: 1 });
  await page.locator('.status', { hasText: 'of 200' }).waitFor();
  await zoom(page, 0.3, 0.6);
  await refused(page, 'The case reads 300 samples at 100 Hz from two.uff (table 1), but the window is a window of 200 samples at 100 Hz (table 2).');
  // Another record of the case.
  const line = (i) => `${Math.sin(i).toFixed(4)},${Math.cos(i).toFixed(4)}\n`;
  for (const [name, count] of [['one', 400], ['two', 300]]) fs.writeFileSync(at(`window/${name}.csv`), `a,b\n${Array.from({ length: count }, (ignored, i) => line(i)).join('')}`);
  const channels = [{ column: 'a', role: 'response' }, { column: 'b', role: 'response' }];
  write('window/set-ups.json', { kind: 'modal', records: ['one', 'two'].map((name) => ({ file: `${name}.csv`, sample_rate: 50, channels })) });
  await go(page, '#/record/window%2Fone.csv');
  await idle(page);
  await zoom(page, 0.3, 0.6);
  await page.selectOption('.channels .buttons select', { index: 1 });
  await idle(page);
  await refused(page, 'The channels below are those of two.csv, but the window is a window of one.csv.');
  await page.selectOption('.channels .buttons select', { index: 0 });
  await idle(page);
  await take(page);
  await page.waitForFunction(() => !document.querySelector('.channels .buttons button:nth-child(2)').disabled);
  await save(page);
  const [one, two] = read('window/set-ups.json').records;
  assert.ok(one.samples[0] > 50 && one.samples[1] < 300, String(one.samples));
  assert.equal(two.samples, undefined);
  // A layout that the case states: the rows differ from those of the view, or not.
  for (const [name, keys] of [['skipping', { skip: 100, header: 0 }], ['same', { decimal: '.', separator: ',' }]]) write(`window/${name}.json`, { kind: 'modal', record: { file: 'one.csv', sample_rate: 80, ...keys, channels: [1, 2].map((column) => ({ column, role: 'response' })) } });
  await go(page, '#/');
  await go(page, '#/record/window%2Fone.csv');
  await page.selectOption('[aria-label="Case"]', 'window/skipping.json');
  await page.locator('a[href="#/case/window%2Fskipping.json"]').waitFor();
  await refused(page, /The case reads 30\d samples from one\.csv with its keys "skip", "header", but the window is a window of 400 samples/);
  await page.selectOption('[aria-label="Case"]', 'window/same.json');
  await page.locator('a[href="#/case/window%2Fsame.json"]').waitFor();
  await zoom(page, 0.3, 0.6);
  await take(page);
  await page.waitForFunction(() => !document.querySelector('.channels .buttons button:nth-child(2)').disabled);
  await save(page);
  assert.ok(read('window/same.json').record.samples[1] < 300);
  // The sampling rate of the case opened before is not the rate of this case.
  await page.selectOption('[aria-label="Case"]', 'window/set-ups.json');
  await page.locator('a[href="#/case/window%2Fset-ups.json"]').waitFor();
  assert.equal(await page.inputValue('[aria-label="Sampling rate in Hz"]'), '50');
  await page.click('text=Whole record');
  await take(page);
  await page.waitForFunction(() => !document.querySelector('.channels .buttons button:nth-child(2)').disabled);
  await save(page);
  assert.deepEqual(read('window/set-ups.json').records, ['one', 'two'].map((name) => ({ file: `${name}.csv`, sample_rate: 50, channels })));
  // A file that grew meanwhile.
  fs.appendFileSync(at('window/one.csv'), line(400));
  await refused(page, 'Open the record again: the file has changed since.');
  await close();
});

test('the data viewer by keyboard: zoom, and messages on a band and on a sampling rate', skip, async () => {
  fs.mkdirSync(at('keys'), { recursive: true });
  fs.writeFileSync(at('keys/a.csv'), `a,b\n${Array.from({ length: 500 }, (ignored, i) => `${Math.sin(i).toFixed(4)},1\n`).join('')}`);
  const { page, close } = await open('#/record/keys%2Fa.csv');
  await idle(page);
  const press = async (name, then) => {
    await page.locator('button', { hasText: new RegExp(`^${name}$`) }).focus();
    await page.keyboard.press('Enter');
    await page.locator('.status', { hasText: then }).first().waitFor();
  };
  await press('Zoom in', 'Samples 125 to 375 of 500');
  await press('Later', 'Samples 250 to 500 of 500');
  for (let again = 0; again < 6; again += 1) await press('Zoom in', 'Samples');
  await page.waitForFunction(() => { // at least 8 samples, at the end of the record as well
    const [, from, to] = /Samples (\d+) to (\d+)/.exec(document.querySelector('.status').textContent);
    return to - from === 8;
  });
  await press('Whole record', 'Samples 0 to 500 of 500');
  const type = async (label, text) => {
    await page.fill(`[aria-label="${label} in Hz"]`, text);
    await page.locator(`[aria-label="${label} in Hz"]`).blur();
  };
  await type('Sampling rate', 'fast');
  await page.locator('#message.bad', { hasText: 'must be a positive number in Hz, not fast' }).waitFor();
  await type('Sampling rate', '100');
  await page.locator('figure', { hasText: 'Spectrum of' }).waitFor();
  assert.equal(await page.locator('#message').isVisible(), false);
  await type('Lowest frequency of the band', '20');
  await type('Highest frequency of the band', '5');
  await page.locator('#message.bad', { hasText: 'the lower one first, not 20 to 5: it is not used' }).waitFor();
  assert.equal(await page.locator('svg.plot .band').count(), 0);
  await type('Highest frequency of the band', '80'); // above the spectrum
  await page.locator('svg.plot .band').waitFor();
  const [band, axis] = await page.evaluate(() => ['.band', '.axis'].map((one) => { const box = [...document.querySelectorAll(`svg.plot ${one}`)].at(-1).getBBox(); return box.x + box.width; }));
  assert.ok(band <= axis + 0.1, `${band} ${axis}`);
  await close();
});

test('a case that cannot be opened leaves the list and the panel at the present case', skip, async () => {
  twoTables('failing');
  const { page, close } = await open('#/record/failing%2Ftwo.uff');
  await page.locator('a[href="#/case/failing%2Fa.json"]').waitFor();
  const unchanged = async (words) => {
    await page.selectOption('[aria-label="Case"]', 'failing/b.json');
    await page.locator('#message.bad', { hasText: words }).waitFor();
    assert.match(await page.textContent('#message'), /The page still shows failing\/a\.json\.$/);
    assert.equal(await page.inputValue('[aria-label="Case"]'), 'failing/a.json');
    assert.equal(await page.locator('a[href="#/case/failing%2Fa.json"]').count(), 1);
    assert.equal(await page.locator('.channels').evaluate((one) => one.inert), false);
  };
  const whole = read('failing/b.json');
  fs.writeFileSync(at('failing/b.json'), '{"kind": "modal", ');
  await unchanged('failing/b.json is not valid JSON');
  fs.writeFileSync(at('failing/b.json'), '{"kind": "modal"}');
  await unchanged('failing/b.json has changed: it no longer names the record two.uff.');
  fs.rmSync(at('failing/b.json'));
  await unchanged('b.json');
  // Edits of the present case remain, and Save writes it.
  await field(page, 'Role', '11:+Z Acceleration').selectOption('ignore');
  page.once('dialog', (dialog) => dialog.accept());
  await unchanged('b.json');
  assert.equal(await field(page, 'Role', '11:+Z Acceleration').inputValue(), 'ignore');
  await save(page);
  assert.equal(read('failing/a.json').record.channels[0].role, 'ignore');
  write('failing/b.json', whole);
  await page.selectOption('[aria-label="Case"]', 'failing/b.json');
  await page.locator('a[href="#/case/failing%2Fb.json"]').waitFor();
  assert.equal(await page.inputValue('[aria-label="Case"]'), 'failing/b.json');
  // Of two choices in quick succession, the last one counts.
  await page.route(/api\/case\?name=failing%2Fa/, async (route) => { await new Promise((done) => { setTimeout(done, 1500); }); await route.continue(); });
  await page.selectOption('[aria-label="Case"]', 'failing/a.json');
  await page.selectOption('[aria-label="Case"]', 'A new modal case');
  await page.waitForTimeout(2500);
  assert.equal(await page.inputValue('[aria-label="Case"]'), 'A new modal case');
  assert.equal(await page.locator('button', { hasText: 'New modal case from this record' }).isVisible(), true);
  assert.equal(await page.locator('.channels').evaluate((one) => one.inert), false);
  await page.unroute(/api\/case\?name=failing%2Fa/);
  // The editor opens a file that is not valid JSON, and corrects it.
  fs.writeFileSync(at('failing/b.json'), '{"kind": "modal", ');
  await go(page, '#/channels/failing%2Fb.json');
  await page.locator('text=This file is not valid JSON').waitFor();
  await page.click('main a:has-text("Edit the case")');
  await page.locator('text=The form appears when the JSON text is valid.').waitFor();
  await page.locator('button', { hasText: /^Run$/ }).click();
  await page.locator('#message.bad', { hasText: 'not valid JSON' }).waitFor();
  await page.fill('textarea.code', JSON.stringify(whole));
  await page.locator('[data-pointer="/record/file"]').waitFor();
  page.once('dialog', (dialog) => dialog.accept());
  await go(page, '#/');
  await close();
});

test('axe-core finds nothing in the channels, at two widths and in both schemes', skip, async () => {
  for (const [width, colorScheme] of [[1400, 'light'], [800, 'dark']]) {
    const { page, close } = await open('#/', { viewport: { width, height: 1000 }, colorScheme });
    for (const place of ['#/record/tower%2Fmodal.csv', '#/channels/portal%2Fdamage.json', '#/channels/building%2Fdamage.json', '#/channels/beam%2Fdamage.json', '#/channels/space%2Fset-ups.json', '#/record/sid%2Fsid.csv', '#/channels/bridge%2Fmonitor.json', '#/channels/dated%2Fcase.json', '#/record/bridge%2Fmonitor.csv']) {
      await go(page, place);
      await ready(page, /Valid|: /);
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
      assert.deepEqual(violations.map((v) => `${v.id}: ${v.nodes.slice(0, 3).map((n) => n.html).join(' | ')}`), [], `${place} at ${width} px, ${colorScheme}`);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${place} scrolls sideways at ${width} px`);
      if (shots) await page.locator('section.channels').screenshot({ path: path.join(shots, `look-channels-${place.replace(/\W+/g, '-')}-${width}-${colorScheme}.png`) });
    }
    await close();
  }
  if (!shots) return;
  const { page, close } = await open('#/channels/portal%2Fdamage.json', { viewport: { width: 1400, height: 700 } });
  await ready(page);
  await shot(page, 'channels');
  await close();
});
