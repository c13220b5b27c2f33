// Grasps that the arm could not take are shown as such, with why: of the newest plan all, of the one
// before the first.
import { end, expect, more, open_page } from './browser.mjs';

const page = await open_page();
const kReason = 'joint_3 would be at 2.9 rad';
const kinds = () => page.$$eval('#grasps li', (rows) => rows.map((row) => row.className));
const has_colour = (colour) => page.evaluate((wanted) => {
  const canvas = document.getElementById('depth');
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
  for (let i = 0; i < data.length; i += 4) if (wanted.every((value, k) => data[i + k] === value)) return true;
  return false;
}, colour);
const kUnreachable = [0xf0, 0xe4, 0x42];
const kFree = [0x56, 0xb4, 0xe9];

await page.waitForSelector('#grasps li.unreachable');
await page.waitForSelector('#scene[data-drawn]');
await page.waitForTimeout(300);
expect(!(await kinds()).includes('free'), 'of the newest plan no grasp is free');
expect(await page.textContent('#outcome') === 'none reachable', 'the outcome is the arm\'s');
expect((await page.textContent('#words')).includes('The arm can take none'), 'and said in words');
expect(await has_colour(kUnreachable) && !(await has_colour(kFree)), 'the depth image has its grasps in that colour');
expect((await page.getAttribute('#history > div:last-child', 'title')).includes('none reachable'), 'so does the history say');
if (more[0]) await page.screenshot({ path: `${more[0]}/console_none_reachable.png` });

const row = page.locator('#grasps li[aria-selected=true] .what');
expect(await row.evaluate((text) => text.scrollWidth <= text.clientWidth), 'the selected line is not cut off');

await page.keyboard.press('ArrowLeft');
await page.waitForSelector('#grasps li.free');
await page.waitForTimeout(300);
const first = page.locator('#grasps li:first-child');
expect(await first.getAttribute('class') === 'unreachable', 'the first grasp was passed over');
expect((await first.textContent()).includes(kReason), 'its line says why');
expect((await first.getAttribute('title')).includes(kReason), 'and so does its hint');
const second = page.locator('#grasps li:nth-child(2)');
expect(await second.getAttribute('aria-selected') === 'true', 'the second one, which the arm took, is selected');
expect((await second.textContent()).includes('picked'), 'and marked');
expect(await has_colour(kUnreachable) && await has_colour(kFree), 'the depth image has both colours');
if (more[0]) await page.screenshot({ path: `${more[0]}/console_unreachable.png` });
await end();
