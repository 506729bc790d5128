// Elements of the page. Texts become text nodes, never HTML.

const make = (node, attributes, children) => {
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
    else if (key === 'value' || key === 'checked' || key === 'disabled') node[key] = value;
    else node.setAttribute(key, value === true ? '' : value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return node;
};

export const element = (name, attributes = {}, ...children) =>
  make(document.createElement(name), attributes, children);

export const svg = (name, attributes = {}, ...children) =>
  make(document.createElementNS('http://www.w3.org/2000/svg', name), attributes, children);

export const button = (text, onclick, attributes = {}) =>
  element('button', { type: 'button', onclick, ...attributes }, text);

// A number with this many significant digits, without trailing zeros.
export const number = (x, digits = 4) => {
  if (x === null || x === undefined || !Number.isFinite(x)) return '–';
  return String(Number(x.toPrecision(digits)));
};

// The names that the report's scripts use.
export const charts = { number };

export const seconds = (s) => (s < 90 ? `${Math.round(s)} s` : s < 5400 ? `${Math.round(s / 60)} min` : `${number(s / 3600, 2)} h`);

// After the next frames; a hidden page has none, and waits a second.
export const painted = () => new Promise((done) => {
  setTimeout(done, 1000);
  requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 100)));
});

let fading;
export const say = (text, bad = false) => {
  const place = document.getElementById('message');
  clearTimeout(fading);
  place.textContent = text;
  place.hidden = !text;
  place.classList.toggle('bad', bad);
  if (text && !bad) fading = setTimeout(() => { place.hidden = true; }, 5000);
};

// Runs an action that the user did not start; a failure is shown, not thrown.
export const background = async (action) => {
  try {
    return await action();
  } catch (error) {
    say(error.message, true);
    return undefined;
  }
};

// Runs an action of the user, which removes the last message.
export const attempt = (action) => {
  say('');
  return background(action);
};

// A dialog with fields; resolves to their values, or to undefined if it is closed.
export const ask = (title, fields, verb) => new Promise((resolve) => {
  const inputs = fields.map((field) => field.control);
  const form = element('form', { method: 'dialog' }, element('h2', {}, title),
    fields.map((field) => element('label', { class: 'stacked' }, element('span', {}, field.label), field.control)),
    element('p', { class: 'buttons' }, element('button', { value: 'go', class: 'main' }, verb),
      element('button', { value: '', formnovalidate: true }, 'Cancel')));
  const dialog = element('dialog', { 'aria-label': title }, form);
  dialog.addEventListener('close', () => {
    resolve(dialog.returnValue === 'go' ? inputs.map((input) => input.value) : undefined);
    dialog.remove();
  });
  document.body.append(dialog);
  dialog.showModal();
});
