// Colour maps, made in OKLab (Ottosson 2020) so that equal steps of a value look like equal steps of lightness.

function oklabToRgb(L, a, b) {
    const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3;
    const m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
    const s = (L - 0.0894841775 * a - 1.291485548 * b) ** 3;
    return [
        4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
        -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
        -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
    ].map(linearToByte);
}

function rgbToOklab(rgb) {
    const [r, g, b] = rgb.map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
    const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return [
        0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
        1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
        0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
    ];
}

/// Linear light in [0, 1] to an sRGB byte.
function linearToByte(v) {
    v = clamp(v, 0, 1);
    return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
}

const hexToRgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
const rgbToCss = (rgb) => `rgb(${rgb.join(" ")})`;

/// Black over violet and red to pale yellow: errors. Lightness rises throughout, so it reads in grey too.
function magma(t) {
    const hue = ((285 + 170 * t ** 1.15) * Math.PI) / 180;
    const chroma = 0.215 * Math.sin(Math.PI * clamp(0.06 + 0.86 * t, 0, 1)) * Math.min(1, 0.25 + 3 * t);
    return oklabToRgb(0.08 + 0.89 * t, chroma * Math.cos(hue), chroma * Math.sin(hue));
}

/// Violet over teal to yellow: quantities without a middle.
function viridis(t) {
    const hue = ((305 - 200 * t) * Math.PI) / 180;
    const chroma = 0.12 + 0.06 * t * t;
    return oklabToRgb(0.3 + 0.62 * t, chroma * Math.cos(hue), chroma * Math.sin(hue));
}

/// -1 … 1: blue over the page's neutral to orange, anchors from the style sheet so that it fits light and dark.
function diverging(t) {
    const middle = rgbToOklab(hexToRgb(css("--diverging-middle")));
    const end = rgbToOklab(hexToRgb(css(t < 0 ? "--diverging-low" : "--diverging-high")));
    const k = Math.min(1, Math.abs(t));
    return oklabToRgb(...middle.map((m, i) => m + (end[i] - m) * k));
}

const palette = (map, size = 256) => Array.from({ length: size }, (_, i) => map(i / (size - 1)));
const contrastInk = (rgb) => (rgbToOklab(rgb)[0] > 0.62 ? "#111" : "#fff");

/// From Okabe and Ito's colours, moved until any two are 0.1 apart in OKLab, also to eyes that lack the cones for red or
/// green (Machado et al. 2009), with a contrast of at least 3 to the page.
const kSamplerColours = {
    light: ["#1b75a6", "#e25b28", "#059e76", "#ac45e9", "#a74710", "#4899c0", "#545963", "#1a1d1a"],
    dark: ["#1ec1fc", "#d38e2b", "#44a384", "#a978c6", "#d8bd5e", "#0be7ff", "#a0bdb0", "#764de9"],
};
const samplerColour = (index) => {
    const colours = kSamplerColours[isDark() ? "dark" : "light"];
    return colours[index % colours.length];
};

/// A horizontal bar of a colour map with labelled ends.
function colourBar(map, labels, caption) {
    const stops = Array.from({ length: 17 }, (_, i) => rgbToCss(map(i / 16))).join(", ");
    return el(
        "div",
        { class: "colour-bar" },
        caption && el("span", { class: "caption" }, caption),
        el("span", { class: "ramp", style: `background: linear-gradient(to right, ${stops})` }),
        el(
            "span",
            { class: "ends" },
            labels.map((label) => el("span", {}, label)),
        ),
    );
}
