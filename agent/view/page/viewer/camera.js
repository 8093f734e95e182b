// A pinhole camera as in gaussians/camera.py: x right, y down, z forward, pixel centres at +0.5, principal point in the middle.

export const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = (a) => Math.hypot(a[0], a[1], a[2]);
export const unit = (a) => scale(a, 1 / (norm(a) || 1));

// `a` turned about the unit vector `axis` by `angle` radians, counter-clockwise seen from its tip (Rodrigues).
export function turned(a, axis, angle) {
  const c = Math.cos(angle);
  return add(add(scale(a, c), cross(axis, a), Math.sin(angle)), axis, dot(axis, a) * (1 - c));
}

// Tangents beyond the image's edge by this share of its size are clamped in the Jacobian (gaussians/render/convention.py).
const EDGE = 0.15;

export class Pinhole {
  // position, forward, up: world; fov_y: vertical field of view, degrees; width, height: pixels.
  constructor({ position, forward, up, fov_y }, width, height) {
    this.position = position;
    this.width = width;
    this.height = height;
    this.forward = unit(forward);
    let right = cross(this.forward, up);
    if (norm(right) < 1e-6 * Math.max(1, norm(up))) {
      const least = [0, 1, 2].reduce((a, b) => (Math.abs(forward[b]) < Math.abs(forward[a]) ? b : a), 0);
      right = cross(this.forward, [0, 1, 2].map((i) => Number(i === least)));
    }
    this.right = unit(right);
    this.down = cross(this.forward, this.right);
    this.focal = (0.5 * height) / Math.tan((fov_y * Math.PI) / 360);
  }

  // Lowest and highest tangent along x and along y that the Jacobian uses.
  get tangents() {
    const x = ((0.5 + EDGE) * this.width) / this.focal;
    const y = ((0.5 + EDGE) * this.height) / this.focal;
    return [-x, x, -y, y];
  }

  // A world point in camera axes.
  local(point) {
    const toward = add(point, this.position, -1);
    return [dot(toward, this.right), dot(toward, this.down), dot(toward, this.forward)];
  }

  // {x, y} in pixels and the camera depth of a world point; null behind the eye.
  project(point) {
    const [x, y, z] = this.local(point);
    if (!(z > 0)) return null;
    return { x: (this.focal * x) / z + this.width / 2, y: (this.focal * y) / z + this.height / 2, depth: z };
  }

  // The world point at pixel x, y and camera depth `depth`.
  unproject(x, y, depth) {
    const u = ((x - this.width / 2) * depth) / this.focal;
    const v = ((y - this.height / 2) * depth) / this.focal;
    return add(add(add(this.position, this.right, u), this.down, v), this.forward, depth);
  }
}
