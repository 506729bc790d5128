// The editor of a case: form, drawing and JSON text of one document, checked by the program while it is edited.
import { attempt, button, element, say } from './dom.js';
import { Drawing } from './drawing.js';
import { exporting } from './export.js';
import { Form } from './form.js';
import { folderOf, relative } from './modes_case.js';
import { copyCase } from './projects.js';
import { at, Rules, written } from './schema.js';
import { channelLists, namedStructure } from './sensors.js';
import { follow, runList, start } from './runs.js';
import { get, post, schema } from './server.js';

const pause = 250; // ms between the last key and a check

const ruleName = (doc) => (doc.kind === 'damage' && doc.structure ? 'structure' : doc.kind);

export const editorView = async (place, name) => {
  const [opened, projects] = await Promise.all([get('case', { name }), get('projects')]);
  let version = opened.version, saved = opened.text, text = opened.text, doc, rules, timer, checking = false, again = false, valid = false;
  const undone = [], redone = [];

  const status = element('p', { class: 'status', role: 'status', 'aria-live': 'polite' });
  const area = element('textarea', { class: 'code', spellcheck: 'false', 'aria-label': 'The case as JSON', rows: 24 });
  const formPlace = element('div', { class: 'form' }), drawingPlace = element('div', { class: 'drawing' });
  const list = runList(name);

  // Names to which a text of the case may refer.
  const choices = (path) => {
    const key = path.at(-1), up = path.at(-2), s = doc.structure ?? {};
    if (key === 'material') return Object.keys(s.materials ?? {});
    if (key === 'section') return Object.keys(s.sections ?? {});
    if (key === 'node' || up === 'nodes') return Object.keys(s.nodes ?? doc.geometry?.nodes ?? {});
    if (key === 'member') return (s.members ?? []).map((m) => m.name).filter(Boolean);
    if (key === 'file' && at(doc, path.slice(0, -1))?.shape) return projects.drawings.map((one) => relative(folderOf(name), one.name));
    if (key === 'file') return projects.records.map((one) => one.name.slice(one.name.lastIndexOf('/') + 1));
    return Object.keys(doc.parameters ?? {});
  };

  const drawings = {
    read: async (file, unit) => (await get('outline', { name, file, ...(unit ? { unit } : {}) })).regions,
    store: async (file, content) => {
      const stored = (await post('drawing', { case: name, file, text: content })).file;
      projects.drawings = (await get('projects')).drawings;
      return stored;
    },
  };
  const form = new Form(formPlace, { changed: (structural) => edited({ from: 'form', structural }), choices, drawings });
  const drawing = new Drawing(drawingPlace, { changed: () => edited({ from: 'drawing' }), chosen: (pointer) => form.go(pointer) });
  const structures = new Map(); // of the cases that the key geometry names
  const draw = () => {
    const wanted = typeof doc.geometry === 'string' ? doc.geometry : null;
    drawing.show(doc, structures.get(wanted) ?? null);
    if (!wanted || structures.has(wanted)) return;
    structures.set(wanted, null);
    namedStructure(name, wanted).then((found) => {
      structures.set(wanted, found);
      if (found && doc.geometry === wanted) draw();
    });
  };

  const buttons = {
    save: button('Save', () => save(), { class: 'main' }), undo: button('Undo', () => step(undone, redone)), redo: button('Redo', () => step(redone, undone)),
    run: button('Run', () => run({})), quick: button('Quick run', () => run({ quick: true })), resume: button('Continue', () => run({ resume: true })),
  };
  const seed = element('input', { class: 'number seed', inputmode: 'numeric', value: '1', 'aria-label': 'Seed' });
  const seeding = element('label', { class: 'inline' }, 'Seed ', seed);
  const refresh = () => {
    buttons.quick.hidden = seeding.hidden = !projects.sampled.includes(doc?.kind);
    buttons.save.disabled = text === saved;
    buttons.undo.disabled = !undone.length;
    buttons.redo.disabled = !redone.length;
    document.title = `${text === saved ? '' : '• '}${name} · Wheeltap`;
    const channels = document.getElementById('channels');
    channels?.toggleAttribute('hidden', !channelLists(doc).length);
    if (channels) channels.textContent = doc?.kind === 'monitor' ? 'Columns of the table' : 'Channels on the structure';
  };

  const showDoc = async (skip) => {
    const wanted = ruleName(doc);
    if (!projects.kinds.includes(doc.kind)) {
      formPlace.replaceChildren(element('p', { class: 'fault' }, `kind must be one of ${projects.kinds.join(', ')}: correct the key kind in the JSON text.`));
      rules = undefined;
    } else {
      if (!rules || rules.name !== wanted) {
        rules = new Rules(await schema(wanted));
        rules.name = wanted;
      }
      if (skip !== 'form') form.show(rules, doc);
    }
    if (skip !== 'drawing') draw();
  };

  // Called after an edit of `doc` by the form or the drawing.
  const edited = ({ from, structural = false }) => {
    remember(from === 'form' && !structural ? form.edited : null);
    text = `${written(doc)}\n`;
    area.value = text;
    if (from === 'form') {
      draw();
      if (rules && ruleName(doc) !== rules.name) showDoc();
    } else form.show(rules, doc);
    if (structural) clearTimeout(timer);
    schedule();
    refresh();
  };

  // Keys typed in one field in quick succession are one undo step; `typedAt` is null for other edits.
  let lastPlace = null, lastTime = 0;
  const remember = (typedAt) => {
    const now = Date.now(), same = typedAt !== null && typedAt === lastPlace && now - lastTime < 1000;
    if (undone.at(-1) !== text && !(same && undone.length)) undone.push(text);
    [lastPlace, lastTime] = [typedAt, now];
    if (undone.length > 300) undone.shift();
    redone.length = 0;
  };

  const take = async (next, skip) => {
    text = next;
    if (skip !== 'json') area.value = text;
    let parsed;
    try {
      parsed = JSON.parse(text);
    } catch { /* the check names line and column */ }
    if (parsed && typeof parsed === 'object' && !Array.isArray(parsed)) {
      doc = parsed;
      await showDoc();
    } else if (!doc) formPlace.replaceChildren(element('p', { class: 'empty' }, 'The form appears when the JSON text is valid.'));
    schedule();
    refresh();
  };

  const step = (from, to) => {
    if (!from.length) return;
    to.push(text);
    lastPlace = null;
    take(from.pop());
  };

  area.addEventListener('input', () => {
    remember('JSON');
    take(area.value, 'json');
  });

  const schedule = () => {
    clearTimeout(timer);
    status.className = 'status checking';
    timer = setTimeout(check, pause);
  };

  const check = async () => {
    if (checking) { again = true; return; }
    checking = true;
    const asked = text;
    try {
      const answer = await post('check', { name, text: asked });
      if (asked === text) {
        valid = answer.valid;
        status.className = `status ${valid ? 'good' : 'bad'}`;
        status.replaceChildren(...(valid ? ['Valid: the case can run.'] : [answer.pointer === '/' ? '' : button(answer.pointer, () => form.go(answer.pointer), { class: 'plain', 'aria-label': `Go to ${answer.pointer}` }), ` ${answer.reason}`]));
        form.mark(valid ? null : answer);
      }
    } catch (error) {
      status.className = 'status bad';
      status.textContent = error.message;
    }
    checking = false;
    if (again) { again = false; check(); }
  };

  const save = () => attempt(async () => {
    const now = text;
    const answer = await post('save', { name, text: now, before: version });
    version = answer.version;
    saved = now;
    refresh();
    say('Saved.');
    return true;
  });

  const run = (options) => attempt(async () => {
    if (!doc) throw new Error('The case is not valid JSON: correct it in the JSON text.');
    if (text !== saved && !(await save())) return;
    const number = Number(seed.value);
    if (projects.sampled.includes(doc.kind) && seed.value.trim() !== '') {
      if (!Number.isInteger(number) || number < 0) throw new Error('The seed must be a whole number from 0.');
      options = { ...options, seed: number };
    }
    await start(name, options);
  });

  const units = element('input', { type: 'checkbox', onchange: () => { form.displayUnits = units.checked; if (rules) form.show(rules, doc); } });
  const help = element('input', { type: 'checkbox', checked: true, onchange: () => formPlace.classList.toggle('brief', !help.checked) });
  place.replaceChildren(
    element('div', { class: 'toolbar' }, element('h1', {}, name),
      element('div', { class: 'buttons' }, buttons.save, buttons.undo, buttons.redo, buttons.run,
        buttons.quick, buttons.resume, seeding,
        button('Copy …', () => copyCase(name)), element('a', { href: `#/result/${encodeURIComponent(opened.result)}`, id: 'results', hidden: true }, 'Results'),
        element('a', { href: `#/channels/${encodeURIComponent(name)}`, id: 'channels', hidden: true }, 'Channels on the structure'),
        element('a', { href: `#/poles/${encodeURIComponent(name)}`, id: 'choose', hidden: true }, 'Choose poles')),
      status),
    element('div', { class: 'panes' },
      element('section', { class: 'pane', 'aria-label': 'Form' }, element('div', { class: 'head' }, element('h2', {}, 'Form'), element('label', { class: 'inline' }, units, ' mm, kN, GPa'), element('label', { class: 'inline' }, help, ' Help texts')), formPlace),
      element('div', { class: 'side' },
        element('section', { class: 'pane', 'aria-label': 'Drawing' }, element('h2', {}, 'Structure'), drawingPlace,
          element('p', { class: 'tools' }, exporting.figureButtons(`Structure of ${name}`, () => {
            const picture = drawingPlace.querySelector('svg');
            if (!picture) throw new Error('There is no drawing.');
            return exporting.svgOf(picture);
          }))),
        element('section', { class: 'pane', 'aria-label': 'Runs' }, element('h2', {}, 'Runs of this case'), list.place),
        element('section', { class: 'pane', 'aria-label': 'JSON' }, element('h2', {}, 'JSON'), area))));
  await take(text);
  refresh();

  const showState = async () => {
    const now = (await get('projects')).cases.find((one) => one.name === name);
    document.getElementById('results')?.toggleAttribute('hidden', !now?.result);
    document.getElementById('choose')?.toggleAttribute('hidden', !(now?.result && now.kind === 'modal'));
    buttons.resume.hidden = now?.state !== 'interrupted' || !projects.sampled.includes(now.kind);
  };
  await attempt(showState);
  const stop = follow((ignored, ended) => { if (ended.some((one) => one.case === name)) attempt(showState); });

  const keys = (event) => {
    if (!(event.ctrlKey || event.metaKey)) return;
    const key = event.key.toLowerCase();
    if (key === 's') save();
    else if (key === 'z' && event.target !== area) step(...(event.shiftKey ? [redone, undone] : [undone, redone]));
    else if (key === 'y' && event.target !== area) step(redone, undone);
    else return;
    event.preventDefault();
  };
  const leaving = (event) => { if (text !== saved) event.preventDefault(); };
  addEventListener('keydown', keys);
  addEventListener('beforeunload', leaving);
  const close = () => {
    clearTimeout(timer);
    stop();
    list.close();
    removeEventListener('keydown', keys);
    removeEventListener('beforeunload', leaving);
    document.title = 'Wheeltap';
  };
  close.unsaved = () => text !== saved;
  return close;
};
