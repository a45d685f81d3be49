// Opens the page in Chromium, by the DevTools protocol over a pipe, and checks its texts and its
// inputs. The command line names Chromium, its options, the page, and the folder of the pictures.
'use strict';

const assert = require('node:assert/strict');
const { spawn } = require('node:child_process');
const { readFileSync } = require('node:fs');

const [chromium, options, page, pictures] = process.argv.slice(2);
const browser = spawn(chromium, options.split(' '), { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
const [, , , input, output] = browser.stdio;
const [waiting, events] = [[], []];
let [text, sessionId] = ['', undefined];
output.setEncoding('utf8').on('data', (data) => {
  const messages = (text + data).split('\0');
  text = messages.pop();
  for (const message of messages.map((json) => JSON.parse(json))) (waiting[message.id] ?? ((event) => events.push(event)))(message);
});

/** Calls a method of the protocol. */
const call = (method, params) => new Promise((resolve, reject) => {
  const id = waiting.push(({ error, result }) => error ? reject(new Error(`${method}: ${error.message}`)) : resolve(result)) - 1;
  input.write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
});

/** Returns the value of an expression on the page. */
async function of(expression) {
  const { result, exceptionDetails } = await call('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
  assert.equal(exceptionDetails, undefined, expression);
  return result.value;
}

/** Checks the texts of elements, and the values of controls. */
async function see(expected) {
  for (const [id, part] of Object.entries(expected)) assert.match(await of(`at('${id}').value || at('${id}').textContent`), new RegExp(part), id);
}

// The clock of the page, and its canvas as text, as the pictures are.
const SETUP = `
  let time = 0;
  window.requestAnimationFrame = (frame) => { window.frame = frame; };
  window.run = (ticks) => { for (; ticks > 0; ticks--) frame(time += 1000 / 60); };
  window.at = (id) => document.getElementById(id);
  window.picture = () => {
    const colours = JSON.parse(at('facts').textContent).palette.map(String);
    const copy = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    copy.drawImage(at('panel'), 0, 0);
    const { data } = copy.getImageData(0, 0, 128, 64);
    const grey = (_, i) => " .,:;-~=+*oaOX#@"[colours.indexOf(String(data.slice(4 * i, 4 * i + 3)))];
    return Array.from({ length: 128 * 64 }, grey).join('').replace(/.{128}/g, '$&\\n');
  };
  window.later = () => new Promise((done) => setTimeout(() => done(run(1)), 400));`;

/** Opens the page with a link and the settings of a user, and runs its first tick. */
async function open(hash, features = []) {
  await call('Emulation.setEmulatedMedia', { features });
  for (const url of ['about:blank', `file://${page}${hash}`]) await call('Page.navigate', { url });
  await of('new Promise((ready) => { const look = () => window.frame ? ready(run(1)) : setTimeout(look, 5); look(); })');
}

async function press(key) {
  const windowsVirtualKeyCode = { ArrowUp: 38, ArrowDown: 40, ArrowLeft: 37, ArrowRight: 39, Escape: 27, Tab: 9 }[key];
  const text = key === 'Enter' ? '\r' : key.length === 1 ? key : undefined;
  await call('Input.dispatchKeyEvent', { type: 'keyDown', key, text, windowsVirtualKeyCode });
  await call('Input.dispatchKeyEvent', { type: 'keyUp', key, windowsVirtualKeyCode });
  await of('run(1)');
}

/** Presses a mouse button or a finger, moves it and releases it. Places are parts of an element. */
async function drag(isTouch, id, places, between = async () => {}) {
  const { left, top, width, height } = await of(`at('${id}').scrollIntoView({ block: 'center' }), at('${id}').getBoundingClientRect().toJSON()`);
  const send = (mouse, touch, place) => {
    const at = { x: left + place[0] * width, y: top + place[1] * height };
    return isTouch ? call('Input.dispatchTouchEvent', { type: touch, touchPoints: touch === 'touchEnd' ? [] : [at] })
      : call('Input.dispatchMouseEvent', { type: mouse, ...at, button: 'left', clickCount: 1 });
  };
  await send('mousePressed', 'touchStart', places[0]);
  for (const place of places.slice(1)) await send('mouseMoved', 'touchMove', place);
  await between();
  await send('mouseReleased', 'touchEnd', places.at(-1));
  await of('run(1)');
}

async function test() {
  const { targetId } = await call('Target.createTarget', { url: 'about:blank' });
  ({ sessionId } = await call('Target.attachToTarget', { targetId, flatten: true }));
  for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await call(`${domain}.enable`);
  await call('Page.addScriptToEvaluateOnNewDocument', { source: SETUP });

  // Every scene is its picture, pixel by pixel.
  await open('');
  const { scenes } = await of("JSON.parse(at('facts').textContent)");
  for (const { key, name } of scenes) {
    await press(key);
    await see({ scene: `^${key} ${name}$`, caption: `^${name}, playing: ` });
    for (const [ticks, more] of [[60, 59], [240, 180]]) {
      await of(`run(${more})`);
      assert.equal(await of('picture()'), readFileSync(`${pictures}/${name}-${ticks}.txt`, 'utf8'), name);
    }
  }

  // The keys.
  await open('');
  const keys = [['ArrowUp', 'mu-now', '^1.25$'], ['ArrowDown', 'mu-now', '^1$'], ['ArrowRight', 'angle-now', '^121°$'],
    ['ArrowLeft', 'angle-now', '^120°$'], ['p', 'caption', 'paused'], ['.', 'time', '0.03 s'], ['Enter', 'time', '0.00 s'],
    ['p', 'play', 'Pause'], [' ', 'time', '0.02 s'], ['n', 'scene', 'small-0.2'], ['N', 'scene', 'page'],
    ['+', 'caption', 'speed 2:'], ['-', 'caption', 'playing:'], ['-', 'caption', 'speed 0.5:'], ['?', 'keys', 'up, down'],
    ['n', 'scene', 'page'], ['Escape', 'scene', 'page'], ['n', 'scene', 'small'], ['1', 'scene', 'page']];
  for (const [key, id, part] of keys) {
    await press(key);
    await see({ [id]: part });
  }
  for (const key of ['Tab', 'Enter']) await press(key);
  await see({ caption: 'paused, speed 0.5', play: 'Play' });

  // Sliders, selections and buttons, by mouse, finger and keyboard.
  await drag(false, 'mu', [[0.99, 0.5]]);
  await drag(true, 'angle', [[0.5, 0.5], [0.01, 0.5]]);
  await see({ 'mu-now': '^100$', 'angle-now': '^-180°$' });
  await of("at('angle').focus()");
  await press('ArrowRight');
  await drag(true, 'pad', [[0.5, 0.9]]);
  await see({ 'mu-now': '^80$', 'angle-now': '^-179°$' });
  await of("at('method').selectedIndex = 3, at('method').onchange(), run(1)");
  await see({ stepping: '^rk4-fixed32, ' });
  await of("at('processor').selectedIndex = 1, at('processor').dispatchEvent(new Event('change')), later()");
  await see({ board: 'Cortex-M4F' });
  const kept = '#scene=page&mu=80&angle=-179&method=rk4-fixed32&speed=0.5&processor=m4f';
  assert.equal(await of('later().then(() => location.hash)'), kept);

  // Bobs: time stops while one is held, and each turns its own rod.
  await open('#scene=page&mu=2.5&angle=90');
  await drag(false, 'panel', [[92.5 / 128, 0.5], [88.25 / 128, 42 / 64]], async () => {
    await of('run(30)');
    await see({ caption: 'paused', time: '0.00 s', 'angle-now': '^90°, 45°$' });
  });
  await see({ caption: 'playing', time: '0.02 s' });
  await drag(true, 'panel', [[78.25 / 128, 0.5], [0.5, 0.9]]);
  await see({ caption: 'playing', 'angle-now': '^0°, 45°$', 'mu-now': '^2.5$' });
  const scrolls = (x, y) => of(`{ const [target, box] = [at('panel'), at('panel').getBoundingClientRect()];
    const place = { clientX: box.left + ${x} * box.width, clientY: box.top + ${y} * box.height };
    const touches = [new Touch({ identifier: 0, target, ...place })];
    target.dispatchEvent(new TouchEvent('touchstart', { cancelable: true, touches })) }`);
  assert.deepEqual([await scrolls(0.5, 0.72), await scrolls(0.1, 0.5)], [false, true]);

  // The link restores everything. What is wrong in one is reported.
  for (const hash of [kept, '#scene=butterfly&m1=2&m2=3&l1=0.7&g=1.62&a1=10&a2=-20.5&w2=1&processor=m0']) {
    await open(hash);
    assert.equal(await of("at('link').getAttribute('href')"), hash);
  }
  await of("location.hash = '#scene=page&mu=2.5&angle=100'; later()");
  await see({ 'mu-now': '^2.5$', 'angle-now': '^100°$' });
  await open('#scene=nowhere&angle=500');
  await see({ scene: 'page', 'angle-now': '^120°$', said: '^scene=nowhere: use one of page, .* refuses this a1\\.$' });

  // Every width, both schemes, less motion, and a label for every control.
  for (const [width, deviceScaleFactor] of [[360, 1], [360, 3], [412, 2.625], [1000, 1.25], [2560, 1]]) {
    await call('Emulation.setDeviceMetricsOverride', { width, height: 900, deviceScaleFactor, mobile: false });
    await open('');
    assert.ok(await of('document.documentElement.scrollWidth <= innerWidth'), `${width}`);
    const scale = await of("at('panel').getBoundingClientRect().width * devicePixelRatio / 128");
    assert.ok(scale > 1.9 && Math.abs(scale - Math.round(scale)) < 0.01, `${width}: ${scale}`);
  }
  for (const [value, colour] of [['light', 'rgb(245, 242, 236)'], ['dark', 'rgb(21, 19, 15)']]) {
    await open('', [{ name: 'prefers-color-scheme', value }]);
    assert.equal(await of('getComputedStyle(document.body).backgroundColor'), colour);
  }
  await open('', [{ name: 'prefers-reduced-motion', value: 'reduce' }]);
  await see({ caption: 'paused', said: 'less motion' });
  assert.ok(await of("[...document.querySelectorAll('input, select')].every((one) => one.labels[0]?.firstChild.textContent.trim())"));

  // No error, no request, and no way to make one.
  const isBad = ({ method, params }) => /exceptionThrown|consoleAPICalled|entryAdded/.test(method)
    || (method === 'Network.requestWillBeSent' && !params.request.url.startsWith(`file://${page}`));
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
