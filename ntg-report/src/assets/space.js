// Tracks in space: a picture that turns, with the ground, zones, balls and places that they pass.
"use strict";
function NtgSpace(place, chart, { colour, dash, number, told, css }) {
  const canvas = place.appendChild(document.createElement("canvas"));
  canvas.className = "space"; canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `${chart.axes.join(", ")} in space; arrow keys turn the picture`);
  const legend = place.appendChild(document.createElement("div"));
  legend.className = "maplegend";
  const context = canvas.getContext("2d");
  const finite = (p) => p.every((v) => v != null && isFinite(v));
  const tracks = chart.lines.map((line) => line.x.map((x, i) => [x, line.y[i], line.z[i]]));

  // A box around the tracks, and what lies near them.
  const box = [0, 1, 2].map((k) => { const v = tracks.flat().filter(finite).map((p) => p[k]); return [Math.min(...v), Math.max(...v)]; });
  // Without units, lengths that differ by orders of magnitude are of different kinds.
  const lengths = box.map(([a, b]) => b - a), alike = chart.equal && lengths[2] < 30 * Math.max(lengths[0], lengths[1]);
  const extent = Math.max(...(alike ? lengths : lengths.slice(0, 2))) || 1;
  const near = (p) => p.every((v, k) => v == null || (v >= box[k][0] - 0.5 * extent && v <= box[k][1] + 0.5 * extent));
  const grow = (p) => p.forEach((v, k) => { if (v != null) box[k] = [Math.min(box[k][0], v), Math.max(box[k][1], v)]; });
  chart.places.forEach(([, at]) => { if (near(at)) grow(at); });
  for (const ball of chart.balls) for (const sign of [1, -1]) for (const half of ball.half) { const p = ball.centre.map((c, k) => c + sign * half[k]); if (near(p)) grow(p); }
  for (const outline of chart.outlines) if (outline.out) outline.lines.flat().forEach(([x, y]) => { if (near([x, y, null])) grow([x, y, null]); });
  // The ground belongs to the picture where a track is over it.
  const height = (surface, x, y) => {
    const cell = (lines, v) => { const n = lines.length - 1, s = (v - lines[0]) / (lines[n] - lines[0]) * n; return s < 0 || s > n ? null : [Math.min(Math.floor(s), n - 1), s]; };
    const i = cell(surface.x, x), j = cell(surface.y, y), ny = surface.y.length;
    if (!i || !j) return null;
    const u = i[1] - i[0], v = j[1] - j[0], z = (a, b) => surface.z[a * ny + b];
    const corners = [z(i[0], j[0]), z(i[0], j[0] + 1), z(i[0] + 1, j[0]), z(i[0] + 1, j[0] + 1)];
    return corners.some((c) => c == null) ? null : (1 - u) * ((1 - v) * corners[0] + v * corners[1]) + u * ((1 - v) * corners[2] + v * corners[3]);
  };
  const reach = alike ? extent : 2 * (lengths[2] || 1), [bottom, top] = box[2];
  for (const surface of chart.surfaces.filter((s) => s.floor)) {
    for (const p of tracks.flat()) {
      const z = finite(p) ? height(surface, p[0], p[1]) : null;
      if (z != null && Math.abs(z - p[2]) < reach) grow([null, null, z]);
    }
    // Mountains beside the track, too, but not all of a cone that opens upwards.
    surface.x.forEach((x, i) => surface.y.forEach((y, j) => {
      const z = surface.z[i * surface.y.length + j];
      const beside = x >= box[0][0] && x <= box[0][1] && y >= box[1][0] && y <= box[1][1];
      if (z != null && beside && z > bottom - reach && z < top + (alike ? 0.1 : 1) * reach) grow([null, null, z]);
    }));
  }
  const pad = box.map(([a, b]) => 0.06 * (b - a));
  for (let k = 0; k < 3; k++) box[k] = [box[k][0] - (pad[k] || 0.05 * extent), box[k][1] + (pad[k] || 0.05 * extent)];

  // Heights of another unit, or of far smaller size, are drawn larger.
  const flat = Math.max(box[0][1] - box[0][0], box[1][1] - box[1][0]), tall = box[2][1] - box[2][0];
  const stretch = alike && tall > 0.12 * flat ? 1 : 0.3 * flat / tall;
  const scale = [1, 1, stretch], centre = box.map(([a, b]) => (a + b) / 2);
  // A cylinder around the box: the picture keeps its size while it turns.
  const around = Math.hypot(...box.slice(0, 2).map(([a, b]) => b - a)), upright = tall * stretch;
  const home = { yaw: -0.6, pitch: 0.5, zoom: 1 };
  let view = { ...home }, width = 0, tallness = 0, now = null, turning = null;

  const projector = () => {
    const [cy, sy, cp, sp] = [Math.cos(view.yaw), Math.sin(view.yaw), Math.cos(view.pitch), Math.sin(view.pitch)];
    // What is drawn reaches from the nearest corner of the floor to the tops in the middle, or to its furthest corner.
    const low = -(around * Math.abs(sp) + upright * cp) / 2, deepest = (around * Math.abs(sp) - upright * cp) / 2;
    const high = Math.max((upright * cp + 0.4 * around * Math.abs(sp)) / 2, deepest);
    const unit = view.zoom * Math.min((width - 90) / around, (tallness - 80) / (high - low)), middle = tallness / 2 - 6 + unit * (high + low) / 2;
    return (p) => {
      const [x, y, z] = p.map((v, k) => (v - centre[k]) * scale[k]);
      const across = cy * x - sy * y, deep = sy * x + cy * y;
      return [width / 2 + unit * across, middle - unit * (cp * z + sp * deep), cp * deep - sp * z];
    };
  };
  const stroke = (project, points, style, lineWidth, dashes, fill) => {
    context.beginPath();
    let pen = false;
    for (const p of points) {
      if (!finite(p)) { pen = false; continue; }
      const [x, y] = project(p);
      if (pen) context.lineTo(x, y); else context.moveTo(x, y);
      pen = true;
    }
    if (fill) { context.fillStyle = fill; context.fill(); }
    context.setLineDash(dashes || []);
    context.strokeStyle = style; context.lineWidth = lineWidth;
    if (lineWidth) context.stroke();
    context.setLineDash([]);
  };
  const words = (text, [x, y], style, align) => {
    context.font = "12px system-ui, sans-serif"; context.textAlign = align || "left"; context.textBaseline = "middle";
    context.lineWidth = 3; context.strokeStyle = css("--panel"); context.strokeText(text, x, y);
    context.fillStyle = style; context.fillText(text, x, y);
  };
  const steps = (low, high, count) => {
    const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
    const step = power * ([1, 2, 5, 10].find((m) => m * power >= raw) || 10), found = [];
    for (let v = Math.ceil(low / step) * step; v <= high; v += step) found.push(Math.abs(v) < step * 1e-9 ? 0 : v);
    return found;
  };

  // What belongs to one line alone has its colour.
  const tone = (of, name) => (of == null ? css(name) : colour(of));
  // The floor with its grid and numbers, and the height at the corner that is furthest to the left.
  const frame = (project) => {
    const [[x0, x1], [y0, y1], [z0, z1]] = box;
    const line = css("--line"), quiet = css("--quiet");
    for (const x of steps(x0, x1, 7)) stroke(project, [[x, y0, z0], [x, y1, z0]], line, 1);
    for (const y of steps(y0, y1, 7)) stroke(project, [[x0, y, z0], [x1, y, z0]], line, 1);
    stroke(project, [[x0, y0, z0], [x1, y0, z0], [x1, y1, z0], [x0, y1, z0], [x0, y0, z0]], quiet, 1);
    // Numbers stand at the edges that are nearest to the eye.
    const depth = (x, y) => project([x, y, z0])[2];
    const ynear = depth(x0, y0) < depth(x0, y1) ? y0 : y1, xnear = depth(x0, y0) < depth(x1, y0) ? x0 : x1;
    // A number that would lie over another word is left out; names of axes come first.
    const taken = [];
    const free = (label, [x, y], style, align) => {
      context.font = "12px system-ui, sans-serif";
      const w = context.measureText(label).width, x0 = align === "right" ? x - w : align === "center" ? x - w / 2 : x, own = [x0 - 3, y - 7, x0 + w + 3, y + 7];
      if (taken.some((other) => own[0] < other[2] && other[0] < own[2] && own[1] < other[3] && other[1] < own[3])) return;
      taken.push(own);
      words(label, [x, y], style, align);
    };
    const beside = (p, label) => { const [x, y] = project(p), half = context.measureText(label).width / 2 + 6; free(label, [Math.min(Math.max(x, half), width - half), Math.min(y + 28, tallness - 8)], css("--ink"), "center"); };
    context.font = "12px system-ui, sans-serif";
    beside([(x0 + x1) / 2, ynear, z0], chart.axes[0]);
    beside([xnear, (y0 + y1) / 2, z0], chart.axes[1]);
    const corners = [[x0, y0], [x0, y1], [x1, y0], [x1, y1]].map(([x, y]) => [x, y, project([x, y, z0])[0]]);
    const [cx, cy] = corners.reduce((a, b) => (a[2] < b[2] ? a : b));
    const [upX, upY] = project([cx, cy, z1]);
    free(chart.axes[2], [Math.max(upX, context.measureText(chart.axes[2]).width / 2 + 4), Math.max(upY - 14, 10)], css("--ink"), "center");
    const below = (p, label) => { const [x, y] = project(p); free(label, [x, y + 12], quiet, "center"); };
    // As many numbers as have room.
    const room = (p, q) => { const [a, b] = [project(p), project(q)]; return Math.max(1, Math.min(7, Math.hypot(a[0] - b[0], a[1] - b[1]) / 48)); };
    const marked = (all, mark) => told(all).forEach((text, i) => mark(all[i], text));
    marked([...steps(x0, x1, room([x0, ynear, z0], [x1, ynear, z0]))], (x, text) => below([x, ynear, z0], text));
    marked([...steps(y0, y1, room([xnear, y0, z0], [xnear, y1, z0]))], (y, text) => below([xnear, y, z0], text));
    stroke(project, [[cx, cy, z0], [cx, cy, z1]], quiet, 1);
    marked([...steps(z0, z1, 5)], (z, text) => { const [x, y] = project([cx, cy, z]); free(text, [x - 6, y], quiet, "right"); });
  };

  // The part of an area, or of a segment, that lies in the box.
  const clipped = (points, closed) => {
    for (let k = 0; k < 3; k++) for (const [sign, bound] of [[-1, -box[k][0]], [1, box[k][1]]]) {
      const kept = [], n = points.length;
      for (let i = 0; i < n; i++) {
        const a = points[i], b = closed ? points[(i + 1) % n] : points[i + 1], from = sign * a[k] - bound;
        if (from <= 0) kept.push(a);
        if (!b) continue;
        const to = sign * b[k] - bound;
        if (from * to < 0) kept.push(a.map((v, m) => v + (from / (from - to)) * (b[m] - v)));
      }
      points = kept;
    }
    return points;
  };
  // Surfaces and walls as faces, the furthest first.
  const faces = (project) => {
    const [, , [z0, z1]] = box, found = [];
    const face = (points, light, edge, of) => { if (points.every(finite)) found.push({ points, light, edge, of, depth: points.reduce((sum, p) => sum + project(p)[2], 0) / points.length }); };
    for (const surface of chart.surfaces) {
      const ny = surface.y.length;
      const at = (i, j) => [surface.x[i], surface.y[j], surface.z[i * ny + j]];
      for (let i = 0; i + 1 < surface.x.length; i++) for (let j = 0; j + 1 < ny; j++) {
        const points = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if (points.some((p) => p[2] == null)) continue;
        const seen = clipped(points, true);
        if (seen.length < 3) continue;
        // Lit from one side: slopes are to be seen.
        const rise = ((points[1][2] - points[0][2]) * stretch) / (points[1][0] - points[0][0] || 1);
        face(seen, Math.max(-1, Math.min(1, rise)), surface.floor ? "--ground" : "--limit", surface.of);
      }
    }
    for (const outline of chart.outlines.filter((o) => o.out)) for (const line of outline.lines) {
      for (let i = 0; i + 1 < line.length; i++) {
        const [[ax, ay], [bx, by]] = [line[i], line[i + 1]];
        const wall = clipped([[ax, ay, z0], [bx, by, z0], [bx, by, z1], [ax, ay, z1]], true);
        if (wall.length > 2) face(wall, 0, "--limit", outline.of);
      }
    }
    found.sort((a, b) => b.depth - a.depth);
    for (const { points, light, edge, of } of found) {
      context.globalAlpha = edge === "--ground" ? 0.3 + 0.14 * light : 0.07;
      stroke(project, [...points, points[0]], tone(of, edge), edge === "--ground" ? 0.4 : 0, [], tone(of, edge));
    }
    context.globalAlpha = 1;
  };
  const limits = (project) => {
    const [, , [z0, z1]] = box;
    for (const outline of chart.outlines) for (const line of outline.lines) {
      const red = tone(outline.of, "--limit");
      for (const [z, lineWidth] of outline.out ? [[z0, 1.3], [z1, 0.6]] : [[z0, 1.3]]) {
        for (let i = 0; i + 1 < line.length; i++) stroke(project, clipped([[...line[i], z], [...line[i + 1], z]], false), red, lineWidth, outline.out ? [] : [6, 4]);
      }
    }
    for (const outline of chart.outlines.filter((o) => o.out)) {
      const middle = [0, 1].map((k) => outline.lines[0].reduce((sum, p) => sum + p[k], 0) / outline.lines[0].length);
      if (clipped([[...middle, z1], [...middle, z1]], false).length) words(outline.name, project([...middle, z1]), tone(outline.of, "--limit"), "center");
    }
    for (const ball of chart.balls) {
      const red = tone(ball.of, "--limit");
      // Its shadow in the picture: the ellipse of the half axes' images.
      const [cx, cy] = project(ball.centre), images = ball.half.map((half) => { const [x, y] = project(ball.centre.map((c, k) => c + half[k])); return [x - cx, y - cy]; });
      const sum = (i, j) => images.reduce((total, image) => total + image[i] * image[j], 0);
      const a = Math.sqrt(sum(0, 0)) || 1, b = sum(0, 1) / a, c = Math.sqrt(Math.max(0, sum(1, 1) - b * b));
      context.beginPath();
      for (let k = 0; k <= 60; k++) context.lineTo(cx + a * Math.cos(k * Math.PI / 30), cy + b * Math.cos(k * Math.PI / 30) + c * Math.sin(k * Math.PI / 30));
      context.globalAlpha = ball.out ? 0.14 : 0.04; context.fillStyle = red; context.fill();
      const ring = (u, v) => Array.from({ length: 61 }, (_, k) => ball.centre.map((c, i) => c + Math.cos(k * Math.PI / 30) * ball.half[u][i] + Math.sin(k * Math.PI / 30) * ball.half[v][i]));
      for (const [u, v] of [[0, 1], [0, 2], [1, 2]]) { context.globalAlpha = 0.8; stroke(project, ring(u, v), red, 1); }
      context.globalAlpha = 1;
      words(ball.name, [cx, cy - Math.hypot(b, c) - 9], red, "center");
    }
    // A name that would lie over another one is left out.
    const taken = [];
    for (const [name, at, of] of chart.places) {
      if (!near(at)) continue;
      // A place of unknown height stands on the ground.
      const ground = chart.surfaces.filter((s) => s.floor).map((s) => height(s, at[0], at[1])).filter((z) => z != null && z >= z0 && z <= z1);
      const [x, y] = project([at[0], at[1], at[2] == null ? Math.max(z0, ...ground) : at[2]]);
      context.fillStyle = tone(of, "--ink");
      context.beginPath(); context.moveTo(x, y - 5); context.lineTo(x + 4.5, y + 3); context.lineTo(x - 4.5, y + 3); context.fill();
      context.font = "12px system-ui, sans-serif";
      const own = [x + 8, y - 6, x + 8 + context.measureText(name).width, y + 6];
      if (taken.some((other) => own[0] < other[2] && other[0] < own[2] && own[1] < other[3] && other[1] < own[3])) continue;
      taken.push(own);
      words(name, [x + 8, y], tone(of, "--quiet"));
    }
  };

  function redraw() {
    width = Math.max(place.clientWidth - 14, 240);
    tallness = Math.round(Math.min(Math.max(width * 0.62, 320), 620));
    const sharp = devicePixelRatio || 1;
    canvas.width = width * sharp; canvas.height = tallness * sharp;
    canvas.style.width = `${width}px`; canvas.style.height = `${tallness}px`;
    context.setTransform(sharp, 0, 0, sharp, 0, 0);
    context.clearRect(0, 0, width, tallness);
    context.lineJoin = "round";
    const project = projector(), floor = box[2][0];
    frame(project);
    faces(project);
    // Shadows on the floor tell where a track is.
    for (const track of tracks) { context.globalAlpha = 0.5; stroke(project, track.map((p) => (finite(p) ? [p[0], p[1], floor] : p)), css("--quiet"), 1.2, [2, 3]); }
    context.globalAlpha = 1;
    limits(project);
    tracks.forEach((track, i) => {
      const line = chart.lines[i];
      stroke(project, track, colour(i), 2.4, dash(line.run, i));
      const dot = (p, r, full) => { const [x, y] = project(p); context.beginPath(); context.arc(x, y, r, 0, 7); context.lineWidth = 2; context.strokeStyle = context.fillStyle = colour(i); if (full) context.fill(); else context.stroke(); };
      if (track.length && finite(track[0])) dot(track[0], 5);
      line.events.filter(finite).forEach((p) => dot(p, 3.5, true));
      const at = now == null ? null : NtgAt(line, now);
      if (at) {
        const p = [at.x, at.y, at.z];
        stroke(project, [p, [p[0], p[1], floor]], css("--quiet"), 1, [2, 3]);
        dot(p, 6, true);
      }
    });
    if (stretch < 0.99 || stretch > 1.01) words(alike ? `heights drawn ${number(+stretch.toPrecision(2))} times` : "heights not to scale", [8, tallness - 10], css("--quiet"));
    legend.replaceChildren();
    chart.lines.forEach((line, i) => {
      if (!line.name) return;
      const item = legend.appendChild(document.createElement("span")), mark = item.appendChild(document.createElement("i"));
      mark.style.borderTopColor = colour(i);
      const dashes = dash(line.run, i);
      mark.style.borderTopStyle = !dashes ? "solid" : dashes[0] < 4 ? "dotted" : "dashed";
      item.append(line.name);
    });
  }

  const turn = place.appendChild(document.createElement("button"));
  turn.type = "button"; turn.className = "turn"; turn.textContent = "↻ turn"; turn.title = "turn the picture";
  turn.addEventListener("click", () => {
    if (turning) { cancelAnimationFrame(turning); turning = null; return; }
    let last = performance.now();
    const step = (time) => { view.yaw += (time - last) / 4000; last = time; redraw(); turning = requestAnimationFrame(step); };
    turning = requestAnimationFrame(step);
  });
  let held = null;
  canvas.addEventListener("pointerdown", (event) => { held = { x: event.clientX, y: event.clientY, ...view }; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointerup", () => { held = null; });
  const pitched = (pitch) => Math.max(-0.1, Math.min(Math.PI / 2, pitch));
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    view.yaw = held.yaw + (event.clientX - held.x) / 160;
    view.pitch = pitched(held.pitch + (event.clientY - held.y) / 160);
    redraw();
  });
  canvas.addEventListener("wheel", (event) => { event.preventDefault(); view.zoom *= event.deltaY > 0 ? 1 / 1.15 : 1.15; redraw(); }, { passive: false });
  canvas.addEventListener("dblclick", () => { view = { ...home }; redraw(); });
  canvas.addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (!moves) return;
    event.preventDefault();
    view.yaw += moves[0]; view.pitch = pitched(view.pitch + moves[1]);
    redraw();
  });
  new ResizeObserver(redraw).observe(place);
  redraw();
  return { redraw, clock: (t) => { now = t; redraw(); } };
}
