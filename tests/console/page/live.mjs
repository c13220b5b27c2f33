// A plan is on the page within 200 ms of its answer, from the time that the server wrote down.
import { end, expect, more, open_page } from './browser.mjs';

const page = await open_page();
const plans_n = Number(more[0]);
await page.waitForSelector('#scene[data-drawn]');
await page.evaluate(() => { globalThis.shown = []; });
await page.waitForFunction((n) => globalThis.shown.length > n, plans_n, { timeout: 60000 });
const after_ms = await page.evaluate(() => globalThis.shown.slice(1).map((plan) => Math.round(plan.after_ms)));
after_ms.sort((a, b) => a - b);
const median_ms = after_ms[Math.floor(after_ms.length / 2)];
console.log(`plans shown ${median_ms} ms after their answers (median of ${after_ms.length}; ${after_ms[0]} to ${after_ms.at(-1)})`);
expect(median_ms <= 200, `plans were shown ${after_ms.join(', ')} ms after their answers`);
await end();
