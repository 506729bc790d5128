// CSV of tables, without a page.
const test = require('node:test');
const assert = require('node:assert/strict');
const fs = require('node:fs');
const path = require('node:path');
const vm = require('node:vm');

const script = fs.readFileSync(path.join(__dirname, '../../apps/report/export.js'), 'utf8');
const { csv } = vm.runInNewContext(`${script}; exporting`);

test('numbers keep all digits, and texts with commas, quotes and line breaks are quoted', () => {
  assert.equal(csv([['a, b', 'say "x"', 'two\nlines'], [0.1 + 0.2, -1e-12, null], [NaN, Infinity, undefined]]),
    '"a, b","say ""x""","two\nlines"\r\n0.30000000000000004,-1e-12,\r\n,,\r\n');
});

test('no text is a formula in a spreadsheet', () => {
  assert.equal(csv([['=HYPERLINK("http://evil.example")', '@SUM(A1)', '+1+1', '-cmd', '\tx']]), '"\'=HYPERLINK(""http://evil.example"")",\'@SUM(A1),\'+1+1,\'-cmd,\'\tx\r\n');
  assert.equal(csv([['-0.5', '+3', 'a=b']]), '-0.5,+3,a=b\r\n'); // numbers and plain texts
});
