// A console that goes away and comes back: the page says so, and goes on by itself.
import { end, expect, open_page } from './browser.mjs';

const page = await open_page({ may_lose_server: true });
await page.waitForSelector('#link[data-state=live]');
console.log('kill');
await page.waitForSelector('#link[data-state=lost]', { timeout: 15000 });
expect((await page.textContent('#link')).includes('No connection'), 'it says that there is no connection');
console.log('restart');
await page.waitForSelector('#link[data-state=live]', { timeout: 15000 });
const shown_n = await page.evaluate(() => globalThis.shown.length);
console.log('plan');
await page.waitForFunction((n) => globalThis.shown.length > n, shown_n, { timeout: 15000 });
await end();
