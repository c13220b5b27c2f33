// What an operator does: grasps, GRS, replay, theme; by mouse and by keys alone.
import { end, expect, open_page } from './browser.mjs';

const page = await open_page();
const flight = () => page.getAttribute('#stage', 'data-flight');
const newest = await flight();
await page.waitForFunction(() => document.querySelectorAll('#history > div').length > 2);

await page.waitForSelector('#grasps li:nth-child(2)');
await page.focus('#grasps');
await page.keyboard.press('ArrowDown');
expect(await page.getAttribute('#grasps li:nth-child(2)', 'aria-selected') === 'true', 'arrow down selects the next grasp');

await page.hover('#grs li:first-child');
const lit_n = await page.locator('#grs li.is_lit').count();
expect(lit_n > 0, 'hovering over a score lights its neighbours');
expect(await page.locator('#pile .is_lit').count() === lit_n, 'and the same ones in the pile');
await page.mouse.move(5, 5);
expect(await page.locator('#grs li.is_lit').count() === 0, 'they go out again');

await page.focus('#cells');
await page.keyboard.press('ArrowLeft');
await page.waitForFunction((name) => document.getElementById('stage').dataset.flight !== name, newest);
expect(await page.getAttribute('#live', 'aria-pressed') === 'false', 'stepping back is no longer live');
const older = await flight();
expect(older < newest, 'arrow left shows the plan before');
expect(await page.locator('#history > div[aria-selected=true]').count() === 1, 'it is marked in the history');
await page.keyboard.press(' ');
await page.waitForFunction((name) => document.getElementById('stage').dataset.flight === name, newest);
await page.keyboard.press('l');
expect(await page.getAttribute('#live', 'aria-pressed') === 'true', 'L is live again');

await page.waitForSelector('#scene[data-drawn]');
await page.focus('#scene');
await page.keyboard.press('ArrowLeft');
expect(await flight() === newest, 'arrows on the 3D view turn it, and nothing else');

const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
const light = await ground();
await page.click('#theme');
expect(await ground() !== light, 'the theme changes');
expect((await page.textContent('#words')).length > 10, 'the outcome is said in words');
expect(await page.locator('#funnel tr').count() >= 9, 'the funnel has its stages');
expect(await page.isHidden('#scene_note'), 'there is a 3D view');
const picture = async () => (await page.locator('#scene').screenshot()).toString('base64');
await page.mouse.move(5, 5);
const whole = await picture();
await page.evaluate(() => document.querySelector('[data-view=top]').click());
await page.waitForTimeout(300);
expect(await picture() !== whole, 'the 3D view is seen from above');
await end();
