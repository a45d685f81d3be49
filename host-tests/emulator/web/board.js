// Prints what the boards of a page send in every scene: the answers to the choice of the scene, then
// the messages of 18 s. The command line names the page, and the processors by their codes.
'use strict';

const { readFileSync, writeSync } = require('node:fs');

const [page, ...processors] = process.argv.slice(2);
const text = (id) => readFileSync(page, 'utf8').match(new RegExp(`id="${id}">([^<]*)<`))[1];
const { scenes, rate } = JSON.parse(text('facts'));
const wasm = new WebAssembly.Module(Buffer.from(text('module'), 'hex'));
for (const scene of scenes.keys()) {
  for (const processor of processors) {
    const board = new WebAssembly.Instance(wasm).exports;
    const print = (count) => writeSync(1, Buffer.from(board.memory.buffer, board.sent(), count).toString('hex'));
    board.start(Number(processor));
    print(board.choose(scene));
    for (let tick = 1; tick <= 18 * rate; tick++) print(board.run_to(tick));
  }
}
