// SPDX-License-Identifier: LGPL-2.1-or-later
// Draws the columns of the statistics over time. A panel has lines that share a unit;
// pointing at a time shows the values there, and so does the time of the body.
(() => {
  "use strict";
  const data = JSON.parse(document.getElementById("curves-data").textContent);
  const times = data.time.values;
  const SVG = "http://www.w3.org/2000/svg";
  const LEFT = 52, RIGHT = 8, TOP = 8, BOTTOM = 20;

  function make(parent, name, attributes = {}) {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return parent.appendChild(element);
  }

  function html(parent, name, content = "", className = "") {
    const element = document.createElement(name);
    element.innerHTML = content;
    if (className) element.className = className;
    return parent.appendChild(element);
  }

  // Black lines are those of the ink, which is light on dark paper.
  const ink = (color) => (color === "#000000" ? "var(--ink)" : color);

  const written = (x) =>
    x === null || x === undefined ? "" :
    x === 0 ? "0" :
    (Math.abs(x) >= 1e-3 && Math.abs(x) < 1e5 ? String(+x.toPrecision(4)) : x.toExponential(2).replace(/\.?0*e\+?/, "e"))
      .replaceAll("-", "\u2212");

  function roundNumbers(low, high, most) {
    const rough = (high - low) / most || 1;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 2.5, 5, 10].find((s) => s * power >= rough * 0.999) * power;
    const found = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
      found.push(+(i * step).toPrecision(12));
    return found;
  }

  // Numbers on a logarithmic axis of time, from and to powers of ten.
  function timesBetween(low, high) {
    const steps = high - low < 2.5 ? [1, 2, 5] : [1];
    const found = [];
    for (let i = Math.floor(low); i <= high; ++i)
      for (const s of steps) {
        const power = i + Math.log10(s);
        if (power >= low - 1e-9 && power <= high + 1e-9) found.push(power);
      }
    const every = Math.ceil(found.length / 8);
    return found.filter((_, i) => i % every === 0);
  }

  let isLogarithmicInTime = false;
  const firstTime = times.find((t) => t > 0);
  const place = (t) => (isLogarithmicInTime ? Math.log10(Math.max(t, firstTime)) : t);
  const timeAt = (x) => (isLogarithmicInTime ? 10 ** x : x);

  function decades(low, high) {
    const found = [];
    const every = Math.max(1, Math.ceil((high - low) / 5));
    for (let i = Math.ceil(low); i <= high; i += every) found.push(i);
    return found;
  }

  class Panel {
    constructor(parent, about) {
      this.about = about;
      this.hidden = new Set();
      const box = html(parent, "div", "", "panel");
      const unit = about.unit ? ` [${about.unit}]` : "";
      const title = html(box, "h3", about.title + unit);
      this.svg = make(box, "svg", { role: "img", "aria-label": title.textContent });
      html(box, "p", data.time.label, "axis");
      const legend = html(box, "div", "", "legend");
      this.values = about.lines.map((line, i) => {
        const label = html(legend, "label");
        const check = html(label, "input");
        check.type = "checkbox";
        check.checked = true;
        check.addEventListener("change", () => {
          check.checked ? this.hidden.delete(i) : this.hidden.add(i);
          this.draw();
        });
        html(label, "i", "", "key").style.background = ink(line.color);
        html(label, "span", line.name + " ");
        return html(label, "b");
      });
      if (about.limit !== null) {
        const label = html(legend, "span", "tolerance " + written(about.limit));
        label.insertAdjacentHTML("afterbegin", '<i class="key" style="background:#d55e00"></i>');
      }
      this.svg.addEventListener("pointermove", (event) => this.point(event));
      new ResizeObserver(() => this.draw()).observe(this.svg);
    }

    range() {
      const { lines, logarithmic, steps, limit } = this.about;
      let low = Infinity, high = -Infinity;
      lines.forEach((line, i) => {
        if (this.hidden.has(i)) return;
        for (let value of line.values) {
          if (value === null) continue;
          if (logarithmic) value = Math.log10(value);
          low = Math.min(low, value);
          high = Math.max(high, value);
        }
      });
      if (limit !== null) high = Math.max(high, limit);
      if (low > high) [low, high] = [0, 1];
      if (!logarithmic && (steps || (low > 0 && low < 0.5 * high))) low = Math.min(low, 0);
      if (!logarithmic && high < 0 && high > 0.5 * low) high = 0;
      const margin = 0.04 * (high - low) || 0.1 * Math.abs(high) || 1;
      return [low === 0 ? 0 : low - margin, high === 0 ? 0 : high + margin];
    }

    draw() {
      const width = this.svg.clientWidth, height = this.svg.clientHeight;
      if (!width || !height) return;
      const { lines, logarithmic, steps, limit } = this.about;
      const first = place(times[0]), last = place(times[times.length - 1]);
      const [low, high] = this.range();
      this.x = (t) => LEFT + ((width - LEFT - RIGHT) * (place(t) - first)) / (last - first || 1);
      const y = (v) => TOP + ((height - TOP - BOTTOM) * (high - v)) / (high - low);
      this.svg.replaceChildren();
      this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
      const numbers = logarithmic ? decades(low, high) : roundNumbers(low, high, 4);
      for (const v of numbers) {
        make(this.svg, "line", { class: "grid", x1: LEFT, x2: width - RIGHT, y1: y(v), y2: y(v) });
        const text = make(this.svg, "text", { x: LEFT - 5, y: y(v) + 4, "text-anchor": "end" });
        text.textContent = logarithmic ? written(10 ** v) : written(v);
      }
      const inTime = isLogarithmicInTime ? timesBetween(first, last) : roundNumbers(first, last, Math.max(2, width / 90));
      for (const t of inTime.map(timeAt)) {
        make(this.svg, "line", { class: "grid", x1: this.x(t), x2: this.x(t), y1: height - BOTTOM, y2: height - BOTTOM + 4 });
        const text = make(this.svg, "text", { x: this.x(t), y: height - BOTTOM + 16, "text-anchor": this.x(t) > width - 24 ? "end" : "middle" });
        text.textContent = written(t);
      }
      lines.forEach((line, i) => {
        if (this.hidden.has(i)) return;
        let path = "", pen = false;
        line.values.forEach((value, row) => {
          if (value === null || (isLogarithmicInTime && times[row] <= 0)) { pen = false; return; }
          const at = y(logarithmic ? Math.log10(value) : value).toFixed(1);
          const t = this.x(times[row]).toFixed(1);
          // The value of a step is that since the end of the one before.
          path += !pen ? `M${t} ${at}` : steps ? `V${at}H${t}` : `L${t} ${at}`;
          pen = true;
        });
        make(this.svg, "path", { d: path, fill: "none", "stroke-width": 1.6, style: `stroke:${ink(line.color)}` });
      });
      if (limit !== null)
        make(this.svg, "line", { class: "limit", x1: LEFT, x2: width - RIGHT, y1: y(limit), y2: y(limit) });
      this.now = make(this.svg, "line", { class: "now", y1: TOP, y2: height - BOTTOM });
      this.mark(current);
    }

    point(event) {
      const box = this.svg.getBoundingClientRect();
      const share = (event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
      const first = place(times[0]), last = place(times[times.length - 1]);
      show(timeAt(first + share * (last - first)));
    }

    mark(row) {
      if (!this.now) return;
      const x = this.x(times[row]);
      this.now.setAttribute("x1", x);
      this.now.setAttribute("x2", x);
      this.about.lines.forEach((line, i) => {
        this.values[i].textContent = written(line.values[row]);
      });
    }
  }

  let current = times.length - 1;
  function show(t) {
    let nearest = 0;
    times.forEach((time, row) => {
      if (Math.abs(time - t) < Math.abs(times[nearest] - t)) nearest = row;
    });
    current = nearest;
    for (const panel of panels) panel.mark(current);
  }

  // Where times are of several orders of magnitude.
  if (times[times.length - 1] > 20 * firstTime) {
    const label = html(document.getElementById("panels"), "label", "", "wide");
    const check = html(label, "input");
    check.type = "checkbox";
    check.id = "logarithmic-time";
    html(label, "span", " logarithmic axis of time");
    check.addEventListener("change", () => {
      isLogarithmicInTime = check.checked;
      for (const panel of panels) panel.draw();
    });
  }
  const panels = data.panels.map((about) => new Panel(document.getElementById("panels"), about));
  document.addEventListener("time-of-body", (event) => show(event.detail / data.time.size));
})();
