// HDR pictures in the page: base64 of RGB9E5 (three 9-bit mantissas, one 5-bit exponent, little-endian; value = m · 2^(e − 24)),
// or of a JPEG of codes (value = toe · sinh(step · code)).

const kErrorRange = [0.01, 10]; // of the false colours, relative error
const kRelativeEpsilon = 0.01; // added to r², as in relMSE

function embeddedBytes(id) {
    const text = atob(document.getElementById(`image-${id}`).textContent),
        bytes = new Uint8Array(text.length);
    for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
}

class Picture {
    constructor(id) {
        Object.assign(this, data.images[id]);
        this.id = id;
        this.canvas = document.createElement("canvas");
        this.canvas.width = this.width;
        this.canvas.height = this.height;
    }

    get isJpeg() {
        return this.toe !== undefined;
    }

    /// A browser decodes a JPEG beside other work, once: `rgb` is there when it has.
    ready() {
        return (this.decoding ??= this.decodeJpeg());
    }

    async decodeJpeg() {
        const jpeg = new Blob([embeddedBytes(this.id)], { type: "image/jpeg" }),
            bitmap = await createImageBitmap(jpeg, { colorSpaceConversion: "none" }),
            context = new OffscreenCanvas(this.width, this.height).getContext("2d", { willReadFrequently: true });
        context.drawImage(bitmap, 0, 0);
        bitmap.close();
        this.codes = context.getImageData(0, 0, this.width, this.height).data;
    }

    get rgb() {
        return (this.decoded ??= this.isJpeg ? this.decodeCodes() : this.decodeRgb9e5());
    }

    decodeCodes() {
        const values = Float32Array.from({ length: 256 }, (_, code) => this.toe * Math.sinh(this.step * code));
        const out = new Float32Array(3 * this.width * this.height);
        for (let i = 0, j = 0; j < out.length; i += 4, j += 3)
            for (let c = 0; c < 3; ++c) out[j + c] = values[this.codes[i + c]];
        this.codes = null;
        return out;
    }

    decodeRgb9e5() {
        const bytes = embeddedBytes(this.id);
        const scale = Array.from({ length: 32 }, (_, e) => 2 ** (e - 24));
        const out = new Float32Array(3 * this.width * this.height);
        for (let i = 0, j = 0; j < out.length; i += 4, j += 3) {
            const word = bytes[i] | (bytes[i + 1] << 8) | (bytes[i + 2] << 16) | (bytes[i + 3] << 24);
            const unit = scale[word >>> 27];
            out[j] = (word & 511) * unit;
            out[j + 1] = ((word >>> 9) & 511) * unit;
            out[j + 2] = ((word >>> 18) & 511) * unit;
        }
        return out;
    }

    /// Relative error of pixel i: √ of the mean over channels of (x − r)² / (r² + ε).
    relativeError(i, reference) {
        const x = this.rgb,
            r = reference.rgb;
        let total = 0;
        for (let c = 3 * i; c < 3 * i + 3; ++c) total += (x[c] - r[c]) ** 2 / (r[c] ** 2 + kRelativeEpsilon);
        return Math.sqrt(total / 3);
    }

    /// The canvas with the picture at an exposure (in stops) or, with a reference, its relative error in false colour.
    shown(exposure, reference) {
        const stamp = reference ? `error ${reference.id}` : `exposure ${exposure}`;
        if (this.stamp === stamp) return this.canvas;
        this.stamp = stamp;
        const pixels = new ImageData(this.width, this.height);
        if (reference) this.paintError(pixels.data, reference);
        else this.paintTones(pixels.data, exposure);
        this.canvas.getContext("2d").putImageData(pixels, 0, 0);
        return this.canvas;
    }

    paintTones(out, exposure) {
        const gain = 2 ** exposure * 4095,
            rgb = this.rgb;
        for (let i = 0, j = 0; j < rgb.length; i += 4, j += 3) {
            for (let c = 0; c < 3; ++c) out[i + c] = kToneCurve[Math.min(4095, rgb[j + c] * gain) | 0];
            out[i + 3] = 255;
        }
    }

    paintError(out, reference) {
        for (let i = 0; i < this.width * this.height; ++i) {
            const [r, g, b] = kErrorPalette[Math.round(255 * errorPlace(this.relativeError(i, reference) + 1e-12))];
            out[4 * i] = r;
            out[4 * i + 1] = g;
            out[4 * i + 2] = b;
            out[4 * i + 3] = 255;
        }
    }
}

/// A byte for each block of an image: how much its runs scatter, or whether their mean is the reference.
class BlockMap {
    constructor(id, colour) {
        Object.assign(this, data.images[id]);
        this.bytes = embeddedBytes(id);
        this.canvas = document.createElement("canvas");
        this.canvas.width = this.width;
        this.canvas.height = this.height;
        this.colour = colour;
    }

    shown() {
        if (this.dark === isDark()) return this.canvas;
        this.dark = isDark();
        const pixels = new ImageData(this.width, this.height),
            colours = Array.from({ length: 256 }, (_, byte) => this.colour(byte));
        this.bytes.forEach((byte, i) => pixels.data.set([...colours[byte], 255], 4 * i));
        this.canvas.getContext("2d").putImageData(pixels, 0, 0);
        return this.canvas;
    }

    /// At a place of the image, both coordinates from 0 to 1.
    at(u, v) {
        const [x, y] = [Math.floor((u / this.span[0]) * this.width), Math.floor((v / this.span[1]) * this.height)];
        return this.bytes[clamp(y, 0, this.height - 1) * this.width + clamp(x, 0, this.width - 1)];
    }
}

/// Relative standard deviation over runs, from its byte; on the scale of the errors it explains.
const deviationOf = (byte) => (byte === 0 ? 0 : 10 ** ((6 * (byte - 1)) / 254 - 3));
const errorPlace = (error) => clamp(Math.log(error / kErrorRange[0]) / Math.log(kErrorRange[1] / kErrorRange[0]), 0, 1);
const deviationColour = (byte) => kErrorPalette[Math.round(255 * (byte === 0 ? 0 : errorPlace(deviationOf(byte))))];

/// Adjusted p with the sign of the difference, from its byte; null where a block is not judged.
const testOf = (byte) => (byte === 0 ? null : { p: 10 ** (-Math.abs(byte - 128) / 20), bright: byte > 128 });
const kSmallestShownP = 1e-4;
const kNotJudged = [128, 128, 128];
function testColour(byte) {
    const test = testOf(byte);
    if (!test) return kNotJudged;
    const size = clamp(Math.log(test.p) / Math.log(kSmallestShownP), 0, 1);
    return diverging(test.bright ? size : -size);
}

/// R-hat, from its byte; null where nothing varies.
const rhatOf = (byte) => (byte === 0 ? null : 2 ** ((byte - 1) / 64 - 1));
const rhatColour = (byte) =>
    byte === 0 ? kNotJudged : kErrorPalette[Math.round(255 * clamp(Math.log2(rhatOf(byte)) / 2, 0, 1))];

/// Share of accepted proposals, from its byte; null where no state was.
const acceptanceOf = (byte) => (byte === 0 ? null : (byte - 1) / 254);
const acceptanceColour = (byte) => (byte === 0 ? kNotJudged : kErrorPalette[byte]);

const kToneCurve = Uint8Array.from({ length: 4096 }, (_, i) => linearToByte(i / 4095));
const kErrorPalette = palette(magma);
const pictureCache = new Map();
function picture(id) {
    if (id === undefined || id === null || !data.images[id]) return null;
    if (!pictureCache.has(id)) pictureCache.set(id, new Picture(id));
    return pictureCache.get(id);
}

/// Before what shows pictures is made.
const decodeJpegs = () =>
    Promise.all(data.images.map((image, id) => (image.toe === undefined ? null : picture(id).ready())));

const blockMapCache = new Map();
function blockMap(id, colour) {
    if (id === undefined || !data.images[id]) return null;
    if (!blockMapCache.has(id)) blockMapCache.set(id, new BlockMap(id, colour));
    return blockMapCache.get(id);
}

/// The exposure, in half stops, that puts the 99th percentile of the picture just below white.
function fittingExposure(image) {
    const { rgb } = image,
        values = new Float32Array(rgb.length / 3);
    for (let i = 0, j = 0; i < values.length; ++i, j += 3) values[i] = Math.max(rgb[j], rgb[j + 1], rgb[j + 2]);
    values.sort();
    const bright = values[Math.floor(0.99 * (values.length - 1))];
    return bright > 0 ? clamp(Math.floor(-2 * Math.log2(bright)) / 2, -12, 12) : 0;
}

/// Sizes the canvas to its box in device pixels and returns its context.
function fitCanvas(canvas) {
    const ratio = devicePixelRatio || 1,
        box = canvas.getBoundingClientRect();
    const width = Math.max(1, Math.round(box.width * ratio)),
        height = Math.max(1, Math.round(box.height * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    return canvas.getContext("2d");
}
