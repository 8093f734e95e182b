// The passes of a frame in WebGL2: project and draw nearest first, in batches; between them find the tiles behind which nothing is seen; present.

import { WIDTH, allocate } from './splats.js';
import * as shaders from './shaders.js';

const TILE = 8; // pixels along a side
const BLOCK = 4; // tiles along a side of a block
const CALL = 16383; // footprints a draw call: 16-bit indices, of which 65,535 would begin a new strip

export class Drawing {
  constructor(gl) {
    this.gl = gl;
    this.format = sumFormat(gl);
    this.programs = {
      splat: [false, true].map((marked) => program(gl, shaders.SPLAT_VERTEX, shaders.splat(marked))),
      cover: [[TILE, 'there.a < .999'], [BLOCK, 'there.r < .5']].map(([side, open]) => program(gl, shaders.FULL, shaders.cover(side, open))),
      present: [false, true].map((marked) => program(gl, shaders.FULL, shaders.present(marked))),
    };
    this.line = null; // around what is selected: its colour
    this.empty = gl.createVertexArray();
    this.quads = gl.createVertexArray();
    gl.bindVertexArray(this.quads);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    const corners = new Uint16Array(6 * CALL);
    for (let i = 0; i < CALL; i++) corners.set([4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 2, 4 * i + 1, 4 * i + 3], 6 * i);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    this.marks = allocate(gl, gl.R8UI, WIDTH, 1);
    this.markCount = 0;
    this.rows = 0;
  }

  // One picture of `splats` from `camera` (Pinhole). list: {order, count}, its sorted slots; line: [red, green, blue] around what is selected, or
  // null; wide: of the line, px; part: the columns of
  // pixels [first, end] to draw, null for all.
  picture(splats, list, camera, line, wide, batches, background, part) {
    const { gl } = this;
    if (this.list !== list) this.setOrder(list);
    this.line = line;
    this.resize(camera.width, camera.height);
    if (part) gl.scissor(part[0], 0, part[1] - part[0], camera.height);
    let from = 0;
    for (const share of [...batches, 1]) {
      const to = share === 1 ? this.count : WIDTH * Math.round((this.count * share) / WIDTH);
      if (to <= from) continue;
      if (from) this.cover();
      this.project(splats, camera, from, to);
      this.blend(from, to, part);
      from = to;
    }
    if (!from) this.blend(0, 0, part);
    if (part) gl.enable(gl.SCISSOR_TEST);
    this.present(background, wide);
    gl.disable(gl.SCISSOR_TEST);
  }

  setOrder(list) {
    const { gl } = this;
    const { order, count } = list;
    this.list = list;
    const rows = Math.max(1, Math.ceil(count / WIDTH));
    if (rows > this.rows) {
      this.rows = Math.ceil(rows * 1.2);
      [this.order, this.place, this.look].forEach((texture) => texture && gl.deleteTexture(texture));
      this.order = allocate(gl, gl.R32UI, WIDTH, this.rows);
      this.place = allocate(gl, gl.RGBA32UI, WIDTH, this.rows);
      this.look = allocate(gl, gl.RGBA32UI, WIDTH, this.rows);
      gl.deleteFramebuffer(this.projected ?? null);
      this.projected = framebuffer(gl, [this.place, this.look]);
    }
    gl.bindTexture(gl.TEXTURE_2D, this.order);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDTH, rows, gl.RED_INTEGER, gl.UNSIGNED_INT, order.subarray(0, rows * WIDTH));
    this.count = count;
  }

  // groups: which are selected.
  setMarks(groups) {
    const { gl } = this;
    const most = Math.max(-1, ...groups);
    const rows = Math.ceil((most + 1) / WIDTH) || 1;
    const bits = new Uint8Array(rows * WIDTH);
    groups.forEach((group) => group >= 0 && (bits[group] = 1));
    gl.deleteTexture(this.marks);
    this.marks = allocate(gl, gl.R8UI, WIDTH, rows);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDTH, rows, gl.RED_INTEGER, gl.UNSIGNED_BYTE, bits);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    this.markCount = most + 1;
  }

  // Footprints of the sorted slots [from, to) as `camera` (Pinhole) sees them; from: a multiple of WIDTH, those before it are drawn.
  project(splats, camera, from, to) {
    const { gl } = this;
    const name = `project${splats.degree}`;
    const { handle, at } = (this.programs[name] ??= program(gl, shaders.FULL, shaders.project(splats.degree)));
    gl.useProgram(handle);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.projected);
    gl.viewport(0, from / WIDTH, WIDTH, Math.ceil((to - from) / WIDTH));
    gl.disable(gl.BLEND);
    const [geometry, shape, paint] = splats.textures;
    const [tiles, blocks] = this.covered.map(({ texture }) => texture);
    bind(gl, at, { order: this.order, geometry, shape, paint, harmonics: splats.harmonics, marks: this.marks, tiles, blocks });
    gl.uniform1i(at.covered, from ? 1 : 0);
    const { right, down, forward } = camera;
    gl.uniformMatrix3fv(at.view, false, [0, 1, 2].flatMap((i) => [right[i], down[i], forward[i]]));
    gl.uniform3fv(at.eye, camera.position);
    gl.uniform4fv(at.tangents, camera.tangents);
    gl.uniform2f(at.size, camera.width, camera.height);
    gl.uniform1f(at.focal, camera.focal);
    gl.uniform1i(at.count, this.count);
    gl.uniform1i(at.marked, this.line ? 1 : 0);
    gl.uniform1i(at.markCount, this.markCount);
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  // Blend the footprints [from, to), nearest first, behind those before them; part: the columns of pixels to draw, null for all.
  blend(from, to, part) {
    const { gl } = this;
    const { handle, at } = this.programs.splat[this.line ? 1 : 0];
    const { width, height, frame } = this.target;
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.viewport(0, 0, width, height);
    if (part) gl.enable(gl.SCISSOR_TEST);
    if (!from) {
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT);
    }
    gl.useProgram(handle);
    bind(gl, at, { places: this.place, looks: this.look });
    gl.uniform2f(at.size, width, height);
    gl.bindVertexArray(this.quads);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE_MINUS_DST_ALPHA, gl.ONE);
    for (let first = from; first < to; first += CALL) {
      gl.uniform1i(at.first, first);
      gl.drawElements(gl.TRIANGLES, 6 * Math.min(CALL, to - first), gl.UNSIGNED_SHORT, 0);
    }
    gl.disable(gl.SCISSOR_TEST);
  }

  // Which tiles of the picture so far, and which blocks of tiles, let nothing behind them be seen.
  cover() {
    const { gl } = this;
    gl.disable(gl.BLEND);
    gl.bindVertexArray(this.empty);
    let from = this.target;
    this.covered.forEach((into, level) => {
      const { handle, at } = this.programs.cover[level];
      gl.useProgram(handle);
      gl.bindFramebuffer(gl.FRAMEBUFFER, into.frame);
      gl.viewport(0, 0, into.width, into.height);
      bind(gl, at, { picture: from.texture });
      gl.uniform2i(at.size, from.width, from.height);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      from = into;
    });
  }

  // The picture over `background` onto the canvas.
  present(background, wide) {
    const { gl } = this;
    const { handle, at } = this.programs.present[this.line ? 1 : 0];
    gl.useProgram(handle);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.BLEND);
    const { texture, marks, width, height } = this.target;
    gl.viewport(0, 0, width, height);
    bind(gl, at, { picture: texture, selection: marks });
    gl.uniform3fv(at.background, background);
    if (this.line) {
      gl.uniform3fv(at.line, this.line);
      gl.uniform1f(at.wide, wide);
      gl.uniform2f(at.size, width, height);
    }
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  resize(width, height) {
    const { gl } = this;
    const marked = Boolean(this.line);
    const now = this.target;
    if (now && now.width === width && now.height === height && Boolean(now.marks) === marked) return;
    [now, ...(this.covered ?? [])].forEach((old) => old && free(gl, old));
    const texture = allocate(gl, this.format, width, height);
    const marks = marked ? allocate(gl, gl.RGBA8, width, height) : null;
    this.target = { texture, marks, frame: framebuffer(gl, marks ? [texture, marks] : [texture]), width, height };
    this.covered = [TILE, TILE * BLOCK].map((side) => {
      const [wide, high] = [width, height].map((size) => Math.ceil(size / side));
      const texture = allocate(gl, gl.R8, wide, high);
      return { texture, frame: framebuffer(gl, [texture]), width: wide, height: high };
    });
  }
}

// The format that colours are summed in. A program that draws on the processor converts 16-bit floats at every step and
// is twice as fast with 32 bits; a graphics card has half the traffic with 16.
function sumFormat(gl) {
  const float = gl.getExtension('EXT_color_buffer_float');
  const told = gl.getExtension('WEBGL_debug_renderer_info');
  const name = told ? gl.getParameter(told.UNMASKED_RENDERER_WEBGL) : '';
  const software = /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  if (software && float && gl.getExtension('EXT_float_blend')) return gl.RGBA32F;
  return float || gl.getExtension('EXT_color_buffer_half_float') ? gl.RGBA16F : gl.RGBA8;
}

function free(gl, { texture, marks, frame }) {
  gl.deleteTexture(texture);
  gl.deleteTexture(marks ?? null);
  gl.deleteFramebuffer(frame);
}

function framebuffer(gl, textures) {
  const frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  textures.forEach((texture, i) => gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, texture, 0));
  gl.drawBuffers(textures.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
  return frame;
}

function program(gl, vertex, fragment) {
  const handle = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(handle, shader);
  }
  gl.linkProgram(handle);
  if (!gl.getProgramParameter(handle, gl.LINK_STATUS) && !gl.isContextLost()) {
    const logs = gl.getAttachedShaders(handle).map((shader) => gl.getShaderInfoLog(shader));
    throw new Error(`a shader does not compile here: ${[gl.getProgramInfoLog(handle), ...logs].join(' ')}`);
  }
  const at = {};
  for (let i = 0; i < gl.getProgramParameter(handle, gl.ACTIVE_UNIFORMS); i++) {
    const { name } = gl.getActiveUniform(handle, i);
    at[name] = gl.getUniformLocation(handle, name);
  }
  return { handle, at };
}

function bind(gl, at, textures) {
  Object.entries(textures).forEach(([name, texture], unit) => {
    if (!texture) return;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    if (at[name]) gl.uniform1i(at[name], unit);
  });
  gl.activeTexture(gl.TEXTURE0);
}
