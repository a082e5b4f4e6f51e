// node read_js.mjs FILE…: imports exported modules, writes the array of each to FILE.raw, and
// prints the array's type and the metadata, JSON on a line.
import { readFileSync, writeFileSync } from 'node:fs';

for (const file of process.argv.slice(2)) {
  const source = readFileSync(file).toString('base64');
  const module = await import(`data:text/javascript;base64,${source}`);
  writeFileSync(`${file}.raw`, new Uint8Array(module.coefficients.buffer));
  const type = module.coefficients.constructor.name;
  console.log(JSON.stringify({ type, metadata: module.metadata }));
}
