// transfer_frames.mjs DRIVER FOLDER: frames a second of the page of `hshfit transfer` in FOLDER
// while its light turns, over the last 60 frames of five seconds. The browser gives 60 at most.
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { finish, withBrowser } from './browser.mjs';

const [driver, folder] = process.argv.slice(2);

await finish(() => withBrowser(driver, async (page) => {
  await page.goto(pathToFileURL(join(folder, 'transfer.html')).href);
  await page.waitForFunction(() => window.transferPage?.frames.length > 0);
  await page.evaluate(() => document.getElementById('spin').click());
  await page.waitForTimeout(5000);
  const rate = await page.evaluate(() => {
    const { frames } = window.transferPage;
    return (1000 * (frames.length - 1)) / (frames.at(-1) - frames[0]);
  });
  console.log(`${driver}: ${rate.toFixed(1)} frames a second`);
}));
