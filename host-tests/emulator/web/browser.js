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

// The clock of the page, and the colours on its canvas, each as one number.
const SETUP = `
  let time = 0;
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

const OLED = '#scene=page&processor=m3&panel=oled';

async function test() {
  const { targetId } = await call('Target.createTarget', { url: 'about:blank' });
  ({ sessionId } = await call('Target.attachToTarget', { targetId, flatten: true }));
  for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await call(`${domain}.enable`);
  await call('Page.addScriptToEvaluateOnNewDocument', { source: SETUP });

  // Every scene is its picture, pixel by pixel.
  await open(OLED);
  const { scenes, palette, panels } = await of("JSON.parse(at('facts').textContent)");
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
  await choose('processor', 2);
  await see({ board: 'Cortex-M4F' });
  const kept = '#scene=page&mu=80&angle=-179&method=rk4-fixed32&speed=0.5&processor=m4f&panel=oled';
  assert.equal(await of('later().then(() => location.hash)'), kept);

  // Bobs: time stops while one is held, and each turns its own rod.
  await open('#scene=page&mu=2.5&angle=90&panel=oled');
  await drag(false, 'panel', [[92.5 / 128, 0.5], [88.25 / 128, 42 / 64]], `run(30);
    window.held = ['caption', 'time', 'angle-now'].map((id) => at(id).textContent).join('|')`);
  assert.match(await of('held'), /paused.*\|0\.00 s\|90°, 45°$/);
  await see({ caption: 'playing', time: '0.02 s' });
  await drag(true, 'panel', [[78.25 / 128, 0.5], [0.5, 0.9]]);
  await see({ caption: 'playing', 'angle-now': '^0°, 45°$', 'mu-now': '^2.5$' });
  const scrolls = (x, y) => of(`{
    const { left, top, width, height } = at('panel').getBoundingClientRect();
    const place = { clientX: left + ${x} * width, clientY: top + ${y} * height };
    const touches = [new Touch({ identifier: 0, target: at('panel'), ...place })];
    at('panel').dispatchEvent(new TouchEvent('touchstart', { cancelable: true, touches }));
  }`);
  assert.deepEqual([await scrolls(0.5, 0.72), await scrolls(0.1, 0.5)], [false, true]);

  // The link restores everything. What is wrong in one is reported.
  const other = '#scene=butterfly&m1=2&m2=3&l1=0.7&g=1.62&a1=10&a2=-20.5&w2=1&processor=m3';
  for (const hash of [kept, other]) {
    await open(hash);
    assert.equal(await of("at('link').getAttribute('href')"), hash);
  }
  await of("location.hash = '#scene=page&mu=2.5&angle=100'; later()");
  await see({ 'mu-now': '^2.5$', 'angle-now': '^100°$' });
  await open('#scene=nowhere&angle=500&mu=');
  const reasons = '^scene=nowhere: use one of page, .* mu=: write a number. .* refuses this a1\\.$';
  await see({ scene: 'page', 'angle-now': '^120°$', said: reasons });

  // Every width, both schemes, less motion, and a label for every control.
  const widths = [[360, 1], [360, 3], [412, 2.625], [1000, 1.25], [2560, 1]];
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
