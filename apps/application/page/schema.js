// The rules of a JSON Schema in the form that the page needs, and the text of a case.

// Numbers as engineers write them: 210e9, 1e-6.
export const numberText = (x) => {
  const size = Math.abs(x);
  if (x !== 0 && (size >= 1e6 || size < 1e-4)) {
    const power = 3 * Math.floor(Math.log10(size) / 3);
    const text = `${Number((x / 10 ** power).toPrecision(15))}e${power}`;
    if (Number(text) === x) return text;
  }
  return JSON.stringify(x);
};

const inline = (value) => {
  if (typeof value === 'number') return numberText(value);
  if (Array.isArray(value)) return `[${value.map(inline).join(', ')}]`;
  if (value && typeof value === 'object')
    return `{${Object.entries(value).map(([key, item]) => `${JSON.stringify(key)}: ${inline(item)}`).join(', ')}}`;
  return JSON.stringify(value);
};

const longest = 100;

// JSON text with short lists and objects on one line.
export const written = (value, indent = '') => {
  const line = inline(value);
  if (!value || typeof value !== 'object') return line;
  if (indent && indent.length + line.length <= longest) return line;
  const inner = `${indent}  `;
  const items = Array.isArray(value) ? value.map((item) => inner + written(item, inner))
    : Object.entries(value).map(([key, item]) => `${inner}${JSON.stringify(key)}: ${written(item, inner)}`);
  if (!items.length) return line;
  const [open, close] = Array.isArray(value) ? '[]' : '{}';
  return `${open}\n${items.join(',\n')}\n${indent}${close}`;
};

// Numbers in a text that was typed or pasted from a spreadsheet: rows of cells. A dash, an empty cell and "null" are
// null. A comma is a decimal mark if tabs, semicolons or line breaks separate the cells.
export const tableOf = (text) => {
  const rows = text.trim().split(/\r?\n/);
  const tabs = /[\t;]/.test(text);
  const decimal = /\d,\d/.test(text) && !/\d\.\d/.test(text) && (tabs || (rows.length > 1 && rows.every((row) => !/,\s|,.*,/.test(row))));
  return rows.map((row) => {
    const cells = tabs ? row.split(/[\t;]/) : row.trim().split(decimal ? /\s+/ : /[\s,]+/);
    return cells.map((cell) => {
      const bare = cell.trim().replace(decimal ? ',' : '\u0000', '.');
      if (['', '-', '–', 'null', 'NaN'].includes(bare)) return null;
      const x = Number(bare);
      return Number.isFinite(x) ? x : undefined;
    });
  });
};

// One list of numbers; omits a first column that counts the rows. Undefined if a cell is not a number.
export const listOf = (text) => {
  if (!text.trim()) return [];
  let rows = tableOf(text);
  if (rows.length > 1 && rows[0].some((cell) => cell === undefined)) rows = rows.slice(1); // a heading
  if (rows.length > 1 && rows.every((row, i) => row.length === 2 && row[0] === i + 1)) rows = rows.map((row) => row.slice(1));
  const list = rows.flat();
  return list.includes(undefined) ? undefined : list;
};

const kindOf = (value) => (value === null ? 'null' : Array.isArray(value) ? 'array'
  : Number.isInteger(value) ? 'integer' : typeof value);

const units = [
  [/\bN m\/rad\b/, 'N m/rad'], [/\bN s\/m\b/, 'N s/m'], [/\bN\/m2\b/, 'N/m²'], [/\bN\/m\b/, 'N/m'], [/\bkg\/m3\b/, 'kg/m³'],
  [/\bkg m2\b/, 'kg m²'], [/^m4\b/, 'm⁴'], [/^m2\b/, 'm²'], [/\bin Pa\b/, 'Pa'], [/\bin Hz\b|^Hz\b/, 'Hz'], [/^kg\b/, 'kg'], [/^N,/, 'N'],
  [/^metres\b|\bin metres\b/, 'm'], [/\bin degrees\b/, '°'], [/\bdegrees Celsius\b/, '°C'], [/\bin seconds\b/, 's'],
];

// Units for display beside SI: factor from SI.
export const shownUnits = { m: ['mm', 1e3], Pa: ['GPa', 1e-9], N: ['kN', 1e-3], 'N/m': ['kN/m', 1e-3], 'N m/rad': ['kN m/rad', 1e-3] };

export class Rules {
  constructor(root) { this.root = root; }

  resolve(rule) {
    let at = rule;
    while (at && at.$ref) at = at.$ref.slice(2).split('/').reduce((node, key) => node[key], this.root);
    return at ?? {};
  }

  types(rule) {
    const found = this.resolve(rule);
    if (found.type) return [found.type].flat();
    if (found.enum) return [...new Set(found.enum.map(kindOf))];
    if (found.properties || found.additionalProperties) return ['object'];
    if (found.items) return ['array'];
    return [];
  }

  isPrior(rule) { return this.resolve(rule) === this.root.definitions?.prior; }

  unit(rule) {
    const text = this.resolve(rule).description ?? '';
    return units.find(([pattern]) => pattern.test(text))?.[1] ?? '';
  }

  range(rule) {
    const { minimum, exclusiveMinimum, maximum, exclusiveMaximum } = this.resolve(rule);
    const parts = [];
    if (minimum !== undefined) parts.push(`≥ ${inline(minimum)}`);
    if (exclusiveMinimum !== undefined) parts.push(`> ${inline(exclusiveMinimum)}`);
    if (maximum !== undefined && Math.abs(maximum) < 2147483647) parts.push(`≤ ${inline(maximum)}`);
    if (exclusiveMaximum !== undefined) parts.push(`< ${inline(exclusiveMaximum)}`);
    return parts.join(', ');
  }

  // How well a value agrees with a rule: 0 for another type; larger if more of its keys are allowed.
  fit(rule, value) {
    const found = this.resolve(rule);
    if (found.anyOf) return Math.max(...found.anyOf.map((one) => this.fit(one, value)));
    const types = this.types(rule), kind = kindOf(value);
    if (types.length && !types.includes(kind) && !(kind === 'integer' && types.includes('number'))) return 0;
    if (found.enum) return found.enum.includes(value) ? 3 : 0;
    if (kind === 'object') {
      const keys = Object.keys(value), own = found.properties ?? {};
      if ((found.required ?? []).some((key) => !(key in value))) return 1;
      const known = keys.filter((key) => key in own).length;
      return found.additionalProperties === false && known < keys.length ? 1 : 2 + known;
    }
    if (kind === 'array' && found.items && value.length) {
      const low = found.minItems > value.length || found.maxItems < value.length;
      return Math.min(...value.map((item) => this.fit(found.items, item))) > 0 ? (low ? 2 : 3) : 1;
    }
    return 2;
  }

  // An initial value.
  initial(rule) {
    const found = this.resolve(rule);
    if (found.examples) return structuredClone(found.examples[0]);
    if (found.enum) return found.enum[0];
    if (found.anyOf) return this.initial(found.anyOf[0]);
    const type = this.types(rule)[0];
    if (type === 'object') {
      return Object.fromEntries((found.required ?? []).map((key) => [key, this.initial(found.properties?.[key] ?? {})]));
    }
    if (type === 'array') return Array.from({ length: found.minItems ?? 0 }, () => this.initial(found.items ?? {}));
    if (type === 'boolean') return false;
    if (type === 'number' || type === 'integer') return found.minimum ?? (found.exclusiveMinimum >= 0 ? 1 : 0);
    if (type === 'string') return '';
    return null;
  }

  // A few words for one of several forms of a value.
  label(rule) {
    const found = this.resolve(rule);
    if (this.isPrior(rule)) return 'a prior';
    if (found.description && found.description.length < 60) return found.description;
    const type = this.types(rule)[0];
    if (found.enum) return found.enum.length > 2 ? 'one of several words' : found.enum.map((one) => JSON.stringify(one)).join(' or ');
    if (type === 'object' && found.required) return `an object with ${found.required.join(', ')}`;
    if (type === 'object' && found.properties) return `an object with ${Object.keys(found.properties).slice(0, 3).join(', ')}`;
    if (type === 'array') return `a list of ${this.types(found.items ?? {})[0] === 'array' ? 'lists' : `${this.types(found.items ?? {})[0] ?? 'value'}s`}`;
    return type === 'string' ? 'a string' : `a ${type ?? 'value'}`;
  }
}

export const pointerOf = (path) => path.map((key) => `/${String(key).replaceAll('~', '~0').replaceAll('/', '~1')}`).join('');
export const at = (json, path) => path.reduce((node, key) => node?.[key], json);
