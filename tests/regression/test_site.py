# SPDX-License-Identifier: LGPL-2.1-or-later
"""The site of the documents: its links lead somewhere, formulas are drawn, and the search
finds pages.

Skipped (exit code 77) without MkDocs and KaTeX; the second part without Chromium.
"""

import importlib.util
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from browser import Browser, executable
from harness import SOURCE, TestCase, main

HAS_MKDOCS = (
    importlib.util.find_spec("mkdocs") is not None
    and Path("/usr/share/javascript/katex").exists()
)


class Links(HTMLParser):
    """What a page links to, and the places that it has."""

    def __init__(self, file):
        super().__init__()
        self.targets, self.places = [], set()
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.places.add(attributes.get("id"))
        for name in "href", "src":
            if attributes.get(name):
                self.targets.append(attributes[name])


class Site(TestCase):
    @classmethod
    def setUpClass(cls):
        work = tempfile.TemporaryDirectory()
        cls.addClassCleanup(work.cleanup)
        cls.site = Path(work.name).resolve() / "site"
        cls.process = subprocess.run(
            [SOURCE / "doc" / "site" / "build", cls.site],
            capture_output=True,
            text=True,
        )

    def test_links_lead_somewhere(self):
        self.assertEqual(self.process.returncode, 0, self.process.stderr)
        pages = {file: Links(file) for file in self.site.rglob("*.html")}
        self.assertGreater(len(pages), 25)
        n_links = 0
        for file, links in pages.items():
            for target in links.targets:
                url = urlsplit(target)
                if url.scheme:
                    continue
                other = (file.parent / unquote(url.path)).resolve() if url.path else file
                with self.subTest(page=file.name, link=target):
                    self.assertTrue(other.exists())
                    if url.fragment and other in pages:
                        self.assertIn(unquote(url.fragment), pages[other].places)
                n_links += 1
        self.assertGreater(n_links, 1000)

    def test_every_page_is_there(self):
        for page in (SOURCE / "doc").glob("*.md"):
            html = (self.site / "doc" / f"{page.stem}.html").read_text(encoding="utf-8")
            with self.subTest(page=page.name):
                self.assertNotRegex(html, r"formula\d+here")
                self.assertNotIn("```", html)

    @unittest.skipUnless(executable(), "there is no Chromium")
    def test_formulas_and_search(self):
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(self.site / "doc" / "method.html")
        browser.wait("document.readyState === 'complete'")
        n_formulas, n_drawn = browser.run(
            "['.tex', '.tex > .katex, .tex > .katex-display']"
            ".map((what) => document.querySelectorAll(what).length)"
        )
        self.assertGreater(n_formulas, 200)
        self.assertEqual(n_drawn, n_formulas)
        self.assertEqual(browser.run("document.querySelectorAll('.katex-error').length"), 0)
        browser.run(
            "{ const field = document.getElementById('search'); field.value = 'Normal "
            "COMPLIANCE'; field.dispatchEvent(new Event('input')); }"
        )
        first = browser.run("document.querySelector('#found a').href")
        self.assertEqual(first, f"{self.site.as_uri()}/doc/method.html#normal-compliance")
        # Wide tables scroll by themselves, not the page.
        browser.size(1000, 800)
        browser.open(self.site / "doc" / "results.html")
        browser.wait("document.readyState === 'complete'")
        wider = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        self.assertEqual(browser.run(wider), 0)
        self.assertEqual(browser.errors, [])


if __name__ == "__main__":
    if not HAS_MKDOCS:
        print("Skipped: there is no MkDocs or no KaTeX.")
        sys.exit(77)
    main()
