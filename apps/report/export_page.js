// Buttons of a page without charts: its drawings, tables and the page itself as files.
(() => {
  const main = document.querySelector('main'), title = document.querySelector('h1').textContent;
  const tools = (...buttons) => {
    const place = document.createElement('div');
    place.className = 'tools';
    place.append(...buttons);
    return place;
  };
  for (const picture of main.querySelectorAll('svg.plot')) {
    const heading = picture.closest('figure')?.querySelector('figcaption')?.textContent ?? picture.getAttribute('aria-label') ?? title;
    const holder = document.createElement('div');
    picture.replaceWith(holder);
    holder.append(picture, tools(...exporting.figureButtons(heading, () => exporting.svgOf(picture))));
  }
  for (const table of main.querySelectorAll('table')) {
    let heading = title;
    for (const one of main.querySelectorAll('h2, h3')) if (one.compareDocumentPosition(table) & Node.DOCUMENT_POSITION_FOLLOWING) heading = one.textContent;
    (table.closest('.scroll') ?? table).after(tools(exporting.csvButton(table.caption?.textContent ?? heading, () => exporting.cellsOf(table))));
  }
  document.querySelector('header').append(tools(...exporting.pageButtons(title, () => [document.querySelector('header'), main])));
})();
