// Runs the tests where they can be run: npm may have had no registry when this was built.
import { existsSync } from 'node:fs';

const packages = new URL('node_modules/playwright-core', import.meta.url);
if (existsSync(process.env.SPHERECHAIN_PAGE) && existsSync(packages)) {
  await import('./page_test.mjs');
  await import('./pose_test.mjs');
  await import('./editor_test.mjs');
  await import('./report_test.mjs');
} else {
  console.log('SKIPPED: viewer.page needs the page and the packages of its test, which npm could not install');
}
