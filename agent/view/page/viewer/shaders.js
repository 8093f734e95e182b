// The shaders. `PROJECT` turns the sorted slots into footprints in the image, one texel each; `SPLAT` draws these nearest first;
// `COVER` finds the tiles behind which nothing can be seen; `PRESENT` puts the result over the background.
// The convention is that of gaussians/render/convention.py, the harmonics those of gaussians/harmonics.py.

const HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
`;

export const FULL = `${HEAD}
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3. : -1., gl_VertexID == 2 ? 3. : -1., 0., 1.);
}`;

// Output place: centre (px, from the top left), long half axis (px, to alpha 1/255); look: short by long axis, red|green, blue|1 if it is selected,
// logarithm (base 2) of the opacity, which is far below zero where nothing is to be drawn.
export const project = (degree) => `${HEAD}
#define DEGREE ${degree}
uniform usampler2D order, geometry, shape, paint, harmonics, marks;
uniform sampler2D tiles, blocks; // of 8 and of 32 pixels a side: 1 where what is behind cannot be seen
uniform bool covered; // whether they are to be looked at
uniform mat3 view; // world to camera
uniform vec3 eye;
uniform vec4 tangents; // lowest and highest along x, along y
uniform vec2 size;
uniform float focal;
uniform int count, markCount;
uniform bool marked;
layout(location = 0) out uvec4 place;
layout(location = 1) out uvec4 look;

const float ALPHA_MIN = 1. / 255., DILATION = .3, MAX_DETERMINANT = 1e37;

mat3 matrix(vec4 q) { // of a unit quaternion wxyz
  float w = q.x, x = q.y, y = q.z, z = q.w;
  return mat3(
    1. - 2. * (y * y + z * z), 2. * (x * y + w * z), 2. * (x * z - w * y),
    2. * (x * y - w * z), 1. - 2. * (x * x + z * z), 2. * (y * z + w * x),
    2. * (x * z + w * y), 2. * (y * z - w * x), 1. - 2. * (x * x + y * y));
}

// Two int16 in a word.
vec2 integers(uint word) { return vec2(int(word << 16) >> 16, int(word) >> 16); }

#if DEGREE > 0
// Two coefficients from three words, times their basis functions.
vec3 two(uint a, uint b, uint c, float first, float second) {
  vec2 left = unpackHalf2x16(a), middle = unpackHalf2x16(b), right = unpackHalf2x16(c);
  return first * vec3(left, middle.x) + second * vec3(middle.y, right);
}

vec3 bands(int slot, vec3 d) {
  float x = d.x, y = d.y, z = d.z;
  const int TEXELS = DEGREE == 1 ? 2 : DEGREE == 2 ? 3 : 6;
  ivec2 at = ivec2((slot & 511) * TEXELS, slot >> 9);
  uvec4 s = texelFetch(harmonics, at, 0), t = texelFetch(harmonics, at + ivec2(1, 0), 0);
  vec3 sum = two(s.x, s.y, s.z, -.4886025119 * y, .4886025119 * z);
#if DEGREE == 1
  return sum + two(s.w, t.x, 0u, -.4886025119 * x, 0.);
#else
  float xx = x * x, yy = y * y, zz = z * z;
  uvec4 u = texelFetch(harmonics, at + ivec2(2, 0), 0);
  sum += two(s.w, t.x, t.y, -.4886025119 * x, 1.0925484306 * x * y);
  sum += two(t.z, t.w, u.x, -1.0925484306 * y * z, .3153915653 * (2. * zz - xx - yy));
  sum += two(u.y, u.z, u.w, -1.0925484306 * x * z, .5462742153 * (xx - yy));
#if DEGREE > 2
  uvec4 v = texelFetch(harmonics, at + ivec2(3, 0), 0), w = texelFetch(harmonics, at + ivec2(4, 0), 0),
    q = texelFetch(harmonics, at + ivec2(5, 0), 0);
  sum += two(v.x, v.y, v.z, -.5900435899 * y * (3. * xx - yy), 2.8906114426 * x * y * z);
  sum += two(v.w, w.x, w.y, -.4570457995 * y * (4. * zz - xx - yy), .3731763326 * z * (2. * zz - 3. * xx - 3. * yy));
  sum += two(w.z, w.w, q.x, -.4570457995 * x * (4. * zz - xx - yy), 1.4453057213 * z * (xx - yy));
  sum += two(q.y, q.z, 0u, -.5900435899 * x * (xx - 3. * yy), 0.);
#endif
  return sum;
#endif
}
#endif

// Whether all tiles are covered that pixels [low, high] of the picture (from its lower left) touch; false for large footprints.
bool hidden(vec2 low, vec2 high) {
  vec2 reach = high - low;
  if (max(reach.x, reach.y) > 64.) return false;
  bool fine = max(reach.x, reach.y) <= 16.;
  int side = fine ? 8 : 32;
  ivec2 first = ivec2(low) / side, last = ivec2(high) / side;
  for (int y = first.y; y <= last.y; y++) {
    for (int x = first.x; x <= last.x; x++) {
      if ((fine ? texelFetch(tiles, ivec2(x, y), 0) : texelFetch(blocks, ivec2(x, y), 0)).x < .5) return false;
    }
  }
  return true;
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  place = uvec4(0u);
  look = uvec4(0u, 0u, 0u, floatBitsToUint(-100.));
  if (texel.y * 1024 + texel.x >= count) return;
  int slot = int(texelFetch(order, texel, 0).x);
  ivec2 at = ivec2(slot & 1023, slot >> 10);
  uvec4 g = texelFetch(geometry, at, 0), s = texelFetch(shape, at, 0);
  uvec2 c = texelFetch(paint, at, 0).xy;

  vec3 toward = uintBitsToFloat(g.xyz) - eye;
  vec3 local = view * toward;
  float z = local.z;
  vec2 t = local.xy / z;
  vec2 clamped = clamp(t, tangents.xz, tangents.yw);

  vec2 logs = unpackHalf2x16(s.z);
  vec3 scales = exp(vec3(logs, unpackHalf2x16(s.w).x));
  float opacity = float(s.w >> 16) / 65535.;
  mat3 axes = view * matrix(normalize(vec4(integers(s.x), integers(s.y))));
  vec3 depth = vec3(axes[0].z, axes[1].z, axes[2].z);
  // p, q: the principal axes seen along x and along y (reference.py, _footprint).
  vec3 p = (focal / z) * scales * (vec3(axes[0].x, axes[1].x, axes[2].x) - clamped.x * depth);
  vec3 q = (focal / z) * scales * (vec3(axes[0].y, axes[1].y, axes[2].y) - clamped.y * depth);
  float xx = dot(p, p), xy = dot(p, q), yy = dot(q, q);
  vec3 minors = cross(p, q);
  float determinant = dot(minors, minors) + DILATION * (xx + yy) + DILATION * DILATION;
  if (!(determinant < MAX_DETERMINANT) || opacity <= ALPHA_MIN) return;
  xx += DILATION;
  yy += DILATION;

  float mean = .5 * (xx + yy), half_ = .5 * (xx - yy);
  float large = mean + sqrt(half_ * half_ + xy * xy);
  float small = determinant / large;
  vec2 axis = half_ > 0. ? vec2(large - yy, xy) : vec2(xy, large - xx); // the longer of two eigenvectors
  axis = dot(axis, axis) > 0. ? normalize(axis) : vec2(1., 0.);
  float reach = sqrt(2. * log(opacity / ALPHA_MIN));
  vec2 centre = t * focal + .5 * size;
  vec2 box = reach * sqrt(vec2(xx, yy));
  if (any(lessThan(centre + box, vec2(0.))) || any(greaterThan(centre - box, size))) return;
  vec2 middle = vec2(centre.x, size.y - centre.y);
  if (covered && hidden(clamp(middle - box, vec2(0.), size - 1.), clamp(middle + box, vec2(0.), size - 1.))) return;

  vec3 color = .28209479177 * vec3(unpackHalf2x16(c.x), unpackHalf2x16(c.y).x) + .5;
#if DEGREE > 0
  color += bands(slot, normalize(toward));
#endif
  color = max(color, 0.);
  bool selected = false;
  if (marked) {
    int group = int(g.w);
    selected = (c.y & 65536u) != 0u;
    if (group >= 0 && group < markCount) selected = selected || texelFetch(marks, ivec2(group & 1023, group >> 10), 0).x != 0u;
  }
  vec2 along = axis * sqrt(large) * reach;
  place = floatBitsToUint(vec4(centre, along));
  look = uvec4(floatBitsToUint(sqrt(small / large)), packHalf2x16(color.rg), packHalf2x16(vec2(color.b, selected ? 1. : 0.)),
    floatBitsToUint(log2(opacity)));
}`;

// Four corners a footprint, 16,383 footprints a call (its indices have 16 bits); first: number of the call's first footprint.
export const SPLAT_VERTEX = `${HEAD}
uniform usampler2D places, looks;
uniform int first;
uniform vec2 size;
flat out vec4 paint; // red, green, blue, logarithm of the opacity
flat out float selected;
out vec2 offset; // in units of which the square is taken from that logarithm
void main() {
  int number = first + (gl_VertexID >> 2);
  ivec2 at = ivec2(number & 1023, number >> 10);
  uvec4 look = texelFetch(looks, at, 0);
  float opacity = uintBitsToFloat(look.w);
  if (opacity < -10.) {
    gl_Position = vec4(2., 2., 2., 1.);
    return;
  }
  vec4 place = uintBitsToFloat(texelFetch(places, at, 0));
  vec2 corner = vec2(float((gl_VertexID & 1) * 2 - 1), float((gl_VertexID & 2) - 1));
  vec2 across = vec2(-place.w, place.z) * uintBitsToFloat(look.x);
  vec2 pixel = place.xy + corner.x * place.zw + corner.y * across;
  gl_Position = vec4(pixel.x / size.x * 2. - 1., 1. - pixel.y / size.y * 2., 0., 1.);
  offset = corner * sqrt(opacity + 7.994353437); // log2(255)
  vec2 rest = unpackHalf2x16(look.z);
  paint = vec4(unpackHalf2x16(look.y), rest.x, opacity);
  selected = rest.y;
}`;

// With `marked` a second target takes the share of each pixel that is selected, beside an alpha of its own, which blending needs.
export const splat = (marked) => `${HEAD}
flat in vec4 paint;
flat in float selected;
in vec2 offset;
layout(location = 0) out vec4 result;
${marked ? 'layout(location = 1) out vec4 mark;' : ''}
void main() {
  float alpha = min(exp2(paint.w - dot(offset, offset)), .999);
  alpha = alpha < 1. / 255. ? 0. : alpha;
  result = vec4(paint.rgb * alpha, alpha);
  ${marked ? 'mark = vec4(selected * alpha, 0., 0., alpha);' : ''}
}`;

// 1 where all of a square of `side` texels of the picture is finished: what is behind changes an 8-bit value by a quarter of a step at most.
// open: whether the texel `there` is not finished.
export const cover = (side, open) => `${HEAD}
uniform sampler2D picture;
uniform ivec2 size; // of the picture
layout(location = 0) out vec4 result;
void main() {
  result = vec4(0.);
  ivec2 first = ivec2(gl_FragCoord.xy) * ${side}, last = min(first + ${side}, size);
  for (int y = first.y; y < last.y; y++) {
    for (int x = first.x; x < last.x; x++) {
      vec4 there = texelFetch(picture, ivec2(x, y), 0);
      if (${open}) return;
    }
  }
  result = vec4(1.);
}`;

// Over the background; with `marked` a line runs just outside what is selected, whose own colours stay as they are.
export const present = (marked) => `${HEAD}
uniform sampler2D picture, selection;
uniform vec3 background, line;
uniform float wide; // of the line, px
uniform vec2 size;
out vec4 result;
bool inside(ivec2 at) { return texelFetch(selection, clamp(at, ivec2(0), ivec2(size) - 1), 0).r > .5; }
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 drawn = texelFetch(picture, at, 0);
  vec3 color = drawn.rgb + (1. - drawn.a) * background;
${marked ? `  if (!inside(at)) {
    bool near = false;
    for (int i = 0; i < 16; i++) {
      float turn = float(i) * .39269908;
      near = near || inside(at + ivec2(round(wide * vec2(cos(turn), sin(turn)))));
    }
    if (near) color = line;
  }` : ''}
  result = vec4(color, 1.);
}`;
