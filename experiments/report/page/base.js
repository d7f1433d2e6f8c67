// Elements, numbers and the shared tooltip.

function appendChildren(node, children) {
    for (const child of children.flat(Infinity)) {
        if (child === null || child === undefined || child === false) continue;
        node.append(child instanceof Node ? child : String(child));
    }
    return node;
}

function setAttributes(node, attributes) {
    for (const [name, value] of Object.entries(attributes)) {
        if (value === null || value === undefined || value === false) continue;
        if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
        else
            node.setAttribute(name, value === true ? "" : typeof value === "number" ? Number(value.toFixed(3)) : value);
    }
    return node;
}

/// HTML element; text goes in as text nodes only, so names from files cannot become markup.
const el = (tag, attributes = {}, ...children) =>
    appendChildren(setAttributes(document.createElement(tag), attributes), children);

const svg = (tag, attributes = {}, ...children) =>
    appendChildren(setAttributes(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes), children);

const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
const isInterval = (ci) => Array.isArray(ci) && isNumber(ci[0]) && isNumber(ci[1]);
const clamp = (x, lo, hi) => Math.min(hi, Math.max(lo, x));
const sum = (xs) => xs.reduce((a, b) => a + b, 0);
const mean = (xs) => sum(xs) / xs.length;
const rootMeanSquare = (xs) => Math.sqrt(mean(xs.map((x) => x * x)));

const kDash = "–";
const kSuperscripts = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const superscript = (n) => (n < 0 ? "⁻" : "") + [...String(Math.abs(n))].map((d) => kSuperscripts[+d]).join("");

/// Three significant digits; powers of ten outside 0.001 … 100 000.
function number(x, digits = 3) {
    if (!isNumber(x)) return kDash;
    if (x === 0) return "0";
    const size = Math.abs(x);
    if (size >= 1e5 || size < 1e-3) {
        let exponent = Math.floor(Math.log10(size));
        let mantissa = (x / 10 ** exponent).toPrecision(Math.min(digits, 2));
        if (Math.abs(mantissa) >= 10) mantissa = (x / 10 ** ++exponent).toPrecision(Math.min(digits, 2));
        return `${mantissa.replace("-", "−")}\u2009×\u200910${superscript(exponent)}`;
    }
    const text = Number(x.toPrecision(digits)) >= 10 ** digits ? x.toFixed(0) : x.toPrecision(digits);
    return text.replace("-", "−");
}

/// The same without trailing zeros: what a person would write on an axis.
const plain = (x) => {
    const [mantissa, ...rest] = number(x).split("\u2009");
    return [mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa, ...rest].join("\u2009");
};

function count(x, format = number) {
    if (!isNumber(x)) return kDash;
    for (const [unit, size] of [
        ["G", 1e9],
        ["M", 1e6],
        ["k", 1e3],
    ])
        if (Math.abs(x) >= 0.9995 * size) return `${format(x / size)}\u202f${unit}`;
    return format(x);
}

function percent(x) {
    if (!isNumber(x)) return kDash;
    const value = 100 * x;
    if (value !== 0 && value < 0.01) return "< 0.01\u202f%";
    const text =
        value === 0 ? "0" : value >= 99.95 ? value.toFixed(0) : value >= 9.95 ? value.toFixed(1) : value.toPrecision(2);
    return `${text}\u202f%`;
}

/// "lo – hi"; an end that was never reached is null in the files.
function interval(ci, format = number) {
    if (!Array.isArray(ci) || !ci.some(isNumber)) return "";
    if (!isNumber(ci[1])) return `at least ${format(ci[0])}`;
    if (!isNumber(ci[0])) return `at most ${format(ci[1])}`;
    return `${format(ci[0])} ${ci[0] < 0 ? "to" : "–"} ${format(ci[1])}`;
}
const slopeText = (x) => (isNumber(x) ? x.toFixed(2).replace("-", "−") : kDash);
const pValue = (p) => (!isNumber(p) ? kDash : p >= 0.9995 ? "1" : p < 0.001 ? number(p, 2) : p.toFixed(3));
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const isDark = () =>
    matchMedia("(prefers-color-scheme: dark)").matches && !document.documentElement.classList.contains("paper");

const tooltip = {
    show(content, x, y) {
        const box = document.getElementById("tooltip");
        box.replaceChildren(...[content].flat());
        box.hidden = false;
        const { width, height } = box.getBoundingClientRect();
        box.style.left = `${clamp(x + 14, 4, innerWidth - width - 8)}px`;
        box.style.top = `${y + 18 + height > innerHeight ? y - height - 10 : y + 18}px`;
    },
    hide() {
        document.getElementById("tooltip").hidden = true;
    },
};

function withTooltip(node, content) {
    node.addEventListener("pointermove", (e) => tooltip.show(content(), e.clientX, e.clientY));
    node.addEventListener("pointerleave", () => tooltip.hide());
    return node;
}

const kArrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/// Calls move(dx, dy) for each press of an arrow key on an element.
function withArrows(node, move) {
    node.addEventListener("keydown", (e) => {
        const direction = kArrows[e.key];
        if (!direction) return;
        e.preventDefault();
        e.stopPropagation();
        move(...direction);
    });
}

/// Calls move(dx, dy) in pixels while an element is dragged.
function withDrag(node, move) {
    node.addEventListener("pointerdown", (e) => {
        e.stopPropagation();
        node.setPointerCapture(e.pointerId);
        const dragging = (m) => move(m.movementX, m.movementY);
        node.addEventListener("pointermove", dragging);
        node.addEventListener("pointerup", () => node.removeEventListener("pointermove", dragging), { once: true });
    });
}

/// A figure whose items the arrow keys read: `step(item, dx, dy)` is the neighbour of an item, `show(item)` marks it and
/// returns [content of the tooltip, element to put it beside], `hide` takes the mark away.
function readByKeys(root, { first, step, show, hide }) {
    let item = first;
    const read = () => {
        const [content, element] = show(item),
            box = element.getBoundingClientRect();
        tooltip.show(content, box.right, box.bottom);
    };
    root.setAttribute("tabindex", 0);
    root.addEventListener("focus", () => {
        if (root.matches(":focus-visible")) read();
    });
    root.addEventListener("blur", () => {
        hide();
        tooltip.hide();
    });
    withArrows(root, (dx, dy) => {
        item = step(item, dx, dy);
        read();
    });
}

const line = (text) => el("div", {}, text);

/// A place for what takes long to make: it is made once the page can be used, piece after piece in the order of the page.
const waiting = [];
function later(make) {
    const place = el("div", { class: "later" });
    waiting.push(() => place.replaceWith(make()));
    return place;
}
function makeWaiting(whenDone) {
    const make = waiting.shift();
    if (!make) return whenDone();
    make();
    setTimeout(() => makeWaiting(whenDone));
}

function section(id, title, lead, ...children) {
    return el(
        "section",
        { id, "aria-labelledby": `${id}-title` },
        el("h2", { id: `${id}-title` }, title),
        lead && el("p", { class: "lead" }, lead),
        ...children,
    );
}
