#!/usr/bin/env python3
"""Images of running renders in the viewer tev, of which there is a stand-in here that decodes what it is sent."""

import json
import os
import pathlib
import re
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from exr import read_exr

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))

WIDTH, HEIGHT = 48, 32
FILM = ["--set", f"scene.film.width={WIDTH}", "--set", f"scene.film.height={HEIGHT}"]
# More than a connection takes while nobody reads.
LARGE = {"film": ["--set", "scene.film.width=1200", "--set", "scene.film.height=900"], "budget": ("--rays", 10_000), "sampler": "path"}
EXPERIMENT = {
    "scenes": {"box": {"type": "cornell_box"}},
    "film": {"width": WIDTH, "height": HEIGHT},
    "max_depth": 4,
    "samplers": {"path": {"type": "path"}, "mlt": {"type": "mlt", "chains": 50, "bootstrap": 5000}},
    "baseline": "path",
    "budget": {"spp": 64},
    "replicates": 2,
    "snapshots": 0,
    "metrics": ["relmse"],
    "reference": {"sampler": "bdpt", "budget": {"spp": 64}, "part": {"spp": 16}},
}


class Reader:
    """A packet's fields in turn, as in tev: little-endian numbers, texts that end in a zero."""

    def __init__(self, packet):
        self.left = packet

    def take(self, size):
        assert len(self.left) >= size, "the packet is too short"
        taken, self.left = self.left[:size], self.left[size:]
        return taken

    def numbers(self, kind, count):
        return struct.unpack(f"<{count}{kind}", self.take(count * struct.calcsize(f"<{kind}")))

    def text(self):
        end = self.left.index(0)
        return self.take(end + 1)[:-1].decode()


class Viewer:
    """Listens as tev does and keeps `images` by name: lists of rows of pixels. `reads`: bytes it takes before it stops
    reading, or with `closes` before it closes the connection."""

    def __init__(self, reads=None, closes=False, port=0):
        self.reads, self.closes = reads, closes
        self.images, self.created, self.updates, self.errors = {}, [], [], []
        self.connections = 0
        self.socket = socket.create_server(("127.0.0.1", port))
        self.address = "127.0.0.1:%d" % self.socket.getsockname()[1]
        self.done = threading.Event()
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def serve(self):
        while True:
            try:
                connection, _ = self.socket.accept()
            except OSError:
                return
            self.connections += 1
            with connection:
                try:
                    self.listen(connection)
                except Exception as error:  # shown by the test
                    self.errors.append(repr(error))

    def listen(self, connection):
        buffer, taken = b"", 0
        while self.reads is None or taken < self.reads:
            data = connection.recv(1 << 16)
            if not data:
                assert not buffer, "the last packet is not whole"
                return
            taken += len(data)
            buffer += data
            while len(buffer) >= 4 and len(buffer) >= (length := struct.unpack_from("<I", buffer)[0]):
                self.interpret(Reader(buffer[4:length]))
                buffer = buffer[length:]
        if not self.closes:
            self.done.wait()

    def interpret(self, packet):
        operation, focus = packet.numbers("b", 2)
        assert focus in (0, 1), focus
        name = packet.text()
        if operation == 4:
            width, height, channels = packet.numbers("i", 3)
            assert [packet.text() for _ in range(channels)] == ["R", "G", "B"]
            self.images[name] = [[None] * width for _ in range(height)]
            self.created.append(name)
        else:
            assert operation == 6, operation
            (channels,) = packet.numbers("i", 1)
            names = [packet.text() for _ in range(channels)]
            x, y, width, height = packet.numbers("i", 4)
            offsets, strides = packet.numbers("q", channels), packet.numbers("q", channels)
            values = packet.numbers("f", len(packet.left) // 4)
            assert len(values) == max(o + (width * height - 1) * s + 1 for o, s in zip(offsets, strides))
            for row in range(height):
                for column in range(width):
                    at = row * width + column
                    pixel = {n: values[o + at * s] for n, o, s in zip(names, offsets, strides)}
                    self.images[name][y + row][x + column] = (pixel["R"], pixel["G"], pixel["B"])
            self.updates.append(name)
        assert not packet.left, "the packet is too long"

    def close(self):
        """Waits for what was sent."""
        self.done.set()
        self.socket.shutdown(socket.SHUT_RDWR)
        self.socket.close()
        self.thread.join(10)
        assert not self.errors, self.errors


class TevTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def start(self, *arguments):
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        return subprocess.Popen([ULAM, *map(str, arguments)], cwd=self.folder, env=environment, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def ulam(self, *arguments, expect=0):
        start = time.monotonic()
        process = self.start(*arguments)
        out, err = process.communicate(timeout=120)
        self.seconds = time.monotonic() - start
        self.assertEqual(process.returncode, expect, f"{arguments}\n{out}\n{err}")
        return err

    def render(self, output, *more, sampler="mlt", budget=("--spp", 64), film=FILM):
        return self.ulam("render", "cornell_box", "--sampler", sampler, "--seed", 7, *budget, *film, "-o", output, *more)

    def bytes(self, name):
        return (self.folder / name).read_bytes()

    def test_the_viewer_gets_previews_and_the_image_that_is_written(self):
        viewer = Viewer()
        err = self.render("a.exr", "--tev", viewer.address, "--stats", "a.json", budget=("--time", 2.2))
        viewer.close()
        self.assertNotIn("viewer", err)
        self.assertEqual(viewer.created, ["a.exr"])
        self.assertIn(len(viewer.updates), (2, 3))  # after one second, perhaps after two, at the end
        self.assertEqual(viewer.images["a.exr"], read_exr(self.folder / "a.exr"))
        result = json.loads(self.bytes("a.json"))
        self.assertGreater(result["preview_seconds"], 0)
        self.assertLess(result["preview_seconds"], 0.02 * result["wall_seconds"])
        # The same work without a viewer.
        self.ulam("render", "--replay", "a.json", "-o", "again.exr")
        self.assertEqual(self.bytes("again.exr"), self.bytes("a.exr"))

    def test_every_replicate_is_an_image_and_a_viewer_changes_none(self):
        (self.folder / "experiment.json").write_text(json.dumps(EXPERIMENT))
        viewer = Viewer()
        self.ulam("run", "experiment.json", "-o", "watched", "--tev", viewer.address)
        viewer.close()
        self.ulam("run", "experiment.json", "-o", "alone")
        images = sorted(path.relative_to(self.folder / "alone") for path in (self.folder / "alone").rglob("image.exr"))
        for path in images:
            self.assertEqual(self.bytes("watched" / path), self.bytes("alone" / path))
        names = [f"box-{sampler}, replicate {n} of 2" for sampler in ("path", "mlt") for n in (1, 2)]
        parts = [f"reference of box, part {n} of 4" for n in (1, 2, 3, 4)]
        self.assertEqual(sorted(viewer.created), sorted(names + parts))
        for sampler in ("path", "mlt"):
            for n in (0, 1):
                written = read_exr(self.folder / f"watched/cells/box-{sampler}/r00{n}/image.exr")
                self.assertEqual(viewer.images[f"box-{sampler}, replicate {n + 1} of 2"], written)

    def test_a_viewer_that_is_absent_is_named_once(self):
        with socket.create_server(("127.0.0.1", 0)) as unused:
            address = "127.0.0.1:%d" % unused.getsockname()[1]
        self.render("alone.exr")
        err = self.render("a.exr", "--tev", address)
        self.assertEqual(err.count("viewer"), 1)
        self.assertIn(f"warning: no images for the viewer at {address}: Connection refused", err)
        self.assertEqual(self.bytes("a.exr"), self.bytes("alone.exr"))
        err = self.render("a.exr", "--tev", "no-such-host.invalid:14158")
        self.assertEqual(err.count("viewer"), 1)
        self.assertEqual(self.bytes("a.exr"), self.bytes("alone.exr"))

    def test_a_viewer_that_starts_late_gets_the_rest(self):
        (self.folder / "experiment.json").write_text(json.dumps(dict(EXPERIMENT, replicates=12)))
        with socket.create_server(("127.0.0.1", 0)) as unused:
            port = unused.getsockname()[1]
        process = self.start("run", "experiment.json", "-o", "run", "--tev", f"127.0.0.1:{port}")
        self.assertIn("no images for the viewer", process.stderr.readline())
        viewer = Viewer(port=port)
        _, err = process.communicate(timeout=120)
        viewer.close()
        self.assertNotIn("viewer", err)
        self.assertTrue(viewer.created)
        for name in viewer.created:
            if match := re.fullmatch(r"box-(\w+), replicate (\d+) of 12", name):
                image = self.folder / f"run/cells/box-{match[1]}/r{int(match[2]) - 1:03}/image.exr"
                self.assertEqual(viewer.images[name], read_exr(image))

    def test_a_viewer_that_goes_away_or_never_reads_holds_nobody_up(self):
        self.render("alone.exr", **LARGE)
        alone = self.seconds
        for trouble, viewer in {"Connection reset": Viewer(reads=100_000, closes=True), "timed out": Viewer(reads=0)}.items():
            err = self.render("a.exr", "--tev", viewer.address, "--stats", "a.json", **LARGE)
            viewer.done.set()
            self.assertEqual(err.count("viewer"), 1)
            self.assertRegex(err, f"{trouble}|Broken pipe" if viewer.closes else trouble)
            self.assertGreaterEqual(viewer.connections, 1)
            self.assertEqual(viewer.updates, [])
            # Only the program's end waits, for a second that it is patient.
            self.assertLess(self.seconds, 2 * alone + 3)
            self.assertLess(json.loads(self.bytes("a.json"))["preview_seconds"], 0.5)
            self.assertEqual(self.bytes("a.exr"), self.bytes("alone.exr"))

    def test_an_address_is_host_and_port(self):
        for address in ("localhost", "localhost:", ":14158", "localhost:tev", "localhost:70000"):
            err = self.ulam("render", "cornell_box", "--sampler", "mlt", "--spp", 1, "-o", "a.exr", "--tev", address, expect=2)
            self.assertIn("expected HOST:PORT, such as localhost:14158", err)
            self.assertIn(address, err)
        self.assertFalse((self.folder / "a.exr").exists())


if __name__ == "__main__":
    unittest.main()
