// SPDX-License-Identifier: LGPL-2.1-or-later
// Shows the body with vtk.js: deformed, in the colors of a field, at a time, with the
// state of its contact face. contrib/reporting/body.py writes what it reads.
(async () => {
  "use strict";
  const place = document.getElementById("viewer");
  if (!document.createElement("canvas").getContext("webgl2"))
    throw new Error("this browser has no WebGL 2");
  const about = JSON.parse(document.getElementById("body-data").textContent);
  const flat = about.dimension === 2;

  const decode = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const packed = decode(document.getElementById("body-numbers").textContent);
  const opened = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const buffer = await new Response(opened).arrayBuffer();
  const KINDS = { u1: Uint8Array, u2: Uint16Array, u4: Uint32Array };
  const array = ([kind, start, length]) => new KINDS[kind](buffer, start, length);
  const maps = Object.fromEntries(
    Object.entries(about.maps).map(([name, text]) => [name, decode(text)]));

  // Controls.
  const state = { frame: about.frames.length - 1, magnification: about.magnification };
  place.innerHTML = `
    <div class="controls">
      <label>Field <select id="field"></select></label>
      <label id="face-label">Contact face <select id="face"></select></label>
      <label><input type="checkbox" id="mesh"> mesh</label>
      <label><input type="checkbox" id="outline" checked> undeformed</label>
      <button type="button" id="reset">Whole body</button>
      <button type="button" id="below">Contact face</button>
    </div>
    <div class="canvas"><div id="box" tabindex="0" role="img" style="height:100%"></div>
      <svg class="axes" aria-hidden="true" viewBox="-42 -42 84 84"></svg></div>
    <div class="scale" id="scale"></div>
    <div class="scale" id="face-scale"></div>
    <div class="controls">
      <button type="button" id="play" aria-label="Play or stop">&#9654;</button>
      <label class="grow">Time <input type="range" id="time" min="0" step="1">
        <output id="time-value"></output></label>
      <label class="grow">Displacement &times; <input type="range" id="magnify" min="0" step="any">
        <output id="magnify-value"></output></label>
    </div>
    <p class="hint">${flat ? "Drag to move" : "Drag to turn, with shift to move"}, wheel or
      two fingers to zoom (after a click into the picture), or arrow keys, + and &minus;.</p>`;
  const get = (id) => document.getElementById(id);
  const box = get("box");
  box.setAttribute("aria-label", "The deformed body in the colors of a field");

  const words = (html) => {
    const element = document.createElement("span");
    element.innerHTML = html;
    return element.textContent;
  };
  function fill(select, fields, more = {}) {
    for (const [name, label] of Object.entries(more)) select.add(new Option(label, name));
    for (const [name, field] of Object.entries(fields)) select.add(new Option(words(field.words), name));
  }
  fill(get("field"), about.fields);
  const hasFace = about.frames.some((frame) => frame.face);
  if (hasFace) {
    fill(get("face"), about.faceFields, { states: "stick and slip", none: "not shown" });
  } else {
    get("face-label").remove();
    get("below").remove();
  }
  if (flat && hasFace) get("below").remove();
  if (about.fields.von_mises) get("field").value = "von_mises";

  // Numbers of a frame as vtk.js wants them.
  function undeformed(part) {
    const places = array(part.points), dim = about.dimension;
    const result = new Float32Array((3 * places.length) / dim);
    for (let i = 0; i < places.length; ++i)
      result[3 * Math.floor(i / dim) + (i % dim)] = about.low[i % dim] + (places[i] * about.extent) / 65535;
    return result;
  }
  function placed(part) {
    const result = undeformed(part), moved = array(part.moved), dim = about.dimension;
    const scale = (state.magnification * about.displacement) / 32767;
    for (let i = 0; i < moved.length; ++i)
      result[3 * Math.floor(i / dim) + (i % dim)] += scale * (moved[i] - 32768);
    return result;
  }
  function faces(part) {
    const numbers = array(part.faces), n = part.corners;
    const result = new Uint32Array((numbers.length / n) * (n + 1));
    for (let i = 0, j = 0; i < numbers.length; ++i) {
      if (i % n === 0) result[j++] = n;
      result[j++] = numbers[i];
    }
    return result;
  }
  function places(part, name, fields) {
    const field = fields[name];
    if (part.fields[name]) return array(part.fields[name]);
    if (field.component === undefined) return null;
    const moved = array(part.moved), dim = about.dimension;
    const scale = about.displacement / 32767, result = new Uint8Array(moved.length / dim);
    for (let i = 0; i < result.length; ++i) {
      let value = 0;
      for (let d = 0; d < dim; ++d) {
        const u = scale * (moved[dim * i + d] - 32768);
        if (field.component < 0) value += u * u;
        else if (field.component === d) value = u;
      }
      if (field.component < 0) value = Math.sqrt(value);
      const share = (value - field.low) / (field.high - field.low);
      result[i] = Math.round(255 * Math.min(1, Math.max(0, share)));
    }
    return result;
  }
  function colored(levels, map) {
    const result = new Uint8Array(3 * levels.length);
    levels.forEach((level, i) => result.set(map.subarray(3 * level, 3 * level + 3), 3 * i));
    return result;
  }
  const stateMap = new Uint8Array(about.states.flatMap(({ color }) =>
    [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16))));

  // The scene of vtk.js.
  class Thing {
    constructor() {
      this.data = vtk.PolyData.newInstance();
      this.mapper = vtk.Mapper.newInstance({ scalarVisibility: true });
      this.mapper.setColorModeToDirectScalars();
      this.mapper.setInputData(this.data);
      this.actor = vtk.Actor.newInstance();
      this.actor.setMapper(this.mapper);
      renderer.addActor(this.actor);
    }
    shape(points, polys) {
      this.data.getPoints().setData(points, 3);
      if (polys) this.data.getPolys().setData(polys);
      this.data.modified();
    }
    colors(values, onCells) {
      const colors = vtk.DataArray.newInstance({ name: "colors", values, numberOfComponents: 3 });
      const [on, off] = [this.data.getCellData(), this.data.getPointData()];
      (onCells ? off : on).setScalars(null);
      (onCells ? on : off).setScalars(colors);
      onCells ? this.mapper.setScalarModeToUseCellData() : this.mapper.setScalarModeToUsePointData();
    }
  }
  const renderWindow = vtk.RenderWindow.newInstance();
  const renderer = vtk.Renderer.newInstance();
  renderWindow.addRenderer(renderer);
  const view = vtk.OpenGLRenderWindow.newInstance();
  view.setContainer(box);
  renderWindow.addView(view);
  const interactor = vtk.Interactor.newInstance();
  interactor.setView(view);
  interactor.initialize();
  interactor.setContainer(box);
  const style = vtk.Manipulators.newInstance();
  interactor.setInteractorStyle(style);
  const main = flat ? vtk.Pan : vtk.Rotate;
  style.addMouseManipulator(main.newInstance({ button: 1 }));
  style.addMouseManipulator(vtk.Pan.newInstance({ button: 1, shift: true }));
  style.addMouseManipulator(vtk.Pan.newInstance({ button: 3 }));
  style.addMouseManipulator(vtk.Zoom.newInstance({ scrollEnabled: true, dragEnabled: false }));
  style.addGestureManipulator(vtk.Gestures.newInstance({ rotateEnabled: !flat }));
  const camera = renderer.getActiveCamera();
  camera.setParallelProjection(true);

  // The rim lets white bands show on white paper.
  const body = new Thing(), rim = new Thing(), face = new Thing(), outline = new Thing();
  for (const thing of [rim, face, outline]) thing.actor.getProperty().setLighting(false);
  for (const thing of [rim, outline]) thing.mapper.setScalarVisibility(false);
  rim.actor.getProperty().setColor(0.2, 0.2, 0.2);
  body.actor.getProperty().setEdgeColor(1, 1, 1);
  face.actor.getProperty().setEdgeColor(0.4, 0.4, 0.4);
  for (const thing of [body, face]) thing.actor.getProperty().setEdgeOpacity(0.35);
  if (flat) {
    body.actor.getProperty().setLighting(false);
    // Between a cell and smaller ones pixels may be left: lines in the same colors
    // under them fill these.
    const under = vtk.Actor.newInstance();
    under.setMapper(body.mapper);
    under.getProperty().setLighting(false);
    under.getProperty().setRepresentation(1);
    under.setPosition(0, 0, -1e-3 * about.extent);
    renderer.addActor(under);
  } else {
    body.actor.getProperty().setAmbient(0.35);
    body.actor.getProperty().setDiffuse(0.75);
  }
  face.mapper.setResolveCoincidentTopologyToPolygonOffset();
  face.mapper.setRelativeCoincidentTopologyPolygonOffsetParameters(-4, -4);
  outline.actor.getProperty().setOpacity(0.7);

  const before = undeformed(about.outline), size = extent(before).size;
  outline.data.getPoints().setData(lifted(before, flat ? 0.002 * size : 0), 3);
  outline.data.getLines().setData(faces({ faces: about.outline.edges, corners: 2 }));
  const most = Math.max(...about.frames.map((frame) => array(frame.faces).length / frame.corners));
  get("mesh").checked = most <= 3000;

  function extent(points) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    points.forEach((value, i) => {
      low[i % 3] = Math.min(low[i % 3], value);
      high[i % 3] = Math.max(high[i % 3], value);
    });
    return { low, high, size: Math.max(...high.map((value, i) => value - low[i])) };
  }
  function lifted(points, height) {
    const result = new Float32Array(points);
    for (let i = 2; i < result.length; i += 3) result[i] += height;
    return result;
  }
  // Lines of the contact face in two dimensions as bands: lines are thin in WebGL.
  function bands(points, part, levels, width, height) {
    const lines = array(part.faces), n = lines.length / 2;
    const corners = new Float32Array(12 * n), polys = new Uint32Array(5 * n), of = new Uint8Array(4 * n);
    for (let i = 0; i < n; ++i) {
      const [a, b] = [lines[2 * i], lines[2 * i + 1]];
      const t = [points[3 * b] - points[3 * a], points[3 * b + 1] - points[3 * a + 1]];
      const length = Math.hypot(...t) || 1;
      const across = [(-t[1] / length) * width, (t[0] / length) * width];
      [[a, 1], [b, 1], [b, -1], [a, -1]].forEach(([end, side], j) => {
        const at = 3 * (4 * i + j);
        corners[at] = points[3 * end] + side * across[0];
        corners[at + 1] = points[3 * end + 1] + side * across[1];
        corners[at + 2] = height;
        of[4 * i + j] = levels[end];
      });
      polys.set([4, 4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3], 5 * i);
    }
    return { points: corners, polys, levels: of };
  }

  let shownMesh = null;
  function update() {
    const frame = about.frames[state.frame], name = get("field").value;
    // Often all times have the same mesh.
    body.shape(placed(frame), shownMesh !== frame.faces[1] && faces(frame));
    shownMesh = frame.faces[1];
    const field = about.fields[name];
    const levels = field && places(frame, name, about.fields);
    body.mapper.setScalarVisibility(Boolean(levels));
    if (levels) body.colors(colored(levels, maps[field.map]), Boolean(field.onCells));
    body.actor.getProperty().setEdgeVisibility(get("mesh").checked);
    face.actor.getProperty().setEdgeVisibility(get("mesh").checked && !flat);
    updateFace(frame.face);
    outline.actor.setVisibility(get("outline").checked);
    legend(frame, name, field);
    get("time-value").innerHTML = frame.label;
    get("time").setAttribute("aria-valuetext", words(frame.label));
    get("magnify-value").textContent = String(+state.magnification.toPrecision(3));
    box.dataset.frame = state.frame;
    renderWindow.render();
    drawAxes();
  }
  function updateFace(part) {
    const name = hasFace ? get("face").value : "none";
    const isState = name === "states";
    const shown = Boolean(part) && name !== "none" && (isState || part.fields[name]);
    face.actor.setVisibility(Boolean(shown));
    rim.actor.setVisibility(Boolean(shown) && part.corners === 2);
    const legendOfFace = get("face-scale");
    legendOfFace.replaceChildren();
    if (!shown) return;
    let levels = isState ? array(part.states) : array(part.fields[name]);
    let points = placed(part), polys;
    if (isState) {
      const there = new Set(levels);
      about.states.forEach(({ name: text, color }, i) => {
        if (there.has(i))
          legendOfFace.insertAdjacentHTML("beforeend",
            `<span><i class="state" style="background:${color}"></i>${text}</span>`);
      });
    } else colorBar(legendOfFace, about.faceFields[name]);
    if (part.corners === 2) {
      const around = bands(points, part, levels, 0.011 * size, 0.001 * size);
      rim.shape(around.points, around.polys);
      ({ points, polys, levels } = bands(points, part, levels, 0.008 * size, 0.0015 * size));
    } else polys = faces(part);
    face.shape(points, polys);
    face.colors(colored(levels, isState ? stateMap : maps[about.faceFields[name].map]), false);
  }

  const number = (value, largest = 0) => {
    // Nothing but rounding beside the other end is zero.
    if (Math.abs(value) < 1e-9 * Math.abs(largest)) return "0";
    const size = Math.abs(value);
    const text = size === 0 ? "0" : size >= 1e-3 && size < 1e4 ? String(+value.toPrecision(3)) : value.toExponential(2);
    return text.replace(/-/g, "\u2212");
  };
  const unitOf = (field) => (field.unit.startsWith("10") ? "&times; " : "") + field.unit;
  function colorBar(parent, field) {
    const low = ["min", "both"].includes(field.beyond) ? "\u2264 " : "";
    const high = ["max", "both"].includes(field.beyond) ? "\u2265 " : "";
    parent.innerHTML = `<span>${field.words}</span><span>${low}${number(field.low / field.size, field.high / field.size)}</span>
      <canvas class="colors" width="256" height="1"></canvas>
      <span>${high}${number(field.high / field.size)} ${unitOf(field)}</span>`;
    const context = parent.querySelector("canvas").getContext("2d");
    const image = context.createImageData(256, 1), map = maps[field.map];
    for (let i = 0; i < 256; ++i) image.data.set([...map.subarray(3 * i, 3 * i + 3), 255], 4 * i);
    context.putImageData(image, 0, 0);
  }
  function legend(frame, name, field) {
    if (!field) return;
    colorBar(get("scale"), field);
    const ends = frame.ends[name];
    if (ends)
      get("scale").insertAdjacentHTML("beforeend",
        `<span class="range">now ${number(ends[0] / field.size, ends[1] / field.size)} to ${number(ends[1] / field.size)} ${unitOf(field)}</span>`);
  }

  // The camera.
  const AXES = { x: "#d55e00", y: "#009e73", z: "#0072b2" };
  function drawAxes() {
    if (flat) return;
    const svg = document.querySelector("#viewer .axes");
    const [right, up] = screen();
    svg.innerHTML = Object.entries(AXES).map(([name, color], d) => {
      const [x, y] = [26 * right[d], -26 * up[d]];
      return `<line x1="0" y1="0" x2="${x}" y2="${y}" stroke="${color}" stroke-width="2"/>
        <text x="${1.3 * x}" y="${1.3 * y + 4}" text-anchor="middle">${name}</text>`;
    }).join("");
  }
  // The directions in space to the right and upwards on the screen.
  function screen() {
    const [a, b] = [camera.getDirectionOfProjection(), camera.getViewUp()];
    const cross = (u, v) => [0, 1, 2].map((i) =>
      u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]);
    const right = cross(a, b), length = Math.hypot(...right) || 1;
    const unit = right.map((value) => value / length);
    return [unit, cross(unit, a)];
  }
  function look(direction, up) {
    const { low, high } = extent([...body.data.getPoints().getData(), ...before]);
    const middle = low.map((value, i) => 0.5 * (value + high[i]));
    const far = 4 * Math.hypot(...high.map((value, i) => value - low[i]));
    camera.setFocalPoint(...middle);
    camera.setPosition(...middle.map((value, i) => value + far * direction[i]));
    camera.setViewUp(...up);
    const onScreen = screen();
    const reach = [0, 0];
    for (let i = 0; i < 8; ++i) {
      const corner = [0, 1, 2].map((d) => (((i >> d) & 1 ? high : low)[d] - middle[d]));
      for (const row of [0, 1]) {
        const along = corner.reduce((sum, value, d) => sum + value * onScreen[row][d], 0);
        reach[row] = Math.max(reach[row], Math.abs(along));
      }
    }
    if (!box.parentElement.style.height) {
      // As high as the body is, within limits.
      const height = Math.max(220, (1.2 * box.clientWidth * reach[1]) / (reach[0] || 1));
      box.parentElement.style.height = `min(${Math.round(height)}px, 60vh, 34rem)`;
    }
    const shape = box.clientWidth / Math.max(1, box.clientHeight);
    camera.setParallelScale(1.1 * Math.max(reach[1], reach[0] / shape) || 1);
    renderer.resetCameraClippingRange();
    renderWindow.render();
    drawAxes();
  }
  function whole() {
    if (flat) return look([0, 0, 1], [0, 1, 0]);
    const [up, round] = [22, -55].map((angle) => (angle * Math.PI) / 180);
    look([Math.cos(up) * Math.cos(round), Math.cos(up) * Math.sin(round), Math.sin(up)], [0, 0, 1]);
  }
  // From outside onto the contact face: where it lies, seen from the middle.
  function below() {
    const part = about.frames[state.frame].face;
    if (!part) return;
    const points = undeformed(part), n = points.length / 3;
    const { low, high } = extent(before);
    const direction = [0, 1, 2].map((d) => {
      let sum = 0;
      for (let i = 0; i < n; ++i) sum += points[3 * i + d];
      return sum / n - 0.5 * (low[d] + high[d]);
    });
    const length = Math.hypot(...direction) || 1;
    const n3 = direction.map((value) => value / length);
    // Not straight along an axis, so that the sides of the body show where it is.
    const aside = [0.25, -0.35, 0].map((value, d) => n3[d] + value * (1 - Math.abs(n3[d])));
    const norm = Math.hypot(...aside);
    look(aside.map((value) => value / norm), Math.abs(n3[2]) > 0.9 ? [0, 1, 0] : [0, 0, 1]);
  }

  // What the user does.
  const time = get("time"), magnify = get("magnify");
  time.max = about.frames.length - 1;
  time.value = state.frame;
  time.disabled = get("play").disabled = about.frames.length < 2;
  magnify.max = about.magnification > 1 ? 2 * about.magnification : 5;
  magnify.value = state.magnification;
  function goTo(frame) {
    state.frame = frame;
    time.value = frame;
    update();
    document.dispatchEvent(new CustomEvent("time-of-body", { detail: about.frames[frame].t }));
  }
  time.addEventListener("input", () => goTo(Number(time.value)));
  magnify.addEventListener("input", () => {
    state.magnification = Number(magnify.value);
    update();
  });
  for (const id of ["field", "face", "mesh", "outline"])
    get(id)?.addEventListener("change", update);
  get("reset").addEventListener("click", whole);
  get("below")?.addEventListener("click", below);
  let playing = null;
  get("play").addEventListener("click", () => {
    if (playing !== null) {
      clearInterval(playing);
      playing = null;
    } else {
      playing = setInterval(() => goTo((state.frame + 1) % about.frames.length), 350);
    }
    get("play").innerHTML = playing === null ? "&#9654;" : "&#9632;";
  });
  // The wheel scrolls the page until somebody has clicked into the picture.
  let taken = false;
  box.addEventListener("pointerdown", () => { taken = true; });
  box.parentElement.addEventListener("pointerleave", () => { taken = false; });
  box.parentElement.addEventListener("wheel", (event) => {
    if (!taken) event.stopPropagation();
  }, { capture: true });
  box.addEventListener("keydown", (event) => {
    const step = 0.1 * camera.getParallelScale();
    const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] || [0, 0];
    if (event.key === "+" || event.key === "-")
      camera.setParallelScale(camera.getParallelScale() * (event.key === "+" ? 0.9 : 1.1));
    else if (x === 0 && y === 0) return;
    else if (flat) {
      const at = camera.getFocalPoint(), from = camera.getPosition();
      camera.setFocalPoint(at[0] + step * x, at[1] + step * y, at[2]);
      camera.setPosition(from[0] + step * x, from[1] + step * y, from[2]);
    } else {
      camera.azimuth(-6 * x);
      camera.elevation(-6 * y);
      camera.orthogonalizeViewUp();
    }
    event.preventDefault();
    renderer.resetCameraClippingRange();
    renderWindow.render();
  });
  camera.onModified(drawAxes);

  function dress() {
    const color = (name) => {
      const text = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
      return [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);
    };
    renderer.setBackground(...color("--paper"));
    outline.actor.getProperty().setColor(...color("--faint"));
    renderWindow.render();
  }
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", dress);
  new ResizeObserver(() => {
    const ratio = window.devicePixelRatio || 1;
    view.setSize(Math.max(1, Math.floor(box.clientWidth * ratio)), Math.max(1, Math.floor(box.clientHeight * ratio)));
    renderWindow.render();
  }).observe(box);

  update();
  dress();
  whole();
  box.dataset.ready = "yes";
})().catch((error) => {
  document.getElementById("viewer").textContent = `The view failed: ${error.message}.`;
  console.error(error);
});
