// wgsl_to_spirv.mjs IN.wgsl OUT.spv: parses, validates and translates with naga; exits with 1 and
// what naga says where it refuses.
import { readFileSync, writeFileSync } from 'node:fs';
import { parseWgsl, validate, writeSpirv } from 'naga-wasm';

try {
  const module = parseWgsl(readFileSync(process.argv[2], 'utf8'));
  const words = writeSpirv(module, validate(module), {});
  writeFileSync(process.argv[3], new Uint8Array(words.buffer, words.byteOffset, words.byteLength));
} catch (error) {
  console.error(String(error.message ?? error));
  process.exit(1);
}
