// Both sizes, both schemes: nothing beyond the edge, nothing on top of another, nothing that axe-core
// finds serious.
import { axe_source, end, expect, more, open_page } from './browser.mjs';

function find_breaks() {
  const breaks = [];
  const wide = document.documentElement.scrollWidth - innerWidth;
  if (wide > 0) breaks.push(`${wide} px wider than the window`);
  const overlap = (one, other, name) => {
    const [a, b] = [one.getBoundingClientRect(), other.getBoundingClientRect()];
    const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
    const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
    if (across > 1 && down > 1) breaks.push(`${name}: ${one.id || one.className} and ${other.id || other.className} overlap`);
  };
  for (const group of ['.board', '.stage', '.pair', '.plan', '.history .bar', '.stage .bar', '.cells .bar', '.top', '.cells']) {
    const parts = [...document.querySelector(group).children].filter((child) => child.getClientRects().length > 0);
    parts.forEach((one, i) => parts.slice(i + 1).forEach((other) => overlap(one, other, group)));
    const box = document.querySelector(group).getBoundingClientRect();
    for (const part of parts) {
      const own = part.getBoundingClientRect();
      if (own.right > box.right + 1 || own.left < box.left - 1) breaks.push(`${group}: ${part.id || part.className} sticks out`);
    }
  }
  overlap(document.querySelector('.view .tools'), document.querySelector('.view .legend'), '.view');
  for (const button of document.querySelectorAll('button, .tag')) {
    if (button.scrollWidth > button.clientWidth + 1) breaks.push(`'${button.textContent}' does not fit its button`);
  }
  return breaks;
}

for (const [width, height] of [[1280, 720], [390, 844]]) {
  for (const scheme of ['light', 'dark']) {
    const page = await open_page({ width, height, scheme });
    const where = `${width} × ${height}, ${scheme}`;
    await page.waitForSelector('#scene[data-drawn]');
    await page.waitForTimeout(300);
    for (const broken of await page.evaluate(find_breaks)) expect(false, `${where}: ${broken}`);
    await page.evaluate(axe_source);
    const { violations } = await page.evaluate(() => globalThis.axe.run());
    for (const { id, impact, help, nodes } of violations) {
      const is_serious = impact === 'serious' || impact === 'critical';
      expect(!is_serious, `${where}: ${impact}: ${id}: ${help}: ${nodes.map((node) => node.target).join(' ')}`);
    }
    if (more[0]) await page.screenshot({ path: `${more[0]}/console_${width}_${scheme}.png`, fullPage: width < 500 });
    await page.close();
  }
}
await end();
