// The Gaussians of a scene by slot: columns in data textures, written by ranges of rows, with copies for sorting and picking.

import { half } from './decode.js';

export const WIDTH = 1024; // slots in a row of a texture
const HARMONIC_WIDTH = 512; // so that a row of six texels a slot fits every GPU
const TEXELS = [0, 2, 3, 6]; // of 8 halves each, for the 3 (K - 1) coefficients of a degree
export const SELECTED = 1; // a bit of a slot's flags, and of a group's
export const NO_GROUP = -1;

export class Splats {
  // slots: how many there are; degree: of the harmonics.
  constructor(gl, slots, degree) {
    this.gl = gl;
    this.degree = degree;
    this.slots = 0;
    this.capacity = 0;
    this.grow(slots);
  }

  // Make room for `slots`; new ones are empty.
  grow(slots) {
    this.slots = Math.max(this.slots, slots);
    if (slots <= this.capacity) return;
    const rows = Math.ceil((this.capacity ? slots * 1.25 : slots) / WIDTH) || 1;
    const limit = this.gl.getParameter(this.gl.MAX_TEXTURE_SIZE);
    if (limit !== null && 2 * rows > limit) throw new Error(`this browser draws at most ${(limit / 2) * WIDTH} Gaussians, not ${slots}`);
    this.capacity = rows * WIDTH;
    const wider = (Type, each, old) => {
      const array = new Type(each * this.capacity);
      if (old) array.set(old);
      return array;
    };
    // Four 32-bit words a slot each, as the shaders read them. geometry: position (float32), group. shape: quaternion
    // (4 int16), logarithms of the scales (3 float16), opacity (uint16). paint: band 0 (3 float16), flags (uint16).
    this.geometry = wider(Uint32Array, 4, this.geometry);
    this.shape = wider(Uint32Array, 4, this.shape);
    this.paint = wider(Uint32Array, 2, this.paint);
    this.radius = wider(Float32Array, 1, this.radius); // scene units, beyond it alpha is below 1/255; 0: nothing to draw
    this.position = new Float32Array(this.geometry.buffer);
    this.group = new Int32Array(this.geometry.buffer);
    this.shape16 = new Uint16Array(this.shape.buffer);
    this.turn16 = new Int16Array(this.shape.buffer);
    this.paint16 = new Uint16Array(this.paint.buffer);
    this.bands = wider(Uint32Array, 4 * TEXELS[this.degree], this.bands);
    this.store();
  }

  // Textures of everything, from the copies here.
  store() {
    const { gl } = this;
    const rows = this.capacity / WIDTH;
    this.textures?.forEach((texture) => gl.deleteTexture(texture));
    this.textures = [gl.RGBA32UI, gl.RGBA32UI, gl.RG32UI].map((format) => allocate(gl, format, WIDTH, rows));
    for (let i = 0; i < 3; i++) this.upload(i, 0, this.capacity);
    if (this.harmonics) gl.deleteTexture(this.harmonics);
    this.harmonics = allocate(gl, gl.RGBA32UI, Math.max(1, HARMONIC_WIDTH * TEXELS[this.degree]), this.degree ? 2 * rows : 1);
    if (this.degree) this.uploadHarmonics(0, this.capacity);
  }

  // Write the rows `bytes` of a column into the ranges [[first, count], ...] of slots.
  write(column, ranges, bytes) {
    const last = ranges.length ? ranges[ranges.length - 1] : [0, 0];
    this.grow(last[0] + last[1]);
    const size = column === 'harmonics' ? 6 * ((this.degree + 1) ** 2 - 1) : { position: 12, shape: 14, color: 8, group: 4 }[column];
    if (!size) throw new Error(`unknown column ${column}`);
    const words = bytes.byteOffset % 4 ? bytes.slice() : bytes;
    let at = 0;
    for (const [first, count] of ranges) {
      const part = words.subarray(at, at + count * size);
      if (part.length < count * size) throw new Error(`too few bytes for ${column}`);
      this[`${column}Rows`](first, count, part.byteOffset % 4 ? part.slice() : part);
      at += count * size;
    }
  }

  positionRows(first, count, bytes) {
    const from = new Uint32Array(bytes.buffer, bytes.byteOffset, 3 * count);
    for (let i = 0, to = 4 * first; i < 3 * count; i += 3, to += 4) {
      this.geometry[to] = from[i];
      this.geometry[to + 1] = from[i + 1];
      this.geometry[to + 2] = from[i + 2];
    }
    this.upload(0, first, count);
  }

  shapeRows(first, count, bytes) {
    const from = new Uint16Array(bytes.buffer, bytes.byteOffset, 7 * count);
    for (let i = 0, to = 8 * first; i < 7 * count; i += 7, to += 8) {
      for (let k = 0; k < 7; k++) this.shape16[to + k] = from[i + k];
    }
    this.upload(1, first, count);
  }

  colorRows(first, count, bytes) {
    const from = new Uint16Array(bytes.buffer, bytes.byteOffset, 4 * count);
    for (let i = 0, to = 4 * first; i < 4 * count; i += 4, to += 4) {
      this.paint16[to] = from[i];
      this.paint16[to + 1] = from[i + 1];
      this.paint16[to + 2] = from[i + 2];
      this.shape16[2 * to + 7] = from[i + 3];
    }
    this.upload(1, first, count);
    this.upload(2, first, count);
  }

  groupRows(first, count, bytes) {
    const from = new Int32Array(bytes.buffer, bytes.byteOffset, count);
    for (let i = 0; i < count; i++) this.group[4 * (first + i) + 3] = from[i];
    this.upload(0, first, count);
  }

  harmonicsRows(first, count, bytes) {
    const texels = TEXELS[this.degree];
    const halves = 3 * ((this.degree + 1) ** 2 - 1);
    const from = new Uint16Array(bytes.buffer, bytes.byteOffset, halves * count);
    const to = new Uint16Array(this.bands.buffer);
    for (let i = 0; i < count; i++) to.set(from.subarray(halves * i, halves * (i + 1)), 8 * texels * (first + i));
    this.uploadHarmonics(first, count);
  }

  uploadHarmonics(first, count) {
    const { gl } = this;
    const texels = TEXELS[this.degree];
    gl.bindTexture(gl.TEXTURE_2D, this.harmonics);
    for (const [x, y, wide, high, start] of rectangles(first, count, HARMONIC_WIDTH)) {
      const part = this.bands.subarray(4 * texels * start, 4 * texels * (start + wide * high));
      gl.texSubImage2D(gl.TEXTURE_2D, 0, x * texels, y, wide * texels, high, gl.RGBA_INTEGER, gl.UNSIGNED_INT, part);
    }
  }

  // Copy those of `slots` that there are to as many from `first` on; they do not count as slots.
  copy(slots, first) {
    const { slots: count } = this;
    this.grow(first + slots.length);
    this.slots = count;
    const each = [[this.geometry, 4], [this.shape, 4], [this.paint, 2], [this.bands, 4 * TEXELS[this.degree]]];
    for (const [array, size] of each) {
      slots.forEach((slot, i) => slot < count && array.copyWithin(size * (first + i), size * slot, size * (slot + 1)));
    }
    for (let i = 0; i < 3; i++) this.upload(i, first, slots.length);
    if (this.degree) this.uploadHarmonics(first, slots.length);
  }

  // Set the flags of all slots: `bit` in the ranges, cleared elsewhere.
  flag(bit, ranges) {
    for (let i = 3; i < 4 * this.slots; i += 4) this.paint16[i] &= ~bit;
    for (const [first, count] of ranges) {
      for (let i = first; i < Math.min(first + count, this.slots); i++) this.paint16[4 * i + 3] |= bit;
    }
    this.upload(2, 0, this.slots);
  }

  free() {
    [...this.textures, this.harmonics].forEach((texture) => this.gl.deleteTexture(texture));
  }

  upload(index, first, count) {
    const { gl } = this;
    const [array, format, each] = [
      [this.geometry, gl.RGBA_INTEGER, 4],
      [this.shape, gl.RGBA_INTEGER, 4],
      [this.paint, gl.RG_INTEGER, 2],
    ][index];
    gl.bindTexture(gl.TEXTURE_2D, this.textures[index]);
    for (const [x, y, wide, high, start] of rectangles(first, count, WIDTH)) {
      const part = array.subarray(each * start, each * (start + wide * high));
      gl.texSubImage2D(gl.TEXTURE_2D, 0, x, y, wide, high, format, gl.UNSIGNED_INT, part);
    }
  }

  // What the sorting worker must know of a range of slots: position, radius and group; five 32-bit words a slot, the last an integer.
  extents(first, count) {
    const found = new Float32Array(5 * count);
    const groups = new Int32Array(found.buffer);
    for (let i = 0, slot = first; i < count; i++, slot++) {
      const opacity = Math.min(1, this.shape16[8 * slot + 7] / 65535);
      const largest = Math.exp(
        Math.max(half(this.shape16[8 * slot + 4]), half(this.shape16[8 * slot + 5]), half(this.shape16[8 * slot + 6])),
      );
      found[5 * i] = this.position[4 * slot];
      found[5 * i + 1] = this.position[4 * slot + 1];
      found[5 * i + 2] = this.position[4 * slot + 2];
      this.radius[slot] = opacity > 1 / 255 ? largest * Math.sqrt(2 * Math.log(255 * opacity)) : 0;
      found[5 * i + 3] = this.radius[slot];
      groups[5 * i + 4] = this.group[4 * slot + 3];
    }
    return found;
  }
}

export function allocate(gl, format, width, height) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return texture;
}

// A range of slots as at most three rectangles [x, y, width, height, first slot] of a texture `wide` slots wide.
export function rectangles(first, count, wide) {
  const found = [];
  let at = first;
  const end = first + count;
  while (at < end) {
    const x = at % wide;
    const whole = x === 0 ? Math.floor((end - at) / wide) : 0;
    const width = whole ? wide : Math.min(wide - x, end - at);
    const height = whole || 1;
    found.push([x, Math.floor(at / wide), width, height, at]);
    at += width * height;
  }
  return found;
}
