// A hundred cells: all listed, found by name, chosen by keys.
import { end, expect, open_page } from './browser.mjs';

const page = await open_page();
await page.waitForFunction(() => document.querySelectorAll('#cells li').length >= 100);
await page.fill('#filter', 'cell_77');
expect(await page.locator('#cells li:visible').count() === 1, 'the filter leaves one cell');
await page.fill('#filter', '');
await page.focus('#cells');
await page.keyboard.press('End');
const name = await page.textContent('#cells li:last-child .name');
await page.waitForFunction((last) => document.getElementById('cell_name').textContent === last, name);
await page.waitForFunction((last) => globalThis.shown.at(-1).flight.startsWith(`${last}/`), name);
const box = await page.locator('#cells li:last-child').boundingBox();
expect(box.y + box.height <= 720, 'the chosen cell is scrolled into sight');
expect(await page.evaluate(() => document.documentElement.scrollHeight <= innerHeight), 'the page itself does not scroll');
await end();
