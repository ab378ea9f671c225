# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pages of contrib/report in Chromium: they open without an error and without a
network, draw, and do what their controls say.

Skipped (exit code 77) without Chromium.
"""

import re
import sys
import tempfile
from pathlib import Path

import matplotlib.image
import numpy as np

from browser import Browser, executable
from harness import TestCase, main, run
from test_report import UNITS, report

READY = "document.getElementById('box')?.dataset.ready === 'yes'"
SLIP = (0.835, 0.369, 0.0)


class Pages(TestCase):
    @classmethod
    def setUpClass(cls):
        work = tempfile.TemporaryDirectory()
        cls.addClassCleanup(work.cleanup)
        cls.work = Path(work.name)
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)
        cls.browser.size(1000, 800)

    def open(self, result):
        process = report(result.directory)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.browser.open(Path(process.stdout.strip()))
        self.browser.wait(READY)
        self.browser.run("document.getElementById('view').scrollIntoView()")

    def seen(self):
        """The pixels of the view."""
        path = self.work / "seen.png"
        # Two frames later what was asked for has been drawn.
        self.browser.run(
            "new Promise((done) => "
            "requestAnimationFrame(() => requestAnimationFrame(done)))"
        )
        self.browser.picture(path)
        left, top, width, height = self.browser.run(
            "(({left, top, width, height}) => [left, top, width, height])"
            "(document.getElementById('box').getBoundingClientRect())"
        )
        image = matplotlib.image.imread(path)[:, :, :3]
        rows = slice(max(0, round(top)), round(top + height))
        return image[rows, round(left) : round(left + width)]

    def set(self, name, value, event="input"):
        self.browser.run(
            f"{{ const c = document.getElementById('{name}'); c.value = {value!r}; "
            f"c.dispatchEvent(new Event('{event}')); }}"
        )
        return self.seen()

    def text(self, name):
        return self.browser.run(f"document.getElementById('{name}').textContent")

    def assertColorful(self, image, least):
        """Much of the picture is in colors, and in many."""
        colors = image.max(axis=2) - image.min(axis=2) > 0.1
        self.assertGreater(colors.mean(), least)
        self.assertGreater(len(np.unique((image[colors] * 50).round(), axis=0)), 10)

    def assertDiffer(self, one, two, least=0.002):
        self.assertEqual(one.shape, two.shape)
        self.assertGreater((np.abs(one - two).max(axis=2) > 0.05).mean(), least)

    def assertQuiet(self):
        self.browser.run("1")  # whatever is under way has come
        self.assertEqual(self.browser.errors, [])

    def share(self, image, color):
        return (np.abs(image - color).max(axis=2) < 0.03).mean()

    def test_in_space_with_units(self):
        self.open(run("pad_adaptive", {**UNITS, "Time/Phases": "1: 4"}))
        end = self.seen()
        self.assertColorful(end, 0.1)
        time = self.text("time-value")
        start = self.set("time", 0)
        self.assertDiffer(start, end)
        self.assertNotEqual(self.text("time-value"), time)
        self.assertRegex(self.text("time-value"), r"^0 m?s$")
        # curves show the values of that time
        mark = "document.querySelector('.panel .now').getAttribute('x1')"
        self.assertEqual(self.browser.run(mark), "52")
        self.set("time", 4)
        self.assertDiffer(self.set("field", "displacement", "change"), end)
        self.assertRegex(self.text("scale"), r"(?s)displacement \|u\|.*µm")
        self.assertDiffer(self.set("magnify", 0), self.set("magnify", 2))
        # turned with the mouse, then from below
        before = self.seen()
        for kind, x in (("Pressed", 400), ("Moved", 600), ("Released", 600)):
            about = {"type": f"mouse{kind}", "button": "left", "clickCount": 1}
            self.browser.call("Input.dispatchMouseEvent", x=x, y=300, **about)
        self.assertDiffer(self.seen(), before)
        self.browser.run("document.getElementById('below').click()")
        self.assertGreater(self.share(self.seen(), SLIP), 0.02)
        self.assertDiffer(self.set("face", "none", "change"), before)
        self.assertQuiet()

    def test_in_the_plane_dark_and_on_a_phone(self):
        self.open(run("slab"))
        light = self.seen()
        self.assertColorful(light, 0.2)
        self.assertGreater(self.share(light, SLIP), 0.001)
        self.assertGreater(light[5, 5].min(), 0.9)
        self.browser.dark()
        self.assertLess(self.seen()[5, 5].max(), 0.2)
        self.browser.dark(False)
        count = "document.querySelectorAll('.panel path').length"
        n_lines = self.browser.run(count)
        self.assertGreater(n_lines, 10)
        self.browser.run("document.querySelector('.panel input').click()")
        self.assertEqual(self.browser.run(count), n_lines - 1)
        # The beginning takes more room on a logarithmic axis of time.
        self.browser.run("document.querySelector('.panel input').click()")
        line = "document.querySelector('.panel path').getAttribute('d')"
        linear = self.browser.run(line)
        self.browser.run("document.getElementById('logarithmic-time').click()")
        self.assertEqual(self.browser.run(count), n_lines)
        second = r"M\S+ \S+ L(\S+)|M\S+ \S+L(\S+)|M\S+ [^H]+H(\S+)"
        places = [
            float(next(filter(None, re.search(second, text).groups())).split("V")[0])
            for text in (linear, self.browser.run(line))
        ]
        self.assertGreater(places[1], places[0] + 50)
        self.browser.size(380, 700)
        self.browser.wait("document.documentElement.clientWidth === 380")
        self.assertLessEqual(
            self.browser.run("document.documentElement.scrollWidth"), 380
        )
        self.assertColorful(self.seen(), 0.05)
        self.browser.size(1000, 800)
        unnamed = self.browser.run(
            "[...document.querySelectorAll('input, select, button')].filter((e) => "
            "!e.labels?.length && !e.textContent.trim() && !e.ariaLabel).length"
            " + [...document.images].filter((e) => !e.alt).length"
        )
        self.assertEqual(unnamed, 0)
        self.assertQuiet()

    def test_errors_would_be_seen(self):
        """A page that throws, complains or wants something from elsewhere."""
        page = self.work / "bad.html"
        page.write_text(
            "<img src='https://example.org/x.png'><script>console.error('told');"
            "setTimeout(() => { window.told = true; nothing.there; })</script>"
        )
        self.browser.open(page)
        self.browser.wait("window.told")
        errors = "\n".join(self.browser.errors)
        for words in ("example.org", "told", "ReferenceError"):
            self.assertIn(words, errors)


if __name__ == "__main__":
    if not executable():
        print("skipped: Chromium is not installed (Debian: chromium)")
        sys.exit(77)
    main()
