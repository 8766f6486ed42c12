"use strict";
// The first view: from where the pressed surfaces are seen, and which bodies stand in front of them.

const SIGHT = { grid: 72, samples: 400, near: 0.012, hides: 0.15, enough: 0.35, work: 1.5e6 };

// Points of the contactors that are pressed: place, normal, weight.
function pressedSamples(view, step, top) {
  const found = [];
  for (const part of view.sides.filter((s) => s.item.role === "contactor")) {
    const p = part.field(step, "pressure"), x = part.moved(step, view.data.finite ? 1 : 0), n = unpack(part.item.normals);
    for (let i = 0; i < p.length; i++) {
      if (!(p[i] > 0.05 * top)) continue;
      found.push({ x: x.subarray(3 * i, 3 * i + 3), n: n.subarray(3 * i, 3 * i + 3), weight: Math.min(p[i], top) });
    }
  }
  const every = Math.ceil(found.length / SIGHT.samples);
  return found.filter((_, i) => i % every === 0);
}

// How near the frontmost of some triangles is in each square of a grid, seen from a direction.
function depths(parts, step, frame) {
  const { grid } = SIGHT, near = new Float32Array(grid * grid).fill(-Infinity);
  for (const part of parts) {
    const x = part.moved(step, frame.scale), count = x.length / 3, own = new Float32Array(3 * count);
    for (let i = 0; i < count; i++) own.set(frame.at(x, 3 * i), 3 * i);
    const index = part.corners;
    for (let t = 0; t < index.length; t += 3) {
      const [a, b, c] = [3 * index[t], 3 * index[t + 1], 3 * index[t + 2]];
      const area = (own[b] - own[a]) * (own[c + 1] - own[a + 1]) - (own[c] - own[a]) * (own[b + 1] - own[a + 1]);
      if (Math.abs(area) < 1e-9) continue;
      const low = (k) => Math.max(0, Math.ceil(Math.min(own[a + k], own[b + k], own[c + k]) - 0.5));
      const high = (k) => Math.min(grid - 1, Math.floor(Math.max(own[a + k], own[b + k], own[c + k]) - 0.5));
      const [u0, u1, v0, v1] = [low(0), high(0), low(1), high(1)];
      for (let v = v0; v <= v1; v++) {
        for (let u = u0; u <= u1; u++) {
          const [p, q] = [u + 0.5, v + 0.5];
          const s = ((p - own[a]) * (own[c + 1] - own[a + 1]) - (own[c] - own[a]) * (q - own[a + 1])) / area;
          const r = ((own[b] - own[a]) * (q - own[a + 1]) - (p - own[a]) * (own[b + 1] - own[a + 1])) / area;
          if (s < 0 || r < 0 || s + r > 1) continue;
          const depth = own[a + 2] + s * (own[b + 2] - own[a + 2]) + r * (own[c + 2] - own[a + 2]);
          if (depth > near[v * grid + u]) near[v * grid + u] = depth;
        }
      }
    }
  }
  return near;
}

// The share of the pressed points, by weight, that face a direction and are not behind some parts.
function seenShare(parts, step, samples, frame) {
  const near = parts.length ? depths(parts, step, frame) : null, { grid } = SIGHT;
  let seen = 0, all = 0;
  for (const sample of samples) {
    all += sample.weight;
    if (frame.facing(sample.n) < 0.08) continue;
    const [u, v, depth] = frame.at(sample.x, 0);
    const [i, k] = [u, v].map((w) => Math.min(grid - 1, Math.max(0, Math.floor(w))));
    if (!near || near[k * grid + i] < depth + SIGHT.near * frame.size) seen += sample.weight;
  }
  return all > 0 ? seen / all : 0;
}

function frameOf(view, from) {
  const right = new THREE.Vector3(0, 0, 1).cross(from);
  if (right.length() < 1e-6) right.set(1, 0, 0);
  const up = from.clone().cross(right.normalize()), c = view.centre, factor = SIGHT.grid / (1.02 * view.size), half = 0.5 * SIGHT.grid;
  return {
    size: view.size, scale: view.data.finite ? 1 : 0,
    facing: (n) => n[0] * from.x + n[1] * from.y + n[2] * from.z,
    at: (x, k) => {
      const [dx, dy, dz] = [x[k] - c.x, x[k + 1] - c.y, x[k + 2] - c.z];
      return [half + factor * (dx * right.x + dy * right.y + dz * right.z), half + factor * (dx * up.x + dy * up.y + dz * up.z), dx * from.x + dy * from.y + dz * from.z];
    },
  };
}

// Where to look from, bodies to fade, and whether a section is needed, for the contact to be seen.
function sight(view, step, top) {
  const samples = pressedSamples(view, step, top);
  if (!samples.length) return null;
  const pressed = new Set(view.sides.filter((s) => s.item.role === "contactor").map((s) => s.item.body));
  const own = [...view.bodies.filter((b) => pressed.has(b.item.number)), ...view.sides.filter((s) => s.item.role === "contactor")];
  const triangles = own.reduce((n, p) => n + p.corners.length / 3, 0), directions = [view.from.clone()];
  for (const z of [0.62, 0.2, -0.62]) {
    for (let i = 0; i < 8; i++) directions.push(new THREE.Vector3(Math.cos(0.4 + (i * Math.PI) / 4), Math.sin(0.4 + (i * Math.PI) / 4), z).normalize());
  }
  directions.length = Math.max(5, Math.min(directions.length, Math.floor(SIGHT.work / Math.max(triangles, 1))));
  let best = null;
  for (const from of directions) {
    const share = seenShare(own, step, samples, frameOf(view, from));
    const score = share + 0.12 * from.dot(view.from) + (from.z > 0 ? 0.08 : 0);
    if (!best || score > best.score) best = { from, share, score };
  }
  const frame = frameOf(view, best.from);
  best.fade = view.bodies.filter((b) => !pressed.has(b.item.number) && seenShare([b], step, samples, frame) < seenShare([], step, samples, frame) - SIGHT.hides).map((b) => b.item.number);
  best.cut = best.share < SIGHT.enough;
  return best;
}
