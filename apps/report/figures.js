// Writes every figure as SVG into the working folder under Node.js, and their list, figures.txt.
const fs = require('node:fs');
(async () => {
  const names = [];
  for (const figure of charts.figures(run)) {
    const spec = figure.spec(figure.wide ? 720 : 380, charts.themes.light);
    const svg = await new vega.View(vega.parse(spec), { renderer: 'none' }).toSVG();
    const name = figure.id + '.svg';
    fs.writeFileSync(name, svg + '\n');
    names.push(name);
  }
  fs.writeFileSync('figures.txt', names.join('\n') + '\n');
})();
