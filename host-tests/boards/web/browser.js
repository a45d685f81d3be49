// Opens the page in Chromium, by the DevTools protocol over a pipe, and checks its texts and its
// inputs. The command line names Chromium, its options, the page, and the folder of the pictures.
'use strict';

const assert = require('node:assert/strict');
const { spawn } = require('node:child_process');
const { readFileSync } = require('node:fs');

const [chromium, options, page, pictures] = process.argv.slice(2);
const stdio = ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'];
const browser = spawn(chromium, options.split(' '), { stdio });
const [, , , input, output] = browser.stdio;
const waiting = [];
const events = [];
let rest = '';
let sessionId;
output.setEncoding('utf8').on('data', (data) => {
  const messages = (rest + data).split('\0');
  rest = messages.pop();
  for (const message of messages.map((json) => JSON.parse(json))) {
    if (message.id) waiting[message.id](message);
    else events.push(message);
  }
});

/** Calls a method of the protocol, and returns its result. */
async function call(method, params) {
  const id = waiting.length + 1;
  input.write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
  const { error, result } = await new Promise((resolve) => { waiting[id] = resolve; });
  assert.equal(error, undefined, method);
  return result;
}

/** Returns the value of an expression on the page. */
async function of(expression) {
  const settings = { expression, awaitPromise: true, returnByValue: true };
  const { result, exceptionDetails } = await call('Runtime.evaluate', settings);
  assert.equal(exceptionDetails, undefined, expression);
  return result.value;
}

/** Checks the texts of elements, and the choices of controls. */
async function see(expected) {
  for (const [id, part] of Object.entries(expected)) {
    const text = await of(`at('${id}').selectedOptions?.[0].text ?? at('${id}').textContent`);
    assert.match(text, new RegExp(part), id);
  }
}

// The clock of the page, the promise of its new board, and the colours on its canvas, a number for
// each pixel.
const SETUP = `
  let time = 0;
  const { instantiate } = WebAssembly;
  WebAssembly.instantiate = (module) => window.starting = instantiate(module);
  window.ready = new Promise((done) => {
    window.requestAnimationFrame = (frame) => done(window.frame = frame);
  });
  window.run = (ticks) => { for (; ticks > 0; ticks--) frame(time += 1000 / 60); };
  window.later = () => new Promise((done) => setTimeout(() => done(run(1)), 400));
  window.at = (id) => document.getElementById(id);
  window.picture = () => {
    const copy = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    copy.drawImage(at('panel'), 0, 0);
    return [...new Uint32Array(copy.getImageData(0, 0, at('panel').width, at('panel').height).data.buffer)];
  };`;

/** Opens the page with a link and the settings of a user, and runs its first tick. */
async function open(hash, features = []) {
  await call('Emulation.setEmulatedMedia', { features });
  for (const url of ['about:blank', `file://${page}${hash}`]) await call('Page.navigate', { url });
  await of('ready.then(() => run(1))');
}

/** Changes the link of the open page, and runs the first tick of its new board. */
const follow = (hash) => of(`new Promise((done) => {
  addEventListener('hashchange', () => done(starting), { once: true });
  location.hash = '${hash}';
}).then(() => run(1))`);

async function press(key) {
  const codes = { ArrowUp: 38, ArrowDown: 40, ArrowLeft: 37, ArrowRight: 39, Escape: 27, Tab: 9 };
  const text = key === 'Enter' ? '\r' : key.length === 1 ? key : undefined;
  for (const event of [{ type: 'keyDown', text }, { type: 'keyUp' }]) {
    await call('Input.dispatchKeyEvent', { ...event, key, windowsVirtualKeyCode: codes[key] });
  }
  await of('run(1)');
}

/** Presses a mouse button or a finger, moves it and releases it. Places are parts of an element. */
async function drag(isTouch, id, places, between = '') {
  await of(`at('${id}').scrollIntoView({ block: 'center' })`);
  const { left, top, width, height } = await of(`at('${id}').getBoundingClientRect().toJSON()`);
  const send = (mouse, touch, place) => {
    const at = { x: left + place[0] * width, y: top + place[1] * height };
    const touchPoints = touch === 'touchEnd' ? [] : [at];
    return isTouch ? call('Input.dispatchTouchEvent', { type: touch, touchPoints })
      : call('Input.dispatchMouseEvent', { type: mouse, ...at, button: 'left', clickCount: 1 });
  };
  await send('mousePressed', 'touchStart', places[0]);
  for (const place of places.slice(1)) await send('mouseMoved', 'touchMove', place);
  await of(between);
  await send('mouseReleased', 'touchEnd', places.at(-1));
  await of('run(1)');
}

const OLED = '#scene=page&board=lm3s6965evb&panel=oled';

async function test() {
  const { targetId } = await call('Target.createTarget', { url: 'about:blank' });
  ({ sessionId } = await call('Target.attachToTarget', { targetId, flatten: true }));
  for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await call(`${domain}.enable`);
  await call('Page.addScriptToEvaluateOnNewDocument', { source: SETUP });

  // Every scene is its picture, pixel by pixel.
  await open(OLED);
  const { scenes, palette, panels, drawn } = await of("JSON.parse(at('facts').textContent)");
  const colours = palette.map((colour) => Buffer.from([...colour, 255]).readUInt32LE());
  for (const { key, name } of scenes) {
    await press(key);
    await see({ scene: `^${key} ${name}$`, caption: `^${name}, playing: ` });
    for (const [ticks, more] of [[60, 59], [240, 180]]) {
      await of(`run(${more})`);
      const picture = readFileSync(`${pictures}/${name}-${ticks}.txt`, 'utf8').replaceAll('\n', '');
      const expected = [...picture].map((ink) => colours[' .,:;-~=+*oaOX#@'.indexOf(ink)]);
      assert.deepEqual(await of('picture()'), expected, `${name}, ${ticks}`);
    }
  }

  // By default the display is a colour panel.
  await open('');
  await see({ display: panels[0].text });
  await of('run(60)');
  assert.ok(await of("new Set(picture().map((one) => one & 0xffffff)).size > 16"));
  await of(`at('display').selectedIndex = ${panels.length - 1},
    at('display').dispatchEvent(new Event('change')), later()`);
  await see({ display: 'OLED' });
  assert.match(await of("later().then(() => location.hash)"), /panel=oled/);

  // The keys.
  await open(OLED);
  const keys = [['ArrowUp', 'mu-now', '^1.25$'], ['ArrowDown', 'mu-now', '^1$'],
    ['ArrowRight', 'angle-now', '^121°$'], ['ArrowLeft', 'angle-now', '^120°$'],
    ['p', 'caption', 'paused'], ['.', 'time', '0.03 s'], ['Enter', 'time', '0.00 s'],
    ['p', 'play', 'Pause'], [' ', 'time', '0.02 s'], ['n', 'scene', 'small-0.2'],
    ['N', 'scene', 'page'], ['+', 'caption', 'speed 2:'], ['-', 'caption', 'playing:'],
    ['-', 'caption', 'speed 0.5:'], ['?', 'keys', 'up, down'], ['n', 'scene', 'page'],
    ['Escape', 'scene', 'page'], ['n', 'scene', 'small'], ['1', 'scene', 'page'],
    ['Tab', 'play', 'Pause'], ['Enter', 'play', 'Play'], ['Tab', 'caption', 'paused, speed 0.5']];
  for (const [key, id, part] of keys) {
    await press(key);
    await see({ [id]: part });
  }

  // Sliders, selections and buttons, by mouse, finger and keyboard.
  await drag(false, 'mu', [[0.99, 0.5]]);
  await drag(true, 'angle', [[0.5, 0.5], [0.01, 0.5]]);
  await see({ 'mu-now': '^100$', 'angle-now': '^-180°$' });
  await of("at('angle').focus()");
  await press('ArrowRight');
  await drag(true, 'pad', [[0.5, 0.9]]);
  await see({ 'mu-now': '^80$', 'angle-now': '^-179°$' });
  const choose = (id, index) => of(`at('${id}').selectedIndex = ${index},
    at('${id}').dispatchEvent(new Event('change')), later()`);
  await choose('method', 3);
  await see({ stepping: '^rk4-fixed32, ' });
  await choose('board', 2);
  await see({ chip: 'Cortex-M4F' });
  const kept = '#scene=page&mu=80&angle=-179&method=rk4-fixed32&speed=0.5&board=lm3s6965evb-m4&panel=oled';
  assert.equal(await of('later().then(() => location.hash)'), kept);

  // Bobs: time stops while one is held, and each turns its own rod.
  await open('#scene=page&mu=2.5&angle=90&panel=oled');
  await drag(false, 'panel', [[92.5 / 128, 0.5], [88.25 / 128, 42 / 64]], `run(30);
    window.held = ['caption', 'time', 'angle-now'].map((id) => at(id).textContent).join('|')`);
  assert.match(await of('held'), /paused.*\|0\.00 s\|90°, 45°$/);
  await see({ caption: 'playing', time: '0.02 s' });
  await drag(true, 'panel', [[78.25 / 128, 0.5], [0.5, 0.9]]);
  await see({ caption: 'playing: .* α₁ = 0 degrees, α₂ = 45 degrees, from rest$' });
  await see({ 'angle-now': '^0°, 45°$', 'mu-now': '^2.5$' });
  const scrolls = (x, y) => of(`{
    const { left, top, width, height } = at('panel').getBoundingClientRect();
    const place = { clientX: left + ${x} * width, clientY: top + ${y} * height };
    const touches = [new Touch({ identifier: 0, target: at('panel'), ...place })];
    at('panel').dispatchEvent(new TouchEvent('touchstart', { cancelable: true, touches }));
  }`);
  assert.deepEqual([await scrolls(0.5, 0.72), await scrolls(0.1, 0.5)], [false, true]);

  // The link restores everything, with its words in any order.
  const other = '#scene=butterfly&m1=2&m2=3&l1=0.7&g=1.62&a1=10&a2=-20.5&w2=1&board=stm32f405';
  for (const hash of [kept, other]) {
    const reversed = hash.slice(1).split('&').reverse().join('&');
    for (const written of [hash, `#${reversed}`]) {
      await open(written);
      assert.equal(await of("at('words').value"), hash);
      await see({ said: '^$' });
    }
  }
  await follow('#scene=page&angle=100&mu=3&m1=2&processor=m3');
  await see({ 'mu-now': '^3$', 'angle-now': '^100°$', board: 'Cortex-M3' });
  await see({ caption: '^page, playing: m₁ = 2 kg, m₂ = 6 kg, l₁ = 1 m' });

  // A wrong word is named with what is allowed. The address stays until a setting changes.
  const number = 'use a number from';
  const wrong = [
    ['mu=0,5', 'mu=0,5: use a number with a decimal point from 0.001 to 1000.'],
    ['mu=', `mu=: ${number} 0.001 to 1000.`],
    ['angle=170°', `angle=170°: ${number} -180 to 180 degrees.`],
    ['a1=400', `a1=400: ${number} -180 to 180 degrees.`],
    ['m1=-1', `m1=-1: ${number} 0.001 to 1000 kg.`],
    ['l1=1e-30&l2=1e30', `l1=1e-30: ${number} 0.001 to 1000 m.\nl2=1e30: ${number} 0.001 to 1000 m.`],
    ['w2=Infinity', `w2=Infinity: ${number} -1000 to 1000 rad/s.`],
    ['speed=9/2', `speed=9/2: ${number} 0.01 to 4.`],
    ['method=foo', `method=foo: use one of plan, ${drawn.map(({ name }) => name).join(', ')}.`],
    ['scene=Page', `scene=Page: use one of ${scenes.map(({ name }) => name).join(', ')}.`],
    ['processor=m5', 'board=m5: use one of pico, lm3s6965evb, lm3s6965evb-m4, stm32f405.'],
    ['foo=1', 'foo: no such word; use scene, m1, mu, m2, l1, l2, g, angle, a1, a2, w1, w2, speed, '
      + 'method, board, panel.'],
    ['g=1&g=2', 'g=2: g is given twice.'],
    ['m2=2&mu=3', 'mu: m2 replaced it.'],
    ['scene=flips&a1=30', 'a1: the scene flips has no start.'],
    ['scene=figure-7&l2=0.7', 'The numbers are ignored: figure-7 needs equal rods; set both by the '
      + 'words of the link, such as #l1=2&l2=2.'],
    ['scene=small-1&g=0', 'The numbers are ignored: small-1 needs a gravity g above 0 m/s².'],
  ];
  for (const [words, reasons] of wrong) {
    await follow(`#${words}`);
    assert.equal(await of("at('said').textContent"), reasons);
    assert.equal(await of('later().then(() => decodeURI(location.hash))'), `#${words}`);
  }
  await open('#speed=1/2&panel=lcd-2');
  await see({ caption: 'speed 0.5', display: 'Pico-LCD-2' });
  await open('#a1=100&a2=80&l1=0.3&l2=0.3');
  await of('run(60)');
  await see({ horizon: '^planning: not known yet$' });
  await open('#scene=nowhere&mu=2.5');
  await see({ scene: 'page', 'mu-now': '^2.5$' });
  await press('ArrowRight');
  await see({ said: '^$' });
  assert.equal(await of('later().then(() => location.hash)'), '#scene=page&mu=2.5&angle=121');

  // Every scene takes the least and the most of every number, or names what it needs.
  for (const { key, name } of scenes) {
    await follow(`#scene=${name}`);
    await see({ scene: `^${key} ${name}$` });
    const refused = await of(`[...document.querySelectorAll('#fields input')].flatMap((field) => {
      const take = (value) => {
        field.value = value;
        field.dispatchEvent(new Event('change'));
        return at('said').textContent;
      };
      const [least, most] = take('none').match(/from (\\S+) to (\\S+)/).slice(1);
      return [take(least), take(most), take(1)].filter((said) => said);
    })`);
    for (const said of refused) assert.match(said, /^No effect: .* (needs equal rods|gravity g above 0)/);
  }

  // The fields, and the words in their own field.
  await open('');
  const enter = (id, text) => of(`{
    at('${id}').value = '${text}';
    at('${id}').dispatchEvent(new Event('change'));
  } later()`);
  await enter('field-l2', '0.7');
  await enter('field-w1', '-2');
  await see({ caption: 'l₂ = 0.7 m, .* α₂ = 120 degrees, ω₁ = -2 rad/s, ω₂ = 0 rad/s$' });
  await enter('field-l2', '-1');
  await see({ said: '^l2=-1: use a number from 0.001 to 1000 m.$', caption: 'l₂ = 0.7 m' });
  await enter('words', 'file:///page.html#scene=flips&m2=3');
  await see({ scene: 'flips', caption: 'a map of all starts.*; m₁ = 1 kg, m₂ = 3 kg.* m/s²$' });
  assert.ok(await of("at('energy-card').hidden && at('save-numbers').disabled"));
  assert.ok(await of("at('method-card').hidden && at('horizon-card').hidden"));
  await enter('words', '#l1=0.001&l2=10');
  await see({ caption: 'stopped: too fast for this chip; it needs longer rods.* l₁ = 0.001 m' });
  await of("at('words').focus()");
  await press('n');
  await see({ scene: 'page' });

  // The clipboard and files.
  await open('#panel=oled');
  await of("run(29), addEventListener('copy', () => { window.copied = `${getSelection()}`; })");
  await drag(false, 'copy', [[0.5, 0.5]]);
  assert.equal(await of('copied'), '#scene=page&mu=1&angle=120&panel=oled');
  await open('#panel=oled');
  await of('run(29)');
  const saved = (id) => of(`new Promise((done) => {
    URL.createObjectURL = done;
    HTMLAnchorElement.prototype.click = () => {};
    at('${id}').click();
  }).then(async (blob) => ({ type: blob.type, text: await blob.text() }))`);
  const numbers = (await saved('save-numbers')).text.split('\n');
  assert.equal(numbers[0], 't,a1,a2,p1,p2,energy_error,horizon,method,steps');
  assert.equal(numbers.length, 1 + 30 + 1);
  assert.match(numbers[30], /^0.5,1\.\d+,1\.\d+,-?\d.*,[a-z0-9-]+,\d+$/);
  assert.equal((await saved('save-picture')).type, 'image/png');

  // Every width, both schemes, less motion, and a label for every control.
  const widths = [[280, 1], [360, 1], [360, 3], [412, 2.625], [1000, 1.25], [2560, 1]];
  for (const [width, deviceScaleFactor] of widths) {
    const size = { width, height: 900, deviceScaleFactor, mobile: false };
    await call('Emulation.setDeviceMetricsOverride', size);
    await open('');
    assert.ok(await of('document.documentElement.scrollWidth <= innerWidth'), `${width}`);
    const scale = await of("at('panel').getBoundingClientRect().width * devicePixelRatio / at('panel').width");
    assert.ok(scale > 0.9 && Math.abs(scale - Math.round(scale)) < 0.01, `${width}: ${scale}`);
  }
  for (const [value, colour] of [['light', 'rgb(245, 242, 236)'], ['dark', 'rgb(21, 19, 15)']]) {
    await open('', [{ name: 'prefers-color-scheme', value }]);
    assert.equal(await of('getComputedStyle(document.body).backgroundColor'), colour);
  }
  await open('', [{ name: 'prefers-reduced-motion', value: 'reduce' }]);
  await see({ caption: 'paused', said: 'less motion' });
  assert.ok(await of(`[...document.querySelectorAll('input, select')]
    .every((one) => one.labels[0]?.firstChild.textContent.trim())`));

  // No error, no request, and no way to make one.
  const isBad = ({ method, params }) => /exceptionThrown|consoleAPICalled|entryAdded/.test(method)
    || params.request?.url.startsWith(`file://${page}`) === false;
  assert.deepEqual(events.filter(isBad), []);
  assert.ok(events.some(({ method }) => method === 'Network.requestWillBeSent'));
  assert.ok(await of(`new Promise((done) => {
    addEventListener('securitypolicyviolation', () => done(true));
    fetch('https://example.org').catch(() => setTimeout(done, 1000));
  })`));
}

test().catch((error) => {
  console.error(error);
  process.exitCode = 1;
}).finally(() => browser.kill());
