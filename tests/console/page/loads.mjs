// The first plan is on the page within a second of asking for the page: the best of five, since others
// use this machine too.
import { end, expect, open_page } from './browser.mjs';

const times_ms = [];
for (let i = 0; i < 5; ++i) {
  const page = await open_page();
  times_ms.push(await page.evaluate(() => Math.round(globalThis.shown[0].loaded_ms)));
  await page.waitForTimeout(300);
  await page.close();
}
console.log(`first plan shown after ${times_ms.join(', ')} ms`);
expect(Math.min(...times_ms) <= 1000, `the first plan came after ${times_ms.join(', ')} ms`);
await end();
