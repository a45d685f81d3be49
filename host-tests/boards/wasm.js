// Runs the WebAssembly module that the command line names: the image of `firmware/cores`, which
// imports a way to print.
'use strict';

const { readFileSync, writeSync } = require('node:fs');

const print = (text, bytes) => writeSync(1, new Uint8Array(instance.exports.memory.buffer, text, bytes));
const instance = new WebAssembly.Instance(new WebAssembly.Module(readFileSync(process.argv[2])), { host: { print } });
instance.exports.start();
