// Prints the bytes that the boards of a page send in every scene: a line for the choice of the
// scene, then one for each tick of 18 s. The command line names the page, and the codes of the
// processors.
'use strict';

const { readFileSync, writeSync } = require('node:fs');

const [page, ...processors] = process.argv.slice(2);
const part = (id) => readFileSync(page, 'utf8').match(new RegExp(`id="${id}">([^<]*)<`))[1];
const { scenes, rate } = JSON.parse(part('facts'));
const wasm = new WebAssembly.Module(Buffer.from(part('module'), 'hex'));
for (const { id } of scenes) {
  for (const processor of processors) {
    const board = new WebAssembly.Instance(wasm).exports;
    board.start(Number(processor), 0);
    const bytes = (at, length) => Buffer.from(board.memory.buffer, at, length);
    board.command(bytes(board.text()).write(JSON.stringify({ Choose: id })));
    for (let tick = 1; tick <= 18 * rate + 1; tick++) {
      writeSync(1, `${bytes(board.sent(), board.sent_length()).toString('hex')}\n`);
      board.run_to(tick);
    }
  }
}
