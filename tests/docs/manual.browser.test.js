// Opens a built manual from the disk in headless Chromium, wide and at 400 px, light and dark, without a network: no script
// fails, nothing is asked of a network, no page scrolls sideways, dark is dark, and the search finds pages to read first.
const test = require('node:test');
const assert = require('node:assert/strict');
const path = require('node:path');
const { chromium } = require('playwright-core');

const site = path.resolve(process.env.WHEELTAP_MANUAL);
const shots = process.env.WHEELTAP_SHOTS;
const pages = ['index', 'readme', 'guide', 'structures', 'laws', 'comparison', 'validation', 'which-tool', 'gallery',
  'tutorials/beam', 'tutorials/first-answer', 'reference/commands', 'reference/keys', 'reference/python',
  'reference/cpp-inference-prior'];
let browser;
test.before(async () => {
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM || '/usr/bin/chromium', args: ['--no-sandbox'] });
});
test.after(() => browser.close());

for (const width of [400, 1400]) {
  for (const colorScheme of ['light', 'dark']) {
    test(`${width} px, ${colorScheme}`, async () => {
      const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme, offline: true });
      const page = await context.newPage();
      const faults = [];
      page.on('pageerror', (error) => faults.push(`${page.url()}: ${error}`));
      page.on('console', (message) => { if (message.type() === 'error') faults.push(`${page.url()}: ${message.text()}`); });
      page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) faults.push('asked for ' + request.url()); });
      for (const name of pages) {
        await page.goto(`file://${site}/${name}.html`);
        if (!await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth)) faults.push(`${name} scrolls sideways`);
        const light = await page.evaluate(() => Number(getComputedStyle(document.body).backgroundColor.match(/\d+/)[0]) > 128);
        if (light !== (colorScheme === 'light')) faults.push(`${name} is not ${colorScheme}`);
        if (shots) await page.screenshot({ path: path.join(shots, `${name.replace('/', '-')}-${width}-${colorScheme}.png`) });
      }
      await page.goto(`file://${site}/search.html?q=friction`);
      await page.waitForFunction(() => /found \d+/.test(document.body.textContent), null, { timeout: 20000 });
      const found = await page.$$eval('#search-results li a', (links) => links.map((link) => link.getAttribute('href')));
      const read = found.findIndex((link) => link.startsWith('laws.html')), declared = found.findIndex((link) => /reference\/cpp/.test(link));
      if (read < 0 || (declared >= 0 && declared < read)) faults.push('friction is found first in ' + found.slice(0, 4).join(', '));
      assert.deepEqual(faults, []);
      await context.close();
    });
  }
}
