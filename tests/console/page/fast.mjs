// A cell that sends 30 frames a second: the newest are shown, and memory does not grow.
import { end, expect, more, open_page } from './browser.mjs';

const page = await open_page();
const seconds = Number(more[0]);
const session = await page.context().newCDPSession(page);
const heap_mib = async () => {
  await session.send('HeapProfiler.collectGarbage');
  return (await session.send('Runtime.getHeapUsage')).usedSize / 2 ** 20;
};
// Caches and the history fill up first, and what runs often is compiled: in a long run that takes part
// of a minute.
await page.waitForTimeout(Math.max(6000, 100 * seconds));
console.log('settled');
const heaps_mib = [await heap_mib()];
const counted = page.evaluate(async (ms) => {
  let updates_n = 0;
  let plans_n = 0;
  const source = new EventSource('api/events');
  source.addEventListener('cell', () => ++updates_n);
  document.addEventListener('planshown', () => ++plans_n);
  await new Promise((resolve) => setTimeout(resolve, ms));
  source.close();
  return { updates_n, plans_n };
}, 1000 * seconds);
for (let part = 0; part < 5; ++part) {
  await page.waitForTimeout(200 * seconds);
  heaps_mib.push(await heap_mib());
}
const seen = await counted;
const dom_n = await page.evaluate(() => document.getElementsByTagName('*').length);
const heaps = heaps_mib.map((heap) => heap.toFixed(1)).join(', ');
console.log(`${(seen.updates_n / seconds).toFixed(1)} updates and ${(seen.plans_n / seconds).toFixed(1)} plans shown a second; `
  + `in ${seconds} s heap ${heaps} MiB; ${dom_n} elements`);
expect(seen.updates_n > 10 * seconds, `${seen.updates_n} updates came in ${seconds} s`);
expect(seen.plans_n > seconds, `${seen.plans_n} plans were shown in ${seconds} s`);
expect(heaps_mib.at(-1) < heaps_mib[0] + 3, `the heap grew: ${heaps} MiB`);
expect(dom_n < 3000, `${dom_n} elements`);
await end();
