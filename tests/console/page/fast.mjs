// A cell that sends 30 frames a second: the newest are shown, and memory does not grow.
import { end, expect, more, open_page } from './browser.mjs';

const page = await open_page();
const seconds = Number(more[0]);
const session = await page.context().newCDPSession(page);
const heap_mib = async () => {
  await session.send('HeapProfiler.collectGarbage');
  return (await session.send('Runtime.getHeapUsage')).usedSize / 2 ** 20;
};
await page.waitForTimeout(6000);  // caches and the history fill up first
console.log('settled');
const before_mib = await heap_mib();
const seen = await page.evaluate(async (ms) => {
  let updates_n = 0;
  let plans_n = 0;
  const source = new EventSource('api/events');
  source.addEventListener('cell', () => ++updates_n);
  document.addEventListener('planshown', () => ++plans_n);
  await new Promise((resolve) => setTimeout(resolve, ms));
  source.close();
  return { updates_n, plans_n };
}, 1000 * seconds);
const after_mib = await heap_mib();
const dom_n = await page.evaluate(() => document.getElementsByTagName('*').length);
console.log(`${(seen.updates_n / seconds).toFixed(1)} updates and ${(seen.plans_n / seconds).toFixed(1)} plans shown a second; `
  + `heap ${before_mib.toFixed(1)} MiB, after ${seconds} s ${after_mib.toFixed(1)} MiB; ${dom_n} elements`);
expect(seen.updates_n > 10 * seconds, `${seen.updates_n} updates came in ${seconds} s`);
expect(seen.plans_n > seconds, `${seen.plans_n} plans were shown in ${seconds} s`);
expect(after_mib < before_mib + 3, `the heap grew from ${before_mib} to ${after_mib} MiB`);
expect(dom_n < 3000, `${dom_n} elements`);
await end();
