// What the scenarios share: a page in Debian's Chromium, whose every complaint fails the scenario.
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';

const modules = createRequire(`${process.env.NODE_MODULES}/`);
const { chromium } = modules('playwright-core');
export const axe_source = readFileSync(modules.resolve('axe-core/axe.min.js'), 'utf8');

export const url = process.argv[2];
export const more = process.argv.slice(3);
const complaints = [];

export function expect(is_so, sentence) {
  if (!is_so) complaints.push(sentence);
}

export const browser = await chromium.launch({
  executablePath: '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--js-flags=--expose-gc'],
});

export async function open_page({ width = 1280, height = 720, scheme = 'light', may_lose_server = false } = {}) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme });
  page.on('console', (message) => {
    const is_about_server = may_lose_server && /ERR_|Failed to load/.test(message.text());
    if (['error', 'warning'].includes(message.type()) && !is_about_server && !/GPU stall|swiftshader/i.test(message.text())) {
      complaints.push(`console: ${message.text()}`);
    }
  });
  page.on('pageerror', (error) => complaints.push(`page: ${error.stack}`));
  await page.addInitScript(() => {
    globalThis.shown = [];
    document.addEventListener('planshown', ({ detail }) => {
      globalThis.shown.push({ ...detail, after_ms: Date.now() - 1000 * detail.stamp_s, loaded_ms: performance.now() });
      if (globalThis.shown.length > 200) globalThis.shown.shift();  // memory is measured, too
    });
  });
  await page.goto(url);
  await page.waitForFunction(() => globalThis.shown.length > 0);
  return page;
}

export async function end() {
  await browser.close();
  for (const complaint of complaints) console.log(`FAILED ${complaint}`);
  process.exit(complaints.length > 0 ? 1 : 0);
}
