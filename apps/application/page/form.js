// A form of a case from its JSON Schema. Each control shows its unit, range and meaning; a fault is shown at its field.
import { attempt, button, element, svg } from './dom.js';
import { at, listOf, numberText, pointerOf, shownUnits, tableOf } from './schema.js';

const lazyFrom = 3; // lists this long show their items on request
const short = 4; // longest list on one line

// A drawing of a cross-section with these sizes in m, or null.
export const sectionDrawing = (section, label) => {
  const n = (key) => (typeof section[key] === 'number' && section[key] > 0 ? section[key] : undefined);
  const w = n('width'), h = n('height'), d = n('diameter') ?? n('outer_diameter');
  let path, box;
  const ring = (points) => `M${points.map((p) => p.join(' ')).join('L')}Z`;
  const rectangle = (a, b) => ring([[-a / 2, -b / 2], [a / 2, -b / 2], [a / 2, b / 2], [-a / 2, b / 2]]);
  const circle = (r) => `M${-r} 0A${r} ${r} 0 1 0 ${r} 0A${r} ${r} 0 1 0 ${-r} 0Z`;
  if (section.shape === 'rectangle' && w && h) [path, box] = [rectangle(w, h), [w, h]];
  if (section.shape === 'circle' && d) [path, box] = [circle(d / 2), [d, d]];
  if (section.shape === 'tube' && d && n('thickness')) [path, box] = [circle(d / 2) + circle(Math.max(d / 2 - n('thickness'), 0)), [d, d]];
  if (section.shape === 'box' && w && h && n('thickness'))
    [path, box] = [rectangle(w, h) + rectangle(Math.max(w - 2 * n('thickness'), 0), Math.max(h - 2 * n('thickness'), 0)), [w, h]];
  if (section.shape === 'i' && w && h && n('flange_thickness') && n('web_thickness')) {
    const f = n('flange_thickness'), t = n('web_thickness') / 2;
    path = ring([[-w / 2, -h / 2], [w / 2, -h / 2], [w / 2, -h / 2 + f], [t, -h / 2 + f], [t, h / 2 - f], [w / 2, h / 2 - f],
      [w / 2, h / 2], [-w / 2, h / 2], [-w / 2, h / 2 - f], [-t, h / 2 - f], [-t, -h / 2 + f], [-w / 2, -h / 2 + f]]);
    box = [w, h];
  }
  const regions = section.regions_of_file ?? (Array.isArray(section.outline) && section.outline.length > 2 ? [{ outline: section.outline, holes: section.holes }] : []);
  if (section.shape === 'polygon' && regions.length) {
    const all = regions.flatMap((region) => region.outline);
    const low = [0, 1].map((k) => Math.min(...all.map((p) => p[k]))), high = [0, 1].map((k) => Math.max(...all.map((p) => p[k])));
    const shifted = (points) => ring(points.map((p) => [p[0] - (low[0] + high[0]) / 2, -(p[1] - (low[1] + high[1]) / 2)]));
    path = regions.map((region) => shifted(region.outline) + (region.holes ?? []).map(shifted).join('')).join('');
    box = [high[0] - low[0], high[1] - low[1]];
  }
  if (!path || path.includes('NaN')) return null;
  const size = 1.15 * Math.max(...box);
  return svg('svg', { class: 'section', viewBox: [-size / 2, -size / 2, size, size].join(' '), role: 'img', 'aria-label': label },
    svg('path', { d: path, 'fill-rule': 'evenodd' }));
};

const examples = {
  rectangle: { shape: 'rectangle', width: 3, height: 4 }, circle: { shape: 'circle', diameter: 4 },
  tube: { shape: 'tube', outer_diameter: 4, thickness: 0.6 }, box: { shape: 'box', width: 3, height: 4, thickness: 0.5 },
  i: { shape: 'i', width: 3, height: 4, flange_thickness: 0.6, web_thickness: 0.5 },
  polygon: { shape: 'polygon', outline: [[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]] },
};

export class Form {
  // `changed(structural)` is called after each edit of `doc`; `choices(path)` gives names for a text, or none.
  // `drawings.read(file, unit)` gives the regions of a drawing, `drawings.store(file, text)` stores one beside the case.
  constructor(place, { changed, choices, drawings }) {
    this.drawings = drawings;
    this.place = place;
    this.changed = changed;
    this.choices = choices;
    this.opened = new Set();
    this.displayUnits = false;
  }

  show(rules, doc) {
    this.rules = rules;
    this.doc = doc;
    const focus = document.activeElement?.id;
    const inside = this.place.contains(document.activeElement);
    this.place.replaceChildren(...this.keys(rules.root, doc, []));
    if (inside && focus) document.getElementById(focus)?.focus({ preventScroll: true });
    if (this.fault) this.mark(this.fault);
  }

  set(path, value, structural = false) {
    const parent = at(this.doc, path.slice(0, -1));
    parent[path.at(-1)] = value;
    this.edited = pointerOf(path);
    this.done(structural);
  }

  remove(path) {
    const parent = at(this.doc, path.slice(0, -1));
    if (Array.isArray(parent)) parent.splice(path.at(-1), 1);
    else delete parent[path.at(-1)];
    this.done(true);
  }

  done(structural) {
    this.changed(structural);
    if (structural) this.show(this.rules, this.doc);
  }

  // The fields of an object's keys.
  keys(rule, value, path) {
    const found = this.rules.resolve(rule), own = found.properties ?? {};
    const required = found.required ?? [];
    const nodes = [];
    const order = [...required.filter((key) => !(key in value)), ...Object.keys(value)];
    for (const key of order) {
      if (path.length === 0 && key === '$schema') continue;
      if (!(key in value)) {
        nodes.push(element('div', { class: 'field missing', 'data-pointer': pointerOf([...path, key]) },
          button(`Add ${key}`, () => this.set([...path, key], this.rules.initial(own[key]), true), { id: `f:${pointerOf([...path, key])}` }),
          element('small', {}, `needed: ${this.rules.resolve(own[key]).description ?? ''}`)));
        continue;
      }
      const rest = key in own ? own[key] : typeof found.additionalProperties === 'object' ? found.additionalProperties : {};
      nodes.push(this.field(rest, value[key], [...path, key], { name: key, optional: !required.includes(key), renamed: !(key in own) }));
    }
    const free = Object.keys(own).filter((key) => !(key in value) && !required.includes(key) && key !== '$schema');
    if (free.length) {
      const choice = element('select', { 'aria-label': `Add a key to ${path.at(-1) ?? 'the case'}`, id: `f:${pointerOf(path)}/+`, class: 'adder',
        onchange: () => {
          const key = choice.value;
          if (key) this.set([...path, key], this.rules.initial(own[key]), true);
          document.getElementById(`f:${pointerOf([...path, key])}`)?.focus();
        } },
      element('option', { value: '' }, '+ add …'),
      free.map((key) => element('option', { value: key, title: this.rules.resolve(own[key]).description ?? '' }, key)));
      nodes.push(element('div', { class: 'add' }, choice));
    }
    if (typeof found.additionalProperties === 'object') {
      nodes.push(element('div', { class: 'add' }, button('+ add a name', () => {
        let i = Object.keys(value).length + 1;
        while (`new ${i}` in value) i += 1;
        const model = Object.values(value).at(-1);
        this.set([...path, `new ${i}`], model === undefined ? this.rules.initial(found.additionalProperties) : structuredClone(model), true);
      }, { class: 'plain' })));
    }
    return nodes;
  }

  // One value with its name, help and message.
  field(rule, value, path, { name, optional, renamed }) {
    const found = this.rules.resolve(rule), pointer = pointerOf(path), id = `f:${pointer}`;
    const fixed = path.length === 1 && path[0] === 'kind';
    const inner = fixed ? { node: element('code', { id }, String(value)) } : this.control(rule, value, path, id);
    const help = this.rules.isPrior(rule) ? '' : found.description ?? '';
    const range = this.rules.range(rule);
    const tools = [
      renamed && button('rename', () => this.rename(path), { class: 'plain', 'aria-label': `Rename ${name}` }),
      optional && !fixed && button('×', () => this.remove(path), { class: 'plain cross', 'aria-label': `Remove ${name}`, title: 'Remove' }),
    ];
    const hint = element('small', { id: `h:${pointer}`, class: 'help' }, help + (range ? ` (${range})` : ''));
    const message = element('p', { class: 'fault', id: `m:${pointer}`, hidden: true });
    if (inner.block) {
      return element('fieldset', { class: 'field group', 'data-pointer': pointer },
        element('legend', {}, element('span', {}, String(name)), tools), hint, message, inner.node);
    }
    inner.node.setAttribute?.('aria-describedby', `h:${pointer} m:${pointer}`);
    return element('div', { class: 'field', 'data-pointer': pointer },
      element('div', { class: 'row' }, element('label', { for: id }, String(name)), inner.node, inner.unit ?? null, tools), hint, message);
  }

  rename(path) {
    const parent = at(this.doc, path.slice(0, -1)), old = path.at(-1);
    const wanted = prompt(`A new name for ${old}:`, old)?.trim();
    if (!wanted || wanted === old || wanted in parent) return;
    const entries = Object.entries(parent);
    for (const key of Object.keys(parent)) delete parent[key];
    for (const [key, item] of entries) parent[key === old ? wanted : key] = item;
    this.done(true);
  }

  control(rule, value, path, id) {
    const found = this.rules.resolve(rule);
    if (this.rules.isPrior(rule)) return { node: this.prior(value, path, id), block: true };
    if (found.anyOf) return this.alternatives(found, value, path, id);
    if (found.enum && found.enum.includes(value)) return this.choice(found, value, path, id);
    if (typeof value === 'boolean') {
      return { node: element('input', { type: 'checkbox', id, checked: value, onchange: (event) => this.set(path, event.target.checked) }) };
    }
    if (Array.isArray(value)) return this.shortList(found, value, path, id) ?? { node: this.list(found, value, path, id), block: true };
    if (value && typeof value === 'object') {
      const keys = this.keys(found, value, path);
      const drawing = !found.properties?.shape ? null : value.shape === 'polygon' ? this.outline(value, path, id) : sectionDrawing(value, `Cross-section: ${value.shape}`);
      return { node: element('div', { class: 'keys', id, tabindex: -1 }, drawing, keys), block: true };
    }
    return this.scalar(rule, value, path, id);
  }

  // The picture of an outline, and a button that takes it from a drawing.
  outline(section, path, id) {
    const picture = element('span', {}, sectionDrawing(section, 'Cross-section: polygon'));
    if (typeof section.file === 'string' && section.file) {
      this.drawings.read(section.file, section.unit).then((regions) => {
        const drawn = sectionDrawing({ shape: 'polygon', regions_of_file: regions }, `Cross-section of ${section.file}`);
        if (drawn) picture.replaceChildren(drawn);
      }, () => { /* the check of the case names the fault */ });
    }
    const input = element('input', { type: 'file', accept: '.dxf', hidden: true, id: `${id}^`, 'aria-label': 'Drawing in the format DXF', onchange: () => attempt(async () => {
      const [file] = input.files;
      if (!file) return;
      const stored = await this.drawings.store(file.name, await file.text());
      const now = at(this.doc, path);
      for (const key of ['outline', 'holes', 'unit']) delete now[key];
      this.set([...path, 'file'], stored, true);
    }) });
    return element('div', { class: 'outline' }, picture, input, button('Import a drawing (DXF) …', () => { input.value = ''; input.click(); }));
  }

  // A number or a text. A text that is not a number remains a text if the schema allows names.
  scalar(rule, value, path, id) {
    const types = this.rules.types(rule);
    const numeric = types.includes('number') || types.includes('integer');
    const unit = this.rules.unit(rule);
    const shown = this.displayUnits && shownUnits[unit];
    const factor = shown ? shown[1] : 1;
    const text = typeof value === 'number' ? numberText(Number((value * factor).toPrecision(15))) : value === null ? '' : String(value);
    const names = typeof value === 'string' || types.includes('string') ? this.choices(path) : undefined;
    const list = names?.length ? element('datalist', { id: `${id}?` }, names.map((name) => element('option', { value: name }))) : null;
    const input = element('input', { id, value: text, inputmode: numeric && !types.includes('string') ? 'decimal' : undefined,
      list: list ? `${id}?` : undefined, autocomplete: 'off', spellcheck: 'false', class: numeric ? 'number' : 'text',
      oninput: () => {
        const bare = input.value.trim(), x = Number(bare.replace(',', '.'));
        if (numeric && bare !== '' && Number.isFinite(x)) this.set(path, Number((x / factor).toPrecision(15)));
        else this.set(path, bare === '' && types.includes('null') ? null : input.value);
      } });
    return { node: input, unit: element('span', { class: 'unit' }, shown ? shown[0] : unit, list) };
  }

  choice(found, value, path, id) {
    if (found.enum.includes('rectangle')) {
      const node = element('span', { class: 'shapes', role: 'radiogroup', id, tabindex: -1, 'aria-label': 'Shape' }, found.enum.map((shape) =>
        element('label', { title: shape }, element('input', { type: 'radio', name: id, value: shape, checked: shape === value,
          onchange: () => this.reshape(path, shape) }), sectionDrawing(examples[shape] ?? {}, shape), element('span', {}, shape))));
      return { node };
    }
    const node = element('select', { id, onchange: () => this.set(path, found.enum[node.selectedIndex], true) },
      found.enum.map((one) => element('option', { selected: one === value }, String(one))));
    return { node };
  }

  // Changes the shape of a section; keeps the dimensions that both shapes have.
  reshape(path, shape) {
    const section = at(this.doc, path.slice(0, -1));
    const size = section.width ?? section.diameter ?? section.outer_diameter ?? 0.1;
    const kept = Object.fromEntries(Object.entries(section).filter(([key]) => !(key in examples.i || ['diameter', 'outer_diameter', 'thickness', 'outline', 'holes', 'file', 'unit', 'regions'].includes(key))));
    const made = { ...structuredClone(examples[shape]) };
    const scale = typeof size === 'number' ? size / 4 : 0.025;
    for (const key of Object.keys(made)) {
      if (key in section) made[key] = section[key];
      else if (typeof made[key] === 'number') made[key] = Number((made[key] * scale).toPrecision(4));
    }
    if (made.outline && !section.outline) made.outline = made.outline.map((p) => p.map((x) => Number((x * scale).toPrecision(4))));
    for (const key of Object.keys(section)) delete section[key];
    Object.assign(section, made, kept, { shape });
    this.done(true);
  }

  alternatives(found, value, path, id) {
    const fits = found.anyOf.map((one) => this.rules.fit(one, value));
    const best = fits.indexOf(Math.max(...fits));
    const inner = this.control(found.anyOf[best], value, path, `${id}`);
    if (found.anyOf.length < 2) return inner;
    const picker = element('select', { class: 'form', 'aria-label': `Form of ${path.at(-1)}`, id: `${id}|`, onchange: () => {
      const chosen = found.anyOf[picker.selectedIndex];
      this.set(path, this.rules.fit(chosen, value) > 1 ? value : this.converted(value, chosen), true);
    } }, found.anyOf.map((one, i) => element('option', { selected: i === best }, this.rules.label(one))));
    if (inner.block) return { node: element('div', {}, picker, inner.node), block: true };
    return { node: inner.node, unit: element('span', {}, inner.unit ?? '', picker) };
  }

  converted(value, rule) {
    const type = this.rules.types(rule)[0];
    if (type === 'array' && !Array.isArray(value) && value && typeof value === 'object') return [value];
    if (type === 'object' && Array.isArray(value) && value[0] && typeof value[0] === 'object') return value[0];
    return this.rules.initial(rule);
  }

  prior(value, path, id) {
    const families = { uniform: ['lowest', 'highest'], log_uniform: ['lowest', 'highest'], normal: ['mean', 'standard deviation'],
      log_normal: ['mean of the logarithm', 'sd of the logarithm'], half_normal: ['standard deviation'], gamma: ['shape', 'scale'],
      inverse_gamma: ['shape', 'scale'], beta: ['a', 'b'], truncated_normal: ['mean', 'standard deviation', 'lowest', 'highest'],
      student_t: ['degrees of freedom', 'location', 'scale'] };
    const family = Object.keys(value).find((key) => key in families);
    if (!family) return element('div', { class: 'keys', id, tabindex: -1 }, this.keys(this.rules.root.definitions.prior, value, path));
    const numbers = [value[family]].flat();
    const write = (list, to = family) => {
      const { on } = value;
      for (const key of Object.keys(value)) delete value[key];
      value[to] = to === 'half_normal' ? list[0] : list;
      if (to === 'beta' && on) value.on = on;
    };
    const picker = element('select', { id, 'aria-label': `Prior of ${path.at(-1)}`, onchange: () => {
      const start = { uniform: [0, 1], log_uniform: [0.1, 10], normal: [0, 1], log_normal: [0, 1], half_normal: [1], gamma: [2, 1],
        inverse_gamma: [3, 1], beta: [1, 1], truncated_normal: [0, 1, -2, 2], student_t: [4, 0, 1] };
      write(families[picker.value].length === numbers.length ? numbers : start[picker.value], picker.value);
      this.done(true);
    } }, Object.keys(families).map((name) => element('option', { selected: name === family, value: name }, name.replace('_', ' '))));
    const inputs = families[family].map((label, i) => element('label', { class: 'inline' }, element('span', {}, label),
      element('input', { class: 'number', inputmode: 'decimal', id: `${id}/${i}`, value: String(numbers[i] ?? ''), oninput: (event) => {
        const x = Number(event.target.value.trim().replace(',', '.'));
        numbers[i] = event.target.value.trim() !== '' && Number.isFinite(x) ? x : event.target.value;
        write(numbers);
        this.edited = `${pointerOf(path)}/${i}`;
        this.done(false);
      } })));
    return element('div', { class: 'prior' }, picker, inputs);
  }

  // A list of few numbers or names, on one line; null for other lists.
  shortList(found, value, path, id) {
    const types = this.rules.types(found.items ?? {}), numeric = types.includes('number') || types.includes('integer');
    if (!(found.maxItems <= short) || value.some((x) => x !== null && typeof x === 'object')) return null;
    if (numeric && value.every((x) => typeof x === 'number')) {
      const input = element('input', { id, class: 'text', inputmode: 'decimal', value: value.join(', '), spellcheck: 'false', oninput: () => {
        const read = listOf(input.value);
        if (read) this.set(path, read);
      } });
      return { node: input, unit: element('span', { class: 'unit' }, this.rules.unit(found.items ?? {})) };
    }
    if (this.rules.resolve(found.items ?? {}).enum || !types.includes('string') || found.minItems !== found.maxItems) return null;
    const inputs = value.map((item, i) => {
      const own = [...path, i], list = this.choices(own) ?? [], name = i ? `${id}/${i}` : id;
      return element('span', {}, element('input', { id: name, class: 'short', value: String(item), list: `${name}?`, 'aria-label': `${path.at(-1)} ${i + 1}`,
        autocomplete: 'off', oninput: (event) => this.set(own, event.target.value) }), element('datalist', { id: `${name}?` }, list.map((one) => element('option', { value: one }))));
    });
    return { node: element('span', { class: 'checks' }, inputs) };
  }

  list(found, value, path, id) {
    const items = found.items ?? {}, itemTypes = this.rules.types(items);
    const scalar = (x) => x === null || typeof x !== 'object';
    const isNumbers = value.every((x) => x === null || typeof x === 'number') && (itemTypes.includes('number') || itemTypes.includes('integer') || (value.length && !itemTypes.length));
    if (isNumbers) return this.numbers(value, path, id, false);
    const inner = this.rules.resolve(this.rules.resolve(items).items ?? {});
    const isMatrix = value.every((row) => Array.isArray(row) && row.every((x) => x === null || typeof x === 'number')) && this.rules.types(inner).some((t) => t === 'number' || t === 'integer');
    if (isMatrix && itemTypes[0] === 'array') return this.numbers(value, path, id, true);
    if (value.length && value.every(scalar) && this.rules.resolve(items).enum) {
      const all = this.rules.resolve(items).enum;
      return element('div', { class: 'checks', id, tabindex: -1 }, all.map((one) => element('label', {}, element('input', { type: 'checkbox',
        checked: value.includes(one), onchange: (event) => this.set(path, all.filter((x) => (x === one ? event.target.checked : value.includes(x))), true) }), String(one))));
    }
    const fold = value.length >= lazyFrom && value.some((x) => !scalar(x));
    const nodes = value.map((item, i) => {
      const own = [...path, i], column = Number.isInteger(item?.column) ? `column ${item.column}` : item?.column, name = item?.name ?? column ?? item?.node ?? item?.kind;
      if (!fold) return this.field(items, item, own, { name: scalar(item) ? `${i + 1}` : `${i + 1}${name ? `: ${name}` : ''}`, optional: true });
      const pointer = pointerOf(own);
      const details = element('details', { 'data-pointer': pointer, open: this.opened.has(pointer) },
        element('summary', {}, `${i + 1}${name ? `: ${name}` : ''}`));
      const fill = () => {
        if (details.open && details.children.length === 1) details.append(this.field(items, item, own, { name: `${i + 1}`, optional: true }));
        if (details.open) this.opened.add(pointer); else this.opened.delete(pointer);
      };
      details.addEventListener('toggle', fill);
      if (details.open) fill();
      return details;
    });
    const add = button('+ add an item', () => {
      value.push(value.length ? structuredClone(value.at(-1)) : this.rules.initial(items));
      this.opened.add(pointerOf([...path, value.length - 1]));
      this.done(true);
    }, { class: 'plain' });
    return element('div', { class: 'items', id, tabindex: -1 }, nodes, element('div', { class: 'add' }, add));
  }

  // Numbers as text: typed, or pasted from a spreadsheet.
  numbers(value, path, id, matrix) {
    const text = matrix ? value.map((row) => row.map((x) => x ?? '-').join(', ')).join('\n') : value.map((x) => x ?? '-').join(', ');
    const count = element('small', { class: 'count' }, matrix ? `${value.length} rows` : `${value.length} numbers`);
    const area = element('textarea', { id, rows: matrix ? Math.min(8, value.length + 1) : Math.min(4, 1 + Math.floor(text.length / 60)), spellcheck: 'false', 'aria-label': path.at(-1),
      title: 'Type numbers, or paste cells of a spreadsheet. Type - for a value that was not measured.', oninput: () => {
        const read = matrix ? tableOf(area.value) : listOf(area.value);
        const bad = !read || (matrix && read.some((row) => row.includes(undefined)));
        area.rows = Math.max(area.rows, Math.min(8, area.value.split('\n').length)); // lines that were pasted
        count.textContent = bad ? 'some entries are not numbers' : matrix ? `${read.length} rows` : `${read.length} numbers`;
        if (!bad) this.set(path, read);
      } });
    area.value = text;
    return element('div', { class: 'numbers' }, area, count);
  }

  // Shows a fault at its field, or at the nearest field above it. Null removes the fault.
  mark(fault) {
    this.fault = fault;
    for (const old of this.place.querySelectorAll('.fault:not([hidden])')) { old.hidden = true; old.textContent = ''; }
    for (const old of this.place.querySelectorAll('[aria-invalid]')) old.removeAttribute('aria-invalid');
    if (!fault) return;
    const place = this.nearest(fault.pointer);
    if (!place) return;
    const message = place.querySelector(':scope > .fault') ?? place.querySelector('.fault');
    if (message) {
      message.hidden = false;
      message.textContent = (place.dataset.pointer === fault.pointer ? '' : `${fault.pointer}: `) + fault.reason;
    }
    place.querySelector('input, select, textarea')?.setAttribute('aria-invalid', 'true');
  }

  nearest(pointer) {
    for (let part = pointer; part && part !== '/'; part = part.slice(0, part.lastIndexOf('/'))) {
      const found = this.place.querySelector(`[data-pointer="${CSS.escape(part)}"]`);
      if (found?.tagName === 'DETAILS' && !found.open) {
        found.open = true;
        this.opened.add(part);
        this.show(this.rules, this.doc);
        return this.nearest(pointer);
      }
      if (found) return found;
    }
    return null;
  }

  // Moves to the field of a location in the case.
  go(pointer) {
    const place = this.nearest(pointer);
    if (!place) return;
    place.scrollIntoView({ block: 'center' });
    place.querySelector('input, select, textarea, button')?.focus({ preventScroll: true });
  }
}
