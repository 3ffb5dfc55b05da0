"use strict";
// Interactive maps: the point under the pointer, or under the keyboard's cursor, and curves of the nearest computed point.
for (const explorer of document.querySelectorAll(".explorer")) {
  const data = JSON.parse(explorer.querySelector("script").textContent);
  const overlay = explorer.querySelector(".overlay");
  const [cross, mark] = overlay.querySelectorAll("i");
  const readout = explorer.querySelector(".readout");
  const detail = explorer.querySelector(".detail");
  const { step, samples } = data;
  const counts = [data.x, data.y].map(axis => axis.values.length);
  const columns = Math.ceil(counts[0] / step);
  // Indices of the point that is described.
  let cursor = null;

  const format = value => {
    if (typeof value === "string") return value === "inf" ? "∞" : "−∞";
    const size = Math.abs(value);
    const rounded = +value.toPrecision(4);
    const text = size !== 0 && (size < 1e-3 || size >= 1e5) ? rounded.toExponential() : String(rounded);
    return text.replace("-", "−").replace(/e\+?(.*)$/, (_, power) => "·10" + power.replace(/[-−0-9]/g, digit =>
      ({ "-": "⁻", "−": "⁻" })[digit] ?? "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]));
  };
  // A value of an axis that is zero within the rounding of its steps is shown as zero.
  const axisValue = (axis, index) =>
    Math.abs(axis.values[index]) < 1e-13 * Math.abs(axis.values.at(-1) - axis.values[0]) ? 0 : axis.values[index];
  const describePlace = ([i, j]) => [[data.x, i], [data.y, j]]
    .map(([axis, index]) => `${axis.label} = ${format(axisValue(axis, index))}${axis.unit}`).join(", ");
  // Fraction of the height or width of the overlay from the lower left, and back.
  const isDescending = axis => axis.values.at(-1) < axis.values[0];
  const fraction = (axis, index) => {
    const share = axis.values.length > 1 ? index / (axis.values.length - 1) : 0.5;
    return isDescending(axis) ? 1 - share : share;
  };
  const nearest = (axis, share) => {
    const last = axis.values.length - 1;
    const index = Math.round((isDescending(axis) ? 1 - share : share) * last / step) * step;
    return Math.min(Math.max(index, 0), last - last % step);
  };
  const place = (element, [i, j]) => {
    element.style.display = "block";
    element.style.left = 100 * fraction(data.x, i) + "%";
    element.style.top = 100 * (1 - fraction(data.y, j)) + "%";
  };
  const pointAt = event => {
    const box = overlay.getBoundingClientRect();
    return [nearest(data.x, (event.clientX - box.left) / box.width),
      nearest(data.y, 1 - (event.clientY - box.top) / box.height)];
  };

  const show = point => {
    cursor = point;
    place(cross, point);
    const at = point[1] / step * columns + point[0] / step;
    const value = name => data.fields.find(field => field.name === name)?.values[at] ?? null;
    const parts = [data.verdicts[data.verdict[at]]];
    if (data.types && data.types.digits[at] !== "0") parts.push(data.types.names[data.types.digits[at]]);
    const [order, coefficient] = [value("order"), value("coefficient")];
    if (order !== null && coefficient !== null) {
      const power = order === 1 ? "" : order === 2 ? "²" : `^${format(order)}`;
      parts.push(`growth rate of short waves Re ς = ${format(coefficient)} m${power}/s · k${power}`);
    }
    if (value("growth_rate") !== null) parts.push(`largest growth rate at the wave of the case ${format(value("growth_rate"))} 1/s`);
    if (value("bound") !== null) parts.push(`bound ${format(value("bound"))} 1/s`);
    if (value("direction_deg") !== null) {
      const elevation = value("elevation_deg");
      const above = elevation ? `, ${format(elevation)}° above the plane` : "";
      parts.push(`fastest at ${format(value("direction_deg"))}°${above}`);
    }
    readout.textContent = `${describePlace(point)}: ${parts.join("; ")}`;
  };

  const create = (parent, name, attributes, text) => {
    const isDrawn = parent.namespaceURI === "http://www.w3.org/2000/svg" || name === "svg";
    const element = isDrawn ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
    for (const [key, own] of Object.entries(attributes)) element.setAttribute(key, own);
    if (text !== undefined) element.textContent = text;
    return parent.appendChild(element);
  };
  // Round numbers in a range, at most about `count`.
  const ticks = (low, high, count) => {
    const rough = (high - low) / count;
    const power = 10 ** Math.floor(Math.log10(rough));
    const distance = [1, 2, 5, 10].map(own => own * power).find(own => own >= rough);
    const found = [];
    for (let n = Math.ceil(low / distance); n * distance <= high * (1 + 1e-12); n++) found.push(n * distance);
    return found;
  };
  const drawCurve = sample => {
    const width = Math.min(Math.max(detail.clientWidth, 320), 704);
    const [height, left, right, top, bottom] = [320, 96, 24, 14, 56];
    const rates = sample.g.filter(Number.isFinite);
    let [low, high] = [Math.min(0, ...rates), Math.max(0, ...rates)];
    if (low === high) [low, high] = [-1, 1];
    const margin = 0.05 * (high - low);
    [low, high] = [low - margin, high + margin];
    const x = degrees => left + (width - left - right) * degrees / 180;
    const y = rate => top + (height - top - bottom) * (high - rate) / (high - low);
    const fastest = sample.g.reduce((best, rate, at) => rate > (sample.g[best] ?? -Infinity) ? at : best, 0);
    const svg = create(detail, "svg", { class: "curve", width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label":
      `Growth rate against direction, largest ${format(sample.g[fastest] ?? 0)} 1/s at ${samples.directions[fastest]}°` });
    for (const rate of ticks(low, high, 5)) {
      create(svg, "line", { class: "grid", x1: left, x2: width - right, y1: y(rate), y2: y(rate) });
      create(svg, "text", { x: left - 8, y: y(rate) + 5, "text-anchor": "end" }, format(+rate.toPrecision(12)));
    }
    for (let degrees = 0; degrees <= 180; degrees += width < 500 ? 60 : 30) {
      create(svg, "line", { class: "grid", x1: x(degrees), x2: x(degrees), y1: top, y2: height - bottom });
      create(svg, "text", { x: x(degrees), y: height - bottom + 20, "text-anchor": "middle" }, `${degrees}°`);
    }
    create(svg, "line", { class: "zero", x1: left, x2: width - right, y1: y(0), y2: y(0) });
    const own = ((sample.d % 180) + 180) % 180;
    create(svg, "line", { class: "at", x1: x(own), x2: x(own), y1: top, y2: height - bottom });
    let path = "";
    sample.g.forEach((rate, at) => {
      if (!Number.isFinite(rate)) return;
      const isJoined = at > 0 && Number.isFinite(sample.g[at - 1]);
      path += `${isJoined ? "L" : "M"}${x(samples.directions[at]).toFixed(1)} ${y(rate).toFixed(1)}`;
    });
    create(svg, "path", { class: "rate", d: path });
    create(svg, "text", { x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle" },
      (width < 500 ? "direction" : "direction of the wave vector") + " (dashed: the case)");
    create(svg, "text", { x: 0, y: 0, "text-anchor": "middle",
      transform: `translate(16 ${(top + height - bottom) / 2}) rotate(-90)` }, "growth rate Re ς (1/s)");
  };
  const open = point => {
    show(point);
    const find = (indices, own) => indices.reduce((best, index, at) =>
      Math.abs(index - own) < Math.abs(indices[best] - own) ? at : best, 0);
    const at = [find(samples.columns, point[0]), find(samples.rows, point[1])];
    const found = [samples.columns[at[0]], samples.rows[at[1]]];
    place(mark, found);
    detail.replaceChildren();
    const isSame = found.every((index, axis) => index === point[axis]);
    create(detail, "h3", {}, describePlace(found));
    create(detail, "p", {}, `${isSame ? "This point is computed" : "The nearest computed point (blue diamond)"}; ` +
      `${samples.columns.length} × ${samples.rows.length} of ${counts[0]} × ${counts[1]} points are.`);
    const sample = samples.points[at[1] * samples.columns.length + at[0]];
    if (!sample) {
      create(detail, "p", {}, "There is no state at this point, or it has no roots.");
      return;
    }
    create(detail, "p", {}, `Largest growth rate at the wave number ${format(sample.k)} 1/m, every ` +
      `${samples.directions[1]}°:`);
    drawCurve(sample);
    create(detail, "p", {}, sample.r.length ? `Finite roots ς at ${format(sample.k)} 1/m and ${format(sample.d)}°:`
      : "There are no finite roots at the wave vector of the case.");
    if (!sample.r.length) return;
    const table = create(detail, "table", {});
    const head = create(create(table, "thead", {}), "tr", {});
    ["Re ς (1/s)", "Im ς (1/s)"].forEach(name => create(head, "th", { scope: "col" }, name));
    const body = create(table, "tbody", {});
    for (const root of sample.r) {
      const row = create(body, "tr", {});
      root.forEach(part => create(row, "td", {}, format(part)));
    }
  };

  readout.textContent = "Move over the map for the verdict and the growth at a point" +
    (step > 1 ? ` (one of ${step} × ${step})` : "") + ". Click, or press Enter, for its growth rate against the direction.";
  overlay.addEventListener("pointermove", event => show(pointAt(event)));
  overlay.addEventListener("click", event => open(pointAt(event)));
  overlay.addEventListener("focus", () => {
    if (!cursor && overlay.matches(":focus-visible")) {
      show([data.x, data.y].map(axis => nearest(axis, 0.5)));
    }
  });
  overlay.addEventListener("keydown", event => {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
    const move = moves[event.key];
    if (!move && event.key !== "Enter") return;
    event.preventDefault();
    const from = cursor ?? [data.x, data.y].map(axis => nearest(axis, 0.5));
    if (!move) return open(from);
    show(from.map((index, which) => {
      const axis = which ? data.y : data.x;
      const moved = index + move[which] * step * (event.shiftKey ? 10 : 1) * (isDescending(axis) ? -1 : 1);
      const last = counts[which] - 1;
      return Math.min(Math.max(moved, 0), last - last % step);
    }));
    // A narrow page shows part of the map.
    cross.scrollIntoView({ block: "nearest", inline: "nearest" });
  });
}
