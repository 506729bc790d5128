// Files from a page: figures as SVG and PNG, tables as CSV, and the page as a document for Word: a web page in one file
// (MHTML, RFC 2557), which Word opens with its figures.
const exporting = (() => {
  const make = (name, properties = {}, ...children) => {
    const node = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
      if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
      else node.setAttribute(key, value);
    }
    node.append(...children);
    return node;
  };
  const save = (name, content, type) => {
    const address = URL.createObjectURL(new Blob([content], { type }));
    const link = make('a', { href: address, download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 10000);
  };
  // A file name from a title.
  const named = (title, ending) => `${title.toLowerCase().replace(/[^\p{L}\p{N}]+/gu, '-').replace(/^-+|-+$/g, '').slice(0, 80) || 'wheeltap'}.${ending}`;

  // Rows of cells as CSV (RFC 4180). A spreadsheet would evaluate a text that begins like a formula.
  const csv = (rows) => rows.map((row) => row.map((cell) => {
    if (cell === null || cell === undefined) return '';
    if (typeof cell === 'number') return Number.isFinite(cell) ? String(cell) : '';
    const text = String(cell), safe = /^[=+\-@\t\r]/.test(text) && !Number.isFinite(Number(text)) ? `'${text}` : text;
    return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
  }).join(',')).join('\r\n') + '\r\n';
  // The cells of a table of the page; numbers with all digits where the page has them.
  const cellsOf = (table) => [...table.rows].map((row) => [...row.cells].map((cell) => (cell.dataset.value === undefined ? cell.textContent.trim() : Number(cell.dataset.value))));
  // The byte order mark tells a spreadsheet that the text is UTF-8.
  const saveCsv = (title, rows) => save(named(title, 'csv'), `\uFEFF${csv(rows)}`, 'text/csv;charset=utf-8');

  // Runs `work` with the page in its light colours.
  const inLight = (work) => {
    const root = document.documentElement, before = root.className;
    root.classList.add('light');
    try {
      return work();
    } finally {
      root.className = before;
    }
  };
  const styles = ['fill', 'fill-opacity', 'fill-rule', 'stroke', 'stroke-opacity', 'stroke-width', 'stroke-dasharray', 'stroke-linecap', 'stroke-linejoin',
    'vector-effect', 'opacity', 'visibility', 'display'];
  const textStyles = ['font-family', 'font-size', 'font-weight', 'font-style', 'text-anchor', 'dominant-baseline'];
  // A drawing of the page as a separate file, with the styles of the page, in light colours on white.
  const svgOf = (picture) => inLight(() => {
    const copy = picture.cloneNode(true), box = picture.viewBox.baseVal, seen = picture.getBoundingClientRect();
    const scale = box?.width ? Math.min(seen.width / box.width, seen.height / box.height) || 1 : 1; // as the page shows it
    const width = Math.round(box?.width ? scale * box.width : seen.width) || 640, height = Math.round(box?.width ? scale * box.height : seen.height) || 400;
    const originals = [picture, ...picture.querySelectorAll('*')], copies = [copy, ...copy.querySelectorAll('*')];
    originals.forEach((node, i) => {
      if (['title', 'desc', 'defs'].includes(node.tagName)) return;
      const style = getComputedStyle(node);
      for (const key of ['text', 'tspan'].includes(node.tagName) ? [...styles, ...textStyles] : styles) copies[i].setAttribute(key, style.getPropertyValue(key));
    });
    copies.forEach((node) => { for (const name of ['class', 'style', 'tabindex', 'role', 'data-node', 'data-member']) node.removeAttribute(name); });
    copy.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
    copy.setAttribute('width', width);
    copy.setAttribute('height', height);
    const paper = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
    for (const [key, value] of Object.entries({ x: box?.width ? box.x : 0, y: box?.width ? box.y : 0, width: box?.width || width, height: box?.width ? box.height : height, fill: '#ffffff' })) paper.setAttribute(key, value);
    copy.prepend(paper);
    return { text: new XMLSerializer().serializeToString(copy), width, height };
  });
  // The drawing as a PNG, on a canvas of `scale` times its size.
  const pngOf = async ({ text, width, height }, scale = 2) => {
    const image = new Image();
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
    await image.decode();
    const canvas = make('canvas', { width: Math.round(scale * width), height: Math.round(scale * height) }), pen = canvas.getContext('2d');
    pen.fillStyle = '#ffffff';
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(image, 0, 0, canvas.width, canvas.height);
    return canvas.toDataURL('image/png');
  };
  const bytesOf = (address) => Uint8Array.from(atob(address.slice(address.indexOf(',') + 1)), (c) => c.charCodeAt(0));
  const savePng = async (title, drawing) => save(named(title, 'png'), bytesOf(await pngOf(drawing)), 'image/png');
  const saveSvg = (title, drawing) => save(named(title, 'svg'), drawing.text, 'image/svg+xml');

  // Lines of at most 76 characters.
  const wrapped = (text) => text.replace(/.{76}/g, '$&\r\n');
  const base64 = (text) => wrapped(btoa(Array.from(new TextEncoder().encode(text), (byte) => String.fromCharCode(byte)).join('')));
  const wordStyle = 'body { font-family: Calibri, sans-serif; font-size: 11pt; } table { border-collapse: collapse; font-size: 9pt; margin: 6pt 0; } '
    + 'th, td { border: 0.5pt solid #999999; padding: 2pt 5pt; text-align: left; vertical-align: top; } caption { text-align: left; font-style: italic; } '
    + 'h1 { font-size: 18pt; } h2 { font-size: 14pt; } h3 { font-size: 12pt; } .headline { font-size: 13pt; font-weight: bold; } .caution { color: #a33b00; } pre { font-size: 8pt; }';
  const left = 'script, style, button, nav, input, select, textarea, noscript, footer, datalist, progress, .tools, .buttons, .actions, .skip, [hidden]';
  // The parts of a page as text, tables and pictures in one file. `drawingOf(picture)` gives {text, width, height}.
  const wordOf = async (title, parts, drawingOf = svgOf) => {
    const inert = document.implementation.createHTMLDocument(''), pictures = []; // loads nothing
    for (const part of parts) {
      const copy = inert.importNode(part, true), originals = [...part.querySelectorAll('svg')];
      const places = [...copy.querySelectorAll('svg')];
      for (const [i, picture] of originals.entries()) {
        if (picture.getBoundingClientRect().width < 8 || picture.closest(left)) { places[i].remove(); continue; }
        const drawing = await drawingOf(picture);
        pictures.push(await pngOf(drawing));
        const width = Math.round(Math.min(drawing.width, 600, 420 * drawing.width / drawing.height));
        const image = inert.createElement('img');
        for (const [key, value] of Object.entries({ src: `picture-${pictures.length}.png`, width, height: Math.round(drawing.height * width / drawing.width), alt: picture.getAttribute('aria-label') ?? '' })) image.setAttribute(key, value);
        places[i].replaceWith(image);
      }
      for (const node of copy.querySelectorAll(left)) node.remove();
      for (const node of copy.querySelectorAll('details')) node.replaceWith(...node.childNodes);
      inert.body.append(copy);
    }
    for (const node of inert.body.querySelectorAll('*')) for (const { name } of [...node.attributes]) if (!['src', 'width', 'height', 'alt', 'class', 'colspan', 'rowspan', 'scope', 'dir'].includes(name)) node.removeAttribute(name);
    const head = make('title', {}, title).outerHTML;
    const page = `<!doctype html><html xmlns:w="urn:schemas-microsoft-com:office:word" lang="en"><head><meta charset="utf-8">${head}<style>${wordStyle}</style></head><body>${inert.body.innerHTML}</body></html>`;
    const boundary = '----=_wheeltap_part', place = 'http://wheeltap.invalid/'; // a name within the file (RFC 2606)
    const piece = (type, name, text) => `--${boundary}\r\nContent-Type: ${type}\r\nContent-Transfer-Encoding: base64\r\nContent-Location: ${place}${name}\r\n\r\n${text}\r\n\r\n`;
    return `MIME-Version: 1.0\r\nContent-Type: multipart/related; type="text/html"; boundary="${boundary}"\r\n\r\n`
      + piece('text/html; charset="utf-8"', 'report.html', base64(page))
      + pictures.map((address, i) => piece('image/png', `picture-${i + 1}.png`, wrapped(address.slice(address.indexOf(',') + 1)))).join('') + `--${boundary}--\r\n`;
  };
  const saveWord = async (title, parts, drawingOf) => save(named(title, 'mht'), await wordOf(title, parts, drawingOf), 'multipart/related');

  // Buttons below a figure and below a table; `drawing()` gives {text, width, height}.
  const button = (text, label, action) => {
    const made = make('button', { type: 'button', 'aria-label': `${text}: ${label}` }, text);
    made.addEventListener('click', () => Promise.resolve(action()).catch((error) => { made.textContent = error.message; }));
    return made;
  };
  const figureButtons = (title, drawing) => [button('Save as SVG', title, async () => saveSvg(title, await drawing())), button('Save as PNG', title, async () => savePng(title, await drawing()))];
  const csvButton = (title, rows) => button('Save as CSV', title, () => saveCsv(title, rows()));
  const pageButtons = (title, parts, drawingOf) => [make('button', { type: 'button', onclick: () => print() }, 'Print or save as PDF'),
    button('Save for Word', title, () => saveWord(title, parts(), drawingOf))];
  return { svgOf, pngOf, wordOf, csv, cellsOf, figureButtons, csvButton, pageButtons };
})();
