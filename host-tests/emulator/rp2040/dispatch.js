// A faster `executeInstruction` for the emulated processor.
//
// The emulator finds the code of each instruction by a chain of comparisons:
//
//     if (opcode >> 6 === 0b0100000101) { ... }
//     else if (opcode >> 11 === 0b10101) { ... }
//     ... about 80 more ...
//     else { ... }
//
// This module makes another function from the text of the emulator's own. Each branch becomes a
// function, and a table has the number of the branch for each opcode. The text before, in and after
// the branches remains as it is. `compare.js` checks that both functions do the same.
//
// Small functions are faster for a second reason. Node.js compiles a function for the cases that it
// has seen, and starts again at the first other case. It took 60 ms for the chain, at each
// instruction of a new kind.

/** The names outside of the function that its text uses, with the emulator's values. */
const NAMES = {
  spRegister: 13,
  pcRegister: 15,
  signExtend8: (value) => (value << 24) >> 24,
  signExtend16: (value) => (value << 16) >> 16,
  LOG_NAME: 'CortexM0Core',
};
/** The variables of the function that a branch uses. It may change the last one only. */
const VARIABLES = ['opcode', 'opcode2', 'opcodePC', 'deltaCycles'];

/** The first branch. The conditions before it are not about the opcode. */
const FIRST = /^ {8}if \(opcode /m;
/** A branch of the chain, after its comments: the condition, and the lines of its body. */
const BRANCH = /(?: {8}\/\/.*\n)* {8}(?:else )?if \((opcode .*)\) \{\n((?: {12}.*\n)+) {8}\}\n/y;
/** The last branch of the chain, which has no condition. */
const OTHERWISE = / {8}else \{\n((?: {12}.*\n)+) {8}\}\n/y;
/** The least number of branches of the chain with a condition. */
const LEAST = 80;

/**
 * Splits the text of the emulator's function: the text before the chain, the conditions and bodies
 * of the branches, the last one without a condition, and the text after it. An unexpected text is
 * an error.
 */
function split(text) {
  let at = text.search(FIRST);
  const head = text.slice(0, at);
  const next = (pattern) => {
    pattern.lastIndex = at;
    const found = pattern.exec(text);
    if (found) at = pattern.lastIndex;
    return found;
  };

  // The branches follow each other without a gap.
  const [conditions, bodies] = [[], []];
  for (let branch; (branch = next(BRANCH)); ) {
    conditions.push(branch[1]);
    bodies.push(branch[2]);
  }
  const last = next(OTHERWISE);
  if (!last || conditions.length < LEAST) {
    throw new Error(`its chain ends after ${conditions.length} branches`);
  }
  bodies.push(last[1]);
  if (bodies.some((body) => /\breturn\b/.test(body))) throw new Error('a branch returns');
  return { head, conditions, bodies, tail: text.slice(at) };
}

/** Makes the function of the number of the branch. Numbers begin at 1. */
function search(conditions) {
  const lines = conditions.map((condition, index) => `if (${condition}) return ${index + 1};`);
  lines.push(`return ${conditions.length + 1};`);
  return new Function('opcode', 'opcode2', lines.join('\n'));
}

/**
 * Returns a function that does the same as the emulator's `executeInstruction`, faster. An error
 * means that the text of the emulator's function is not as expected.
 */
export function withTable(executeInstruction) {
  const { head, conditions, bodies, tail } = split(executeInstruction.toString());
  const find = search(conditions);

  // The table is filled when an opcode is executed first, because few of them ever are. A second
  // halfword is not in the table, so the few instructions with one are searched each time.
  const numbers = new Uint8Array(1 << 16);
  const learn = (opcode) => (numbers[opcode] = find(opcode, 0));
  const branches = bodies.map((body) => `function (${VARIABLES}) {\n${body}return deltaCycles;\n}`);
  const text = `
    const branches = [undefined, ${branches.join(', ')}];
    return function ${head}
      const number = wideInstruction ? find(opcode, opcode2) : numbers[opcode] || learn(opcode);
      deltaCycles = branches[number].call(this, ${VARIABLES});
    ${tail}`;
  const names = { ...NAMES, find, numbers, learn };
  return new Function(...Object.keys(names), text)(...Object.values(names));
}

/** The functions that `quicken` has made, by the emulator's. */
const made = new Map();

/** Gives a processor the faster function. If there is none, says so and leaves the processor. */
export function quicken(core) {
  const own = core.executeInstruction;
  try {
    if (!made.has(own)) made.set(own, withTable(own));
  } catch ({ message }) {
    console.error(`rp2040js is slow: executeInstruction is not as expected: ${message}`);
    made.set(own, own);
  }
  core.executeInstruction = made.get(own);
}
