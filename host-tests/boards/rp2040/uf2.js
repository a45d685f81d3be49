// What a UF2 file puts into flash: blocks of 512 bytes, each with its place and up to 476 bytes.

const MAGIC = [0x0a324655, 0x9e5d5157];

export function flashed(file, base) {
  const blocks = [];
  for (let at = 0; at < file.length; at += 512) {
    if (MAGIC.some((word, index) => file.readUInt32LE(at + 4 * index) !== word)) throw new Error('not a UF2 file');
    const [place, length] = [file.readUInt32LE(at + 12), file.readUInt32LE(at + 16)];
    blocks.push([place - base, file.subarray(at + 32, at + 32 + length)]);
  }
  const image = new Uint8Array(Math.max(...blocks.map(([place, bytes]) => place + bytes.length))).fill(0xff);
  blocks.forEach(([place, bytes]) => image.set(bytes, place));
  return image;
}
