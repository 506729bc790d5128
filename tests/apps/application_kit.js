// A folder of `wheeltap app` and headless Chromium for the tests of the application. WHEELTAP names the program;
// WHEELTAP_SHOTS a folder for screenshots; WHEELTAP_PAGES a folder whose page files replace those of the program. Without
// Chromium or the packages of package.json, the tests are skipped with a message.
const assert = require('node:assert/strict');
const { spawn, spawnSync } = require('node:child_process');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');

const program = process.env.WHEELTAP;
const shots = process.env.WHEELTAP_SHOTS;
const pages = process.env.WHEELTAP_PAGES;
const chromiumPath = process.env.CHROMIUM || '/usr/bin/chromium';
let chromium, axe, why;
try {
  ({ chromium } = require('playwright-core'));
  axe = fs.readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
} catch {
  why = 'the packages of package.json are not installed: npm ci';
}
if (!fs.existsSync(chromiumPath)) why = `there is no ${chromiumPath}`;
const skip = why ? { skip: why } : {};
if (why) console.log(`skipped: ${why}`);

// Serves an empty folder during the tests of a file.
const application = (test) => {
  let browser, folder, server, address;
  test.before(async () => {
    if (why) return;
    folder = fs.mkdtempSync(path.join(os.tmpdir(), 'wheeltap-app-'));
    server = spawn(program, ['app', folder], { stdio: ['ignore', 'pipe', 'inherit'] });
    address = await new Promise((resolve) => {
      let text = '';
      server.stdout.on('data', (data) => { text += data; const found = /http:\S+/.exec(text); if (found) resolve(found[0]); });
    });
    browser = await chromium.launch({ executablePath: chromiumPath, args: ['--no-sandbox'] });
  });
  test.after(async () => {
    await browser?.close();
    if (server) {
      const ended = new Promise((resolve) => { server.on('exit', resolve); });
      server.kill('SIGINT');
      assert.equal(await ended, 0);
    }
    if (folder) fs.rmSync(folder, { recursive: true });
  });

  const open = async (place = '#/', options = {}) => {
    const context = await browser.newContext({ viewport: { width: 1400, height: 1000 }, ...options });
    const page = await context.newPage();
    const complaints = [];
    page.on('console', (message) => { if (['error', 'warning'].includes(message.type()) && !/status of 4\d\d/.test(message.text())) complaints.push(message.text()); });
    page.on('pageerror', (error) => complaints.push(String(error)));
    page.on('request', (request) => { if (!request.url().startsWith(new URL(address).origin) && !/^(data|blob):/.test(request.url())) complaints.push(`request to ${request.url()}`); });
    if (pages) await page.route(/\/[0-9a-f]{32}\/\w+\.(js|css)$/, (route) => {
      const file = path.join(pages, path.basename(new URL(route.request().url()).pathname));
      return fs.existsSync(file) ? route.fulfill({ path: file, contentType: file.endsWith('.css') ? 'text/css' : 'text/javascript' }) : route.continue();
    });
    await page.goto(address + place);
    await page.waitForSelector('html[data-ready]');
    return { page, close: async () => { assert.deepEqual(complaints, []); await context.close(); } };
  };
  const shot = async (page, name) => {
    if (!shots) return;
    fs.mkdirSync(shots, { recursive: true });
    await page.evaluate(() => scrollTo(0, 0));
    await page.screenshot({ path: path.join(shots, `application-${name}.png`) });
  };
  return {
    at: (...parts) => path.join(folder ?? '', ...parts),
    open,
    go: async (page, place) => {
      await page.evaluate((to) => { location.hash = to; }, place);
      await page.waitForFunction((to) => document.documentElement.dataset.ready === to, place);
    },
    field: (page, pointer) => page.locator(`[data-pointer="${pointer}"]`).first(),
    input: (page, pointer) => page.locator(`[id="f:${pointer}"]`),
    status: (page, text) => page.locator('.status', { hasText: text }).first().waitFor({ timeout: 30000 }),
    read: (name) => JSON.parse(fs.readFileSync(path.join(folder, name), 'utf8')),
    shot,
    run: (...words) => {
      const done = spawnSync(program, words, { encoding: 'utf8' });
      assert.equal(done.status, 0, done.stderr);
      return done.stdout;
    },
  };
};

module.exports = { application, program, shots, skip, why, axe };
