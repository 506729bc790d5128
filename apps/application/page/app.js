// The pages of the application; the part of the address after # selects the page.
import { channelsView } from './channels.js';
import { attempt, element } from './dom.js';
import { editorView } from './editor.js';
import { polesView } from './poles.js';
import { projectsView, resultView } from './projects.js';
import { recordView } from './record.js';

const views = { case: editorView, result: resultView, record: recordView, poles: polesView, channels: channelsView };
const words = { case: 'Case', result: 'Results', record: 'Record', poles: 'Poles', channels: 'Channels' };
const content = document.getElementById('content');
let close, shown = location.hash, turn = 0;

// The name in an address. A name with a percent sign that a user typed remains unchanged.
const decoded = (name) => {
  try {
    return decodeURIComponent(name);
  } catch {
    return name;
  }
};

const route = async () => {
  if (close?.unsaved?.() && location.hash !== shown && !confirm('Leave without saving the case?')) {
    history.replaceState(null, '', shown);
    return;
  }
  close?.();
  close = undefined;
  shown = location.hash;
  turn += 1;
  const mine = turn;
  const [, given = '', name = ''] = /^#\/([a-z]*)\/?(.*)$/.exec(shown) ?? [];
  const file = decoded(name), kind = file ? given : ''; // an address without a name shows the cases
  document.getElementById('place').replaceChildren(element('a', { href: '#/', 'aria-current': views[kind] ? undefined : 'page' }, 'Cases'),
    ...(views[kind] ? [element('span', { 'aria-current': 'page' }, `${words[kind]}: ${file}`)] : []));
  document.title = views[kind] ? `${file} · Wheeltap` : 'Wheeltap';
  content.replaceChildren(element('p', { class: 'quiet' }, 'Reading …'));
  const end = await attempt(() => (views[kind] ? views[kind](content, file) : projectsView(content)));
  if (mine !== turn) end?.();
  else close = end;
  if (end === undefined && content.textContent === 'Reading …') content.replaceChildren(element('h1', {}, file || 'Cases'), element('p', {}, element('a', { href: '#/' }, 'Back to the cases')));
  document.documentElement.dataset.ready = shown || '#/';
};

// The address names the page, so this link moves the focus itself.
document.querySelector('.skip').addEventListener('click', (event) => {
  event.preventDefault();
  content.focus();
});

addEventListener('hashchange', () => { delete document.documentElement.dataset.ready; route(); });
route();
