// Role, position, direction and sign of each channel of a case, set in a list and on the drawn structure. For a monitor
// case: the role of each column of its table, beside a plot of the column.
import { ask, attempt, background, button, element, number, say } from './dom.js';
import { Drawing } from './drawing.js';
import { folderOf, relative } from './modes_case.js';
import { at, pointerOf, written } from './schema.js';
import { hasStructure, largePlot, missingOf, modeOf, noPlot, rangeOf, readViews, seriesColumns, seriesRoles, setDeviation, setMode, setSeriesRole, smallPlot } from './series.js';
import { arrowsOf, channelLists, columnOf, directionsOf, fileOf, geometryAsStructure, namedStructure, placeOf, resolved, reverse, rolesOf, rowsOf, setDirection, setPlace, setRole, sourceOf, supportOf, vectorOf, writable } from './sensors.js';
import { get, post } from './server.js';

const pause = 250; // ms between the last key and a check
const mostListed = 40; // ignored columns with a button below the list
const roleWords = { '': 'not used', response: 'sensor', force: 'force', time: 'time', ignore: 'ignored', 'base-acceleration': 'base acceleration', 'base-displacement': 'base displacement' };
const takesPlace = (row) => ['response', 'force', ''].includes(row.role);

// The channels of a measured file for `rowsOf`.
export const columnsOf = (table) => table?.channels ?? [];

// The channels that a list of the case refers to: columns of its record or table, or sensors of its modes.json.
const knownOf = async (name, doc, list) => {
  const block = at(doc, list.path), stated = fileOf(doc, list), file = resolved(folderOf(name), stated);
  if (list.kind !== 'modes') {
    if (!file) return [];
    const [table] = (await get('record', sourceOf(file, block))).tables;
    return list.kind === 'series' ? seriesColumns(table, columnOf) : columnsOf(table);
  }
  if (!block?.from) return [];
  if (!file?.endsWith('/modes.json')) throw new Error(`${block.from}: the application reads names of sensors only from a modes.json inside its own folder.`);
  return (await get('result', { name: file.slice(0, -'/modes.json'.length), file: 'modes.json' })).sensors;
};

export class ChannelPanel {
  // `name` is the file of the case. A draft has no file yet. `known(list)` may give the channels of a list.
  // `complete(doc)` adds what a draft lacks before it is checked. `changed()` is called when the panel shows
  // a change.
  constructor({ name, doc, version = null, draft = false, known, complete = (one) => one, changed }) {
    Object.assign(this, { name, doc, version, draft, complete, changed });
    this.knownOf = known ?? ((list) => knownOf(this.name, this.doc, list));
    this.saved = written(doc);
    [this.undone, this.redone, this.known, this.rows, this.selected, this.named, this.lastDirection] = [[], [], [], [], 0, null, 'x'];
    this.listIndex = 0;
    this.status = element('p', { class: 'status', role: 'status', 'aria-live': 'polite' });
    this.table = element('div');
    this.rest = element('div', { class: 'rest' });
    this.chooser = element('div', { class: 'chooser' });
    this.source = element('div');
    const drawn = this.drawn = element('div', { class: 'drawing' });
    this.drawing = new Drawing(drawn, { picked: (place) => this.put(place), pointed: (arrow) => this.select(arrow.number - 1) });
    this.buttons = [...(draft ? [] : [button('Save', () => this.save(), { class: 'main' })]), button('Undo', () => this.step(this.undone, this.redone)), button('Redo', () => this.step(this.redone, this.undone))];
    this.lists = element('span');
    this.node = element('section', { class: doc.kind === 'monitor' ? 'channels wide' : 'channels', 'aria-label': doc.kind === 'monitor' ? 'Columns of the table' : 'Channels on the structure' },
      element('div', { class: 'buttons' }, this.buttons, this.lists), this.status,
      element('div', { class: 'panes' }, element('div', { class: 'pane' }, this.table, this.rest),
        element('div', { class: 'side' }, this.chooser, drawn, this.source)));
    this.keys = (event) => {
      if (!(event.ctrlKey || event.metaKey)) return;
      const key = event.key.toLowerCase();
      if (key === 's' && !draft) this.save();
      else if (key === 'z') this.step(...(event.shiftKey ? [this.redone, this.undone] : [this.undone, this.redone]));
      else if (key === 'y') this.step(this.redone, this.undone);
      else return;
      event.preventDefault();
    };
    this.leaving = (event) => { if (this.unsaved()) event.preventDefault(); };
    addEventListener('keydown', this.keys);
    addEventListener('beforeunload', this.leaving);
  }

  close() {
    this.closed = true;
    clearTimeout(this.timer);
    removeEventListener('keydown', this.keys);
    removeEventListener('beforeunload', this.leaving);
  }

  // The changes of a draft are unsaved until a case is made from it.
  unsaved() { return written(this.doc) !== this.saved; }

  list() { return channelLists(this.doc)[this.listIndex]; }

  structure() { return this.doc.structure?.nodes ? this.doc.structure : geometryAsStructure(this.doc.geometry) ?? this.named; }

  support() { return supportOf(this.doc, this.structure()); }

  // Reads the channels of the current list, then shows it.
  async load() {
    const list = this.list();
    this.known = [];
    this.fault = null;
    this.typed = null;
    // Clicks during the reading would be lost.
    const focused = this.lists.contains(document.activeElement);
    this.node.inert = true;
    await background(async () => { this.known = (await this.knownOf(list)) ?? []; });
    await this.findStructure();
    this.node.inert = false;
    this.rows = rowsOf(this.doc, list, this.known);
    const open = this.nextWithout(-1);
    this.selected = Math.max(0, open >= 0 ? open : this.rows.findIndex((row) => ['response', 'force'].includes(row.role)));
    if (list.kind === 'series') this.selected = Math.max(0, this.rows.findIndex((row) => row.role === 'feature'));
    this.show();
    if (list.kind === 'series') this.readColumns(list);
    if (focused) this.lists.querySelector('select')?.focus();
    if (!this.draft) this.check();
  }

  // The ranges and plots of the columns of a series, which may take longer than the list.
  readColumns(list) {
    const { known } = this, file = resolved(folderOf(this.name), fileOf(this.doc, list));
    if (file && known.length) background(() => readViews(sourceOf(file, at(this.doc, list.path)), known, () => { if (!this.closed && this.known === known) this.fillViews(); }));
  }

  async findStructure() {
    this.named = typeof this.doc.geometry === 'string' ? await namedStructure(this.name, this.doc.geometry) : null;
  }

  // ------------------------------------------------------------------- edits

  // Changes the case; false if the action fails. `typed` names a field in which the user types: one undo step, no new table.
  edit(action, typed = null) {
    const before = written(this.doc), row = this.rows[this.selected];
    try {
      action();
    } catch (error) {
      this.doc = JSON.parse(before);
      say(error.message, true);
      this.show();
      return false;
    }
    if (written(this.doc) === before) { if (!typed) this.show(); return true; }
    if (!typed || typed !== this.typed) this.undone.push(before);
    this.typed = typed;
    if (this.undone.length > 300) this.undone.shift();
    this.redone.length = 0;
    this.after(row, typed !== null);
    return true;
  }

  after(row, light = false) {
    this.rows = rowsOf(this.doc, this.list(), this.known);
    const now = row && row.i !== null ? this.rows.findIndex((one) => one.i === row.i) : -1;
    if (now >= 0) this.selected = now;
    if (light) this.showRest(); else this.show();
    this.schedule();
  }

  step(from, to) {
    if (!from.length) return;
    to.push(written(this.doc));
    this.doc = JSON.parse(from.pop());
    this.typed = null;
    if (!this.list()) this.listIndex = 0;
    attempt(async () => {
      await this.findStructure();
      this.after(null);
    });
  }

  change(row, action, typed) { return this.edit(() => action(writable(this.doc, this.list(), row, this.known, this.support())), typed); }

  // A position picked on the drawing, for the selected channel.
  put(place) {
    const row = this.rows[this.selected], support = this.support();
    if (!row) return;
    if (!takesPlace(row) && row.role !== 'ignore') { say(`${row.name} has the role ${roleWords[row.role] ?? row.role}: channels of this role have no position.`, true); return; }
    const done = this.change(row, (channel) => {
      if (row.role === 'ignore' && this.list().kind === 'record') channel.role = 'response';
      setPlace(channel, place, support);
      if (!vectorOf(channel, support)) setDirection(channel, this.freeDirection(place, row), support);
    });
    if (done) this.announce(`${row.name}: ${this.words(this.rows[this.selected].channel)}.`);
  }

  // The last direction, or the next axis that no other channel has at this position.
  freeDirection(place, row) {
    const support = this.support(), all = directionsOf(this.list(), support).filter((one) => one !== 'angles');
    const taken = this.rows.filter((one) => one !== row && JSON.stringify(placeOf(one.channel, support)) === JSON.stringify(place)).map((one) => String(one.channel.direction ?? '').replace('-', ''));
    return [this.lastDirection, ...all.filter((one) => !one.startsWith('-'))].find((one) => all.includes(one) && !taken.includes(one.replace('-', ''))) ?? all[0] ?? '';
  }

  turnTo(row, direction) {
    const support = this.support();
    if (direction && direction !== 'angles') this.lastDirection = direction;
    this.change(row, (channel) => setDirection(channel, direction, support));
  }

  select(k) {
    if (k === this.selected || !this.rows[k]) return;
    this.selected = k;
    this.table.querySelectorAll('tbody tr').forEach((line, i) => this.markSelected(line, i));
    this.showRest();
  }

  markSelected(line, i) {
    line.classList.toggle('on', i === this.selected);
    line.querySelector('button')?.setAttribute('aria-pressed', String(i === this.selected));
  }

  // The next row after `k` that is a sensor or force without a position; -1 if all have one.
  nextWithout(k) {
    const support = this.support();
    const open = this.rows.map((row, i) => (['response', 'force'].includes(row.role) && !placeOf(row.channel, support) ? i : -1)).filter((i) => i >= 0);
    return open.find((i) => i > k) ?? open[0] ?? -1;
  }

  // ------------------------------------------------------------------- views

  words(channel) {
    const support = this.support(), place = placeOf(channel, support);
    if (!place) return 'no position';
    const where = place.member !== undefined ? `member ${place.member} at ${number(place.at, 6)} m` : place.node !== undefined ? `node ${place.node}`
      : place.mass !== undefined ? `mass ${place.mass}` : place.dof !== undefined ? `degree of freedom ${place.dof}` : `${number(place.at, 6)} m`;
    const angles = channel.azimuth !== undefined || channel.elevation !== undefined;
    const along = angles ? `azimuth ${number(Number(channel.azimuth ?? 0))}°, elevation ${number(Number(channel.elevation ?? 0))}°` : channel.direction ?? (support === 'chain' && !this.list().ofMasses ? 'x' : support === 'beam' ? 'deflection' : '');
    if (this.list().ofMasses) return where;
    return along ? `${where}, ${angles ? '' : 'direction '}${along}` : `${where}, no direction`;
  }

  announce(text) {
    this.said = text;
    this.showStatus();
  }

  showStatus() {
    const { fault } = this;
    this.status.className = `status${fault === undefined || fault === null ? '' : fault.valid ? ' good' : ' bad'}`;
    this.status.replaceChildren(this.said ? `${this.said} ` : '', !fault ? '' : fault.valid ? 'Valid: the case can run.' : `${fault.pointer === '/' ? '' : `${fault.pointer}: `}${fault.reason}`);
  }

  show() {
    const list = this.list(), all = channelLists(this.doc);
    this.rows = rowsOf(this.doc, list, this.known);
    this.selected = Math.min(this.selected, Math.max(0, this.rows.length - 1));
    this.lists.replaceChildren(all.length > 1 ? element('label', { class: 'inline' }, list.kind === 'record' ? 'Set-up ' : 'List ', element('select', { onchange: (event) => { this.listIndex = event.target.selectedIndex; this.rows = []; this.load(); } },
      all.map((one, i) => element('option', { selected: i === this.listIndex }, one.label)))) : '');
    const focus = this.table.contains(document.activeElement) ? document.activeElement.id : null;
    if (list.kind === 'series') {
      this.showSeries();
      if (focus) document.getElementById(focus)?.focus({ preventScroll: true });
      this.showRest();
      this.mark();
      return;
    }
    const heads = ['', 'channel', 'role', { beam: 'position [m]', chain: 'mass', matrices: 'place', plane: 'node', space: 'node' }[this.support()], list.ofMasses ? 'quantity' : 'direction', list.kind === 'record' && !list.ofMasses && 'reference'].filter((head) => head !== false);
    if (list.kind === 'modes' && ['plane', 'space'].includes(this.support())) heads[3] = 'node or member';
    this.table.replaceChildren(element('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Roles of the channels' }, element('table', {}, element('caption', {}, 'Role, position and direction of each channel'),
      element('thead', {}, element('tr', {}, heads.map((head) => (head ? element('th', { scope: 'col' }, head) : element('td', {}))))),
      element('tbody', {}, this.rows.map((row, k) => this.line(row, k)))), this.datalist()));
    if (focus) document.getElementById(focus)?.focus({ preventScroll: true });
    this.showRest();
    this.mark();
  }

  datalist() {
    const names = this.support() === 'chain' ? ((this.doc.structure?.chain ?? this.doc.models?.[0])?.masses ?? []).map((ignored, i) => String(i + 1))
      : [...Object.keys(this.structure()?.nodes ?? {}), ...(this.list().kind === 'modes' ? (this.structure()?.members ?? []).map((member) => member.name).filter(Boolean) : [])];
    return element('datalist', { id: 'places' }, names.map((name) => element('option', { value: name })));
  }

  // Updates the parts that change while a text is typed: undo, unassigned channels, the chooser and the drawing.
  showRest() {
    const [undo, redo] = this.buttons.slice(-2);
    undo.disabled = !this.undone.length;
    redo.disabled = !this.redone.length;
    if (!this.draft) this.buttons[0].disabled = !this.unsaved();
    this.changed?.();
    this.drawn.hidden = this.list().kind === 'series';
    if (this.drawn.hidden) { this.showSeriesRest(); return; }
    const support = this.support(), pick = (k) => button(`${k + 1} ${this.rows[k].name}`, () => this.select(k), { class: 'plain', title: 'Select this channel' });
    const open = this.rows.map((row, k) => k).filter((k) => ['response', 'force'].includes(this.rows[k].role) && !placeOf(this.rows[k].channel, support));
    const unused = this.rows.map((row, k) => k).filter((k) => this.rows[k].role === '');
    this.rest.replaceChildren(element('p', { class: open.length ? 'open' : 'quiet' }, open.length ? [`Channels without a position (${open.length}): `, ...open.map(pick)] : 'Every sensor and force has a position.'),
      unused.length ? element('p', { class: 'quiet' }, `Columns of the file that the case does not use (${unused.length}): `, unused.map(pick)) : '');
    this.showChooser();
    const arrows = arrowsOf(this.rows, support).map((arrow) => ({ ...arrow, selected: arrow.number === this.selected + 1 }));
    const drawable = this.structure() || this.doc.structure?.chain || this.doc.beam || this.doc.models?.[0]?.masses;
    this.drawing.show(drawable ? this.doc : {}, this.named, arrows);
    if (!drawable) this.drawing.place.replaceChildren(element('p', { class: 'empty' }, this.list().kind === 'record'
      ? 'The case has no geometry, so there is no drawing yet. Choose a structure below, or type the nodes in the list.' : 'This structure has no drawing: type the positions in the list.'));
    this.showSource(drawable);
  }

  showChooser() {
    const row = this.rows[this.selected], support = this.support();
    if (!row) { this.chooser.replaceChildren(); return; }
    const { channel } = row, placed = placeOf(channel, support), directions = directionsOf(this.list(), support);
    const current = channel.azimuth !== undefined || channel.elevation !== undefined ? 'angles' : channel.direction ?? { chain: 'x', beam: 'deflection' }[support] ?? '';
    const now = support === 'chain' && !placed ? '' : current, next = this.nextWithout(this.selected);
    const takes = takesPlace(row) || row.role === 'ignore', what = { beam: 'its position on the beam', chain: 'its mass', plane: 'its node', space: 'its node', matrices: '' }[support];
    const where = this.list().kind === 'modes' && ['plane', 'space'].includes(support) ? 'its node, or a point of a member,' : what;
    const title = element('p', { class: 'chosen' }, element('strong', {}, `${this.selected + 1} ${row.name}: `), !takes ? `channels of the role ${roleWords[row.role] ?? row.role} have no position.`
      : placed ? `${this.words(channel)}${row.inherited ? ' (from modes.json)' : ''}.` : `no position yet. Click ${where} on the drawing, or type the position in the list.`);
    const tools = takes && row.i !== null ? [directions.length ? element('span', { class: 'tools', role: 'radiogroup', 'aria-label': 'Direction' }, directions.map((one) =>
      button(one === 'angles' ? 'angles' : one.replace('-', '−'), () => this.turnTo(row, one), { role: 'radio', 'aria-checked': String(one === now), class: one === now ? 'on' : '', 'data-direction': one, title: one === 'angles' ? 'azimuth and elevation' : null }))) : null,
    directions.length && vectorOf(channel, support) && support !== 'beam' ? button('Reverse', () => this.change(row, (own) => reverse(own, support)), { title: 'The positive axis of the sensor points opposite to this direction' }) : null,
    placed ? button('Clear the position', () => this.change(row, (own) => setPlace(own, null, support))) : null] : [];
    if (next >= 0 && next !== this.selected) tools.push(button(`Next without a position: ${this.rows[next].name}`, () => this.select(next)));
    const focused = this.chooser.contains(document.activeElement) ? document.activeElement.textContent : null;
    this.chooser.replaceChildren(title, element('div', { class: 'tools' }, tools.filter(Boolean)));
    if (focused) [...this.chooser.querySelectorAll('button')].find((one) => one.textContent === focused)?.focus({ preventScroll: true });
  }

  line(row, k) {
    const list = this.list(), support = this.support(), id = (what) => `c:${k}:${what}`, field = (key) => `${row.pointer}/${key}`;
    const takes = takesPlace(row) || row.role === 'ignore', roles = rolesOf(this.doc, list);
    const role = element('select', { id: id('role'), 'aria-label': `Role of ${row.name}`, onchange: () => this.edit(() => setRole(this.doc, list, row, role.value, this.known, support)) },
      [...(row.role === '' ? [''] : []), ...roles, ...(row.role && !roles.includes(row.role) ? [row.role] : [])].map((one) => element('option', { value: one, selected: one === row.role }, roleWords[one] ?? String(one))));
    const cell = (key, ...nodes) => element('td', { 'data-pointer': field(key) }, ...nodes, element('p', { class: 'fault', hidden: true }));
    const line = element('tr', { 'data-pointer': row.pointer || null, class: takes ? '' : 'unused' },
      element('td', {}, button(String(k + 1), () => this.select(k), { id: id('select'), 'aria-label': `${k + 1}: select ${row.name}`, 'aria-pressed': 'false' })),
      element('th', { scope: 'row' }, row.name, row.unit && !row.name.endsWith(`[${row.unit}]`) ? ` [${row.unit}]` : '', element('p', { class: 'fault', hidden: true })), cell('role', role),
      takes && row.role !== 'ignore' ? this.placeCell(row, id, cell) : element('td', {}), takes && row.role !== 'ignore' ? this.directionCell(row, id, cell) : element('td', {}),
      list.kind !== 'record' || list.ofMasses ? null : row.role !== 'response' ? element('td', {}) : cell('reference', element('input', { id: id('reference'), type: 'checkbox', 'aria-label': `${row.name} is a reference`, checked: row.channel.reference === true,
        onchange: (event) => { const { checked } = event.target; this.change(row, (channel) => { if (checked) channel.reference = true; else delete channel.reference; }); } })));
    line.addEventListener('focusin', () => this.select(k));
    line.addEventListener('click', () => this.select(k));
    this.markSelected(line, k);
    return line;
  }

  placeCell(row, id, cell) {
    const support = this.support(), place = placeOf(row.channel, support), key = { beam: 'at', chain: 'mass', matrices: row.channel.dof !== undefined ? 'dof' : 'node' }[support] ?? (row.channel.member !== undefined ? 'member' : 'node');
    const shown = place?.member ?? place?.node ?? place?.mass ?? place?.dof ?? (support === 'beam' ? place?.at : undefined) ?? row.channel.at ?? '';
    const named = support === 'beam' ? 'position' : support === 'chain' ? 'mass' : 'node';
    const input = element('input', { id: id('place'), class: 'short', value: String(shown), list: 'places', autocomplete: 'off', spellcheck: 'false', 'aria-label': `${named} of ${row.name}`,
      inputmode: support === 'beam' ? 'decimal' : undefined, oninput: () => this.change(row, (channel) => setPlace(channel, this.typedPlace(input.value.trim(), row), support), id('place')),
      onchange: () => { this.typed = null; this.show(); } });
    const at = place?.member === undefined ? null : element('label', { class: 'inline', 'data-pointer': `${row.pointer}/at` }, ' at ', element('input', { id: id('at'), class: 'short', inputmode: 'decimal', value: String(place.at ?? ''), 'aria-label': `distance of ${row.name} from the first node of the member in m`,
      oninput: (event) => { const x = Number(event.target.value.replace(',', '.')); this.change(row, (channel) => { channel.at = event.target.value.trim() !== '' && Number.isFinite(x) ? x : event.target.value; }, id('at')); }, onchange: () => { this.typed = null; } }), ' m');
    return cell(key, input, at);
  }

  typedPlace(text, row) {
    const support = this.support(), x = Number(text.replace(',', '.')), isNumber = text !== '' && Number.isFinite(x);
    if (text === '') return null;
    if (support === 'beam') return { at: isNumber ? x : text };
    if (support === 'chain') return Number.isInteger(x) ? { mass: x } : { node: text };
    if (support === 'matrices') return row.channel.dof !== undefined && isNumber ? { dof: x } : { node: text };
    const structure = this.structure(), member = this.list().kind === 'modes' && !Object.hasOwn(structure?.nodes ?? {}, text) && (structure?.members ?? []).find((one) => one.name === text);
    if (!member) return { node: text };
    const [a, b] = member.nodes.map((name) => structure.nodes[name]);
    return { member: text, at: Number((row.channel.at ?? (Array.isArray(a) && Array.isArray(b) ? Math.hypot(...a.map((v, i) => v - b[i])) / 2 : 0)).toPrecision(4)) };
  }

  directionCell(row, id, cell) {
    const support = this.support(), options = directionsOf(this.list(), support), { channel } = row;
    if (this.list().ofMasses) {
      if (row.role !== 'response') return element('td', {});
      const quantity = element('select', { id: id('quantity'), 'aria-label': `quantity of ${row.name}`, onchange: () => this.change(row, (own) => { own.quantity = quantity.value; }) },
        [...(channel.quantity ? [] : ['']), 'displacement', 'velocity', 'acceleration'].map((one) => element('option', { value: one, selected: (channel.quantity ?? '') === one }, one || '–')));
      return cell('quantity', quantity);
    }
    const angles = channel.azimuth !== undefined || channel.elevation !== undefined;
    if (support === 'matrices') return cell('direction', element('input', { id: id('direction'), class: 'short', value: channel.direction ?? '', 'aria-label': `direction of ${row.name}`, oninput: (event) => { const text = event.target.value.trim(); this.change(row, (own) => { if (text) own.direction = text; else delete own.direction; }, id('direction')); }, onchange: () => { this.typed = null; } }));
    const now = angles ? 'angles' : channel.direction ?? { beam: 'deflection', chain: placeOf(channel, support) ? 'x' : '' }[support] ?? '';
    const select = element('select', { id: id('direction'), 'aria-label': `direction of ${row.name}`, onchange: () => this.turnTo(row, select.value) },
      [...(now && options.includes(now) ? [] : [now]), ...options].map((one) => element('option', { value: one, selected: one === now }, String(one).replace('-', '−') || '–')));
    const angle = (key, label) => element('label', { class: 'inline', 'data-pointer': `${row.pointer}/${key}` }, label, element('input', { id: id(key), class: 'angle', inputmode: 'decimal', value: String(channel[key] ?? 0), 'aria-label': `${key} of ${row.name} in degrees`,
      oninput: (event) => { const x = Number(event.target.value.replace(',', '.')); this.change(row, (own) => { own[key] = event.target.value.trim() !== '' && Number.isFinite(x) ? x : event.target.value; }, id(key)); }, onchange: () => { this.typed = null; } }), '°');
    return cell('direction', select, angles ? element('span', { class: 'angles' }, angle('azimuth', 'az. '), angle('elevation', 'el. ')) : null);
  }

  // The choice of a geometry for a modal case without one.
  showSource(drawable) {
    if (this.list().kind !== 'record' || this.list().ofMasses || drawable) { this.source.replaceChildren(); return; }
    if (this.source.children.length) return;
    const choice = element('select', { 'aria-label': 'Structure to draw', onchange: () => attempt(() => this.takeGeometry(choice.value)) }, element('option', { value: '' }, 'Choose a structure …'), element('option', { value: 'line' }, 'A new line of nodes …'));
    this.source.replaceChildren(element('label', { class: 'inline' }, 'Structure ', choice));
    get('projects').then(async ({ cases }) => {
      for (const one of cases.filter((each) => ['damage', 'update', 'modal'].includes(each.kind) && each.name !== this.name).slice(0, 100)) {
        const doc = await get('case', { name: one.name }).then((opened) => JSON.parse(opened.text)).catch(() => null);
        if (doc?.structure?.nodes || doc?.geometry?.nodes) choice.append(element('option', { value: `/${one.name}` }, `${doc.geometry?.nodes ? 'Geometry' : 'Structure'} of ${one.name}`));
      }
    }).catch(() => { /* the line of nodes remains */ });
  }

  async takeGeometry(chosen) {
    let geometry;
    if (chosen === 'line') {
      const kind = element('select', {}, ['vertical', 'horizontal'].map((one) => element('option', {}, one)));
      const count = element('input', { class: 'number', inputmode: 'numeric', value: '4', required: true }), spacing = element('input', { class: 'number', inputmode: 'decimal', value: '3', required: true });
      const given = await ask('A line of nodes', [{ label: 'Direction of the line', control: kind }, { label: 'Number of nodes, with the first at 0', control: count }, { label: 'Distance between nodes [m]', control: spacing }], 'Draw');
      if (!given) { this.source.querySelector('select').value = ''; return; }
      const [n, step] = [Number(given[1]), Number(given[2].replace(',', '.'))];
      if (!Number.isInteger(n) || n < 2 || n > 1000 || !(step > 0)) throw new Error(`A line needs 2 to 1000 nodes and a positive distance, not ${given[1]} nodes and ${given[2]} m.`);
      const names = Array.from({ length: n }, (ignored, i) => String(i));
      geometry = { nodes: Object.fromEntries(names.map((one, i) => { const x = Number((i * step).toPrecision(12)); return [one, given[0] === 'vertical' ? [0, x] : [x, 0]]; })), lines: [names], fixed: ['0'] };
    } else {
      const file = chosen.slice(1), doc = JSON.parse((await get('case', { name: file })).text);
      geometry = doc.geometry?.nodes ? doc.geometry : relative(folderOf(this.name), file);
    }
    if (typeof geometry === 'string') this.named = await namedStructure(this.name, geometry);
    this.source.replaceChildren();
    this.edit(() => { this.doc.geometry = geometry; });
  }

  // ------------------------------------------------------- columns of a series

  showSeries() {
    const list = this.list(), numeric = this.rows.filter((row) => row.column?.isNumeric && ['ignore', 'sd'].includes(row.role));
    this.deviations = list.key === 'file' && (numeric.length > 0 || Array.isArray(this.doc.series?.sd)) ? numeric : null;
    this.modes = list.key === 'file' && hasStructure(this.doc);
    const heads = ['', 'column', 'role', 'missing', 'values', this.deviations && 'standard deviation', this.modes && 'mode'].filter((head) => head === '' || head);
    this.table.replaceChildren(element('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Roles of the columns' }, element('table', { class: 'series' }, element('caption', {}, 'Role of each column of the table'),
      element('thead', {}, element('tr', {}, heads.map((head) => (head ? element('th', { scope: 'col' }, head) : element('td', {}))))),
      element('tbody', {}, this.rows.map((row, k) => this.seriesLine(row, k))))));
    this.fillViews();
  }

  seriesLine(row, k) {
    const list = this.list(), id = (what) => `c:${k}:${what}`, { column } = row;
    const cell = (pointer, ...nodes) => element('td', { 'data-pointer': pointer || null }, ...nodes, element('p', { class: 'fault', hidden: true }));
    const choose = (role) => this.edit(() => setSeriesRole(this.doc, row, role, this.known));
    const radio = (role) => element('label', {}, element('input', { type: 'radio', name: id('role'), id: id(role), value: role, checked: row.role === role,
      disabled: ['feature', 'covariate'].includes(role) && column?.isNumeric === false && !column.isAbscissa, onchange: () => choose(role) }), ` ${seriesRoles[role]}`);
    const words = { file: 'names of the files', sd: `standard deviation of ${this.doc.series?.features?.[row.index] ?? 'a feature'}` }[row.role];
    const roles = Object.keys(seriesRoles).filter((role) => role !== 'feature' || list.key === 'file');
    const group = element('span', { class: 'roles', role: 'radiogroup', 'aria-label': `Role of ${row.name}` }, row.role === 'file' ? null : roles.map(radio));
    const line = element('tr', { class: row.role === 'ignore' ? 'unused' : '' },
      element('td', {}, button(String(k + 1), () => this.select(k), { id: id('select'), 'aria-label': `${k + 1}: select ${row.name}`, 'aria-pressed': 'false' })),
      element('th', { scope: 'row' }, row.name, row.unit && !row.name.endsWith(`[${row.unit}]`) ? ` [${row.unit}]` : ''), cell(row.role === 'sd' ? null : row.pointer, row.role === 'file' ? null : group, words ? element('span', { class: 'quiet' }, words) : null),
      element('td', { class: 'missing' }), element('td', {}, element('span', { class: 'range' }), element('span', { class: 'plotted' })),
      this.deviations ? row.role === 'feature' ? cell(`/series/sd/${row.index}`, this.deviationChoice(row, id('sd'))) : element('td', {}) : null,
      this.modes ? row.role === 'feature' ? cell(`/explanation/modes/${row.index}`, element('input', { id: id('mode'), class: 'short', inputmode: 'numeric', value: String(modeOf(this.doc, row)), 'aria-label': `mode number of ${row.name}`,
        oninput: (event) => this.edit(() => setMode(this.doc, row, event.target.value), id('mode')), onchange: () => { this.typed = null; } })) : element('td', {}) : null);
    line.addEventListener('focusin', () => this.select(k));
    line.addEventListener('click', () => this.select(k));
    this.markSelected(line, k);
    return line;
  }

  deviationChoice(row, id) {
    const now = this.doc.series?.sd?.[row.index] ?? '', own = this.rows.find((one) => one.role === 'sd' && one.index === row.index);
    const options = [{ text: '', label: '–' }, ...this.deviations.filter((one) => one.role === 'ignore' || one === own).map((one) => ({ text: one.text ?? one.column.text, label: one.name }))];
    if (now !== '' && !options.some((one) => one.text === now)) options.push({ text: now, label: String(now) });
    const select = element('select', { id, 'aria-label': `standard deviation of ${row.name}`, onchange: () => this.edit(() => setDeviation(this.doc, row, options[select.selectedIndex].text)) },
      options.map((one) => element('option', { selected: one.text === now }, one.label)));
    return select;
  }

  // Missing values, ranges and plots as far as they are known.
  fillViews() {
    this.table.querySelectorAll('tbody tr').forEach((line, k) => {
      const { column } = this.rows[k] ?? {};
      line.querySelector('.missing').textContent = missingOf(column);
      line.querySelector('.range').textContent = rangeOf(column);
      const place = line.querySelector('.plotted'), drawn = place.firstChild ? null : smallPlot(column);
      if (drawn) place.append(drawn);
    });
    this.showSeriesPlot();
  }

  showSeriesPlot() {
    const row = this.rows[this.selected];
    this.chooser.replaceChildren(...(row ? [element('p', { class: 'chosen' }, element('strong', {}, `${this.selected + 1} ${row.name}`), `: ${rangeOf(row.column)}${row.column?.isNumeric && row.unit && row.column.missing < 1 ? ` ${row.unit}` : ''}`),
      largePlot(this.doc, this.list(), this.known, row.column) ?? noPlot(row.column)] : []));
  }

  showSeriesRest() {
    const of = (role) => this.rows.filter((row) => row.role === role), [features, covariates, times] = ['feature', 'covariate', 'time'].map(of);
    const count = (rows, word) => `${rows.length} ${word}${rows.length === 1 ? '' : 's'}`;
    const pick = (k) => button(`${k + 1} ${this.rows[k].name}`, () => this.select(k), { class: 'plain', title: 'Select this column' });
    const unused = this.rows.map((row, k) => k).filter((k) => this.rows[k].role === 'ignore');
    this.rest.replaceChildren(element('p', { class: times.length ? 'quiet' : 'open' }, `${this.list().key === 'file' ? `${count(features, 'feature')}, ` : ''}${count(covariates, 'covariate')}; ${times.length ? `times in ${times[0].name}` : 'no column of times: give one column the role time'}.`),
      unused.length ? element('p', { class: 'quiet' }, `Ignored columns (${unused.length}): `, unused.slice(0, mostListed).map(pick), unused.length > mostListed ? ' …' : '') : '');
    this.source.replaceChildren();
    this.showSeriesPlot();
  }

  // ------------------------------------------------------------------- checks

  schedule() {
    clearTimeout(this.timer);
    this.fault = null;
    this.mark();
    this.timer = setTimeout(() => this.check(), pause);
  }

  async check() {
    if (this.checking) { this.again = true; return; }
    this.checking = true;
    const asked = written(this.doc);
    try {
      const answer = await post('check', { name: this.name, text: `${written(this.complete(JSON.parse(asked)))}\n` });
      if (!this.closed && asked === written(this.doc)) { this.fault = answer; this.mark(); }
    } catch (error) {
      if (!this.closed) say(error.message, true);
    }
    this.checking = false;
    if (this.again && !this.closed) { this.again = false; this.check(); }
  }

  // Shows the fault at its field.
  mark() {
    for (const old of this.table.querySelectorAll('.fault:not([hidden])')) { old.hidden = true; old.textContent = ''; }
    for (const old of this.table.querySelectorAll('[aria-invalid]')) { old.removeAttribute('aria-invalid'); old.removeAttribute('aria-describedby'); }
    this.showStatus();
    if (!this.fault || this.fault.valid) return;
    // A fault of the sensors in a modes.json is named from the top of that file.
    const pointers = [this.fault.pointer, pointerOf(this.list().path) + this.fault.pointer];
    let place = null;
    for (const pointer of pointers)
      for (let part = pointer; part && !place; part = part.slice(0, part.lastIndexOf('/'))) place = this.table.querySelector(`[data-pointer="${CSS.escape(part)}"]`);
    if (!place) return;
    const message = (place.matches('label') ? place.closest('td') : place).querySelector('.fault');
    message.id = 'channel-fault';
    message.hidden = false;
    message.textContent = this.fault.reason;
    const control = place.querySelector('[role=radiogroup], input, select');
    control?.setAttribute('aria-invalid', 'true');
    control?.setAttribute('aria-describedby', 'channel-fault');
  }

  save() {
    return attempt(async () => {
      const now = written(this.doc);
      this.version = (await post('save', { name: this.name, text: `${now}\n`, before: this.version })).version;
      this.saved = now;
      this.showRest();
      say('Saved.');
      return true;
    });
  }
}

// The channels of one case.
export const channelsView = async (place, name) => {
  const opened = await get('case', { name });
  let doc = null;
  try { doc = JSON.parse(opened.text); } catch { /* the editor names line and column */ }
  const edit = element('a', { href: `#/case/${encodeURIComponent(name)}` }, 'Edit the case');
  if (!channelLists(doc).length) {
    place.replaceChildren(element('h1', {}, `Channels of ${name}`), element('p', {}, doc ? 'This case has no channels. A modal case or a system identification takes its channels from its record. A damage or update case takes them from its sensors or from the modes of a modal run. A monitor case takes them from its table (file or times of series).'
      : 'This file is not valid JSON, so its channels are unknown. Edit the case to correct it.'), element('p', {}, edit));
    return undefined;
  }
  const panel = new ChannelPanel({ name, doc, version: opened.version, changed: () => { document.title = `${panel.unsaved() ? '• ' : ''}${name} · Wheeltap`; } });
  const records = [...new Set(channelLists(doc).filter((list) => list.kind !== 'modes').map((list) => resolved(folderOf(name), fileOf(doc, list))).filter(Boolean))];
  place.replaceChildren(element('h1', {}, `${doc.kind === 'monitor' ? 'Columns of the table' : 'Channels'} of ${name}`),
    element('p', { class: 'actions' }, edit, records.slice(0, 20).map((file) => element('a', { href: `#/record/${encodeURIComponent(file)}` }, `Record ${file}`))), panel.node);
  await panel.load();
  const close = () => panel.close();
  close.unsaved = () => panel.unsaved();
  return close;
};
