// The passes of a frame in WebGL2: project, draw nearest first in batches, close finished pixels between them, present.

import { WIDTH, allocate } from './splats.js';
import * as shaders from './shaders.js';

const CALL = 16384; // footprints a draw call: its 65,536 vertices have 16-bit indices

export class Drawing {
  constructor(gl) {
    this.gl = gl;
    this.float = Boolean(gl.getExtension('EXT_color_buffer_float') || gl.getExtension('EXT_color_buffer_half_float'));
    this.programs = {
      splat: [false, true].map((marked) => program(gl, shaders.SPLAT_VERTEX, shaders.splat(marked))),
      close: [false, true].map((marked) => program(gl, shaders.FULL, shaders.close(marked))),
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
    this.project(splats, camera);
    if (part) {
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(part[0], 0, part[1] - part[0], camera.height);
    }
    this.blend(camera.width, camera.height, batches);
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

  // Footprints of the sorted slots as `camera` (Pinhole) sees them.
  project(splats, camera) {
    const { gl } = this;
    const name = `project${splats.degree}`;
    const { handle, at } = (this.programs[name] ??= program(gl, shaders.FULL, shaders.project(splats.degree)));
    gl.useProgram(handle);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.projected);
    const rows = Math.ceil(this.count / WIDTH);
    gl.viewport(0, 0, WIDTH, rows);
    gl.disable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
    const [geometry, shape, paint] = splats.textures;
    bind(gl, at, { order: this.order, geometry, shape, paint, harmonics: splats.harmonics, marks: this.marks });
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

  // Blend the footprints nearest first. batches: shares of them after which finished pixels are closed.
  blend(width, height, batches) {
    const { gl } = this;
    this.resize(width, height);
    gl.viewport(0, 0, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.targets[0].frame);
    gl.depthMask(true);
    gl.clearColor(0, 0, 0, 0);
    gl.clearDepth(1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    let from = 0;
    for (const share of [...batches, 1]) {
      const to = Math.round(this.count * share);
      if (from) this.close();
      this.splats(from, to);
      from = to;
    }
  }

  splats(from, to) {
    const { gl } = this;
    const { handle, at } = this.programs.splat[this.line ? 1 : 0];
    const { width, height } = this.targets[0];
    gl.useProgram(handle);
    bind(gl, at, { places: this.place, looks: this.look });
    gl.uniform2f(at.size, width, height);
    gl.bindVertexArray(this.quads);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE_MINUS_DST_ALPHA, gl.ONE);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    gl.depthMask(false);
    for (let first = from; first < to; first += CALL) {
      gl.uniform1i(at.first, first);
      gl.drawElements(gl.TRIANGLES, 6 * Math.min(CALL, to - first), gl.UNSIGNED_SHORT, 0);
    }
  }

  close() {
    const { gl } = this;
    const [now, next] = this.targets;
    const { handle, at } = this.programs.close[this.line ? 1 : 0];
    gl.useProgram(handle);
    gl.bindFramebuffer(gl.FRAMEBUFFER, next.frame);
    bind(gl, at, { picture: now.texture, selection: now.marks });
    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.ALWAYS);
    gl.depthMask(true);
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    this.targets.reverse();
  }

  // The picture over `background` onto the canvas.
  present(background, wide) {
    const { gl } = this;
    const { handle, at } = this.programs.present[this.line ? 1 : 0];
    gl.useProgram(handle);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
    const { texture, marks, width, height } = this.targets[0];
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
    const now = this.targets?.[0];
    if (now && now.width === width && now.height === height && Boolean(now.marks) === marked) return;
    this.targets?.forEach(({ texture, marks, frame }) => {
      [texture, marks].forEach((made) => gl.deleteTexture(made));
      gl.deleteFramebuffer(frame);
    });
    gl.deleteRenderbuffer(this.depth ?? null);
    this.depth = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, this.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT16, width, height);
    this.targets = [0, 1].map(() => {
      const texture = allocate(gl, this.float ? gl.RGBA16F : gl.RGBA8, width, height);
      const marks = marked ? allocate(gl, gl.RGBA8, width, height) : null;
      const frame = framebuffer(gl, marks ? [texture, marks] : [texture]);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.depth);
      return { texture, marks, frame, width, height };
    });
  }
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
