# SPDX-License-Identifier: LGPL-2.1-or-later
"""contrib/report: the numbers of its pages are those of the results, nothing comes from
elsewhere, pages stay small. test_report_browser.py opens them."""

import base64
import gzip
import json
import re
import sys
import tempfile
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import numpy as np

from harness import SOURCE, TestCase, main, run
from plot_process import run_script

sys.path[:0] = [str(SOURCE / "contrib"), str(SOURCE / "contrib" / "python")]

from plotting import quantities
from plotting.body_base import field
from plotting.history import finite
from plotting.results import Results
from plotting.units import Units
from reporting import bill, body, tables, thinning, written
from reporting.markup import formula
from reporting.surface import Surface
from viscoplastic_contact.study.pricing import as_markdown

UNITS = {"Units/Length": "mm", "Units/Time": "s", "Units/Stress": "MPa"}
MOST_BYTES = 5_000_000


def report(*arguments):
    return run_script(SOURCE / "contrib" / "report", *arguments)


class Tables(HTMLParser):
    """Of a page: {id of section: rows of tables}, a row as (title of its first cell,
    values of its numbers); all numbers of a section; scripts by their id."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.numbers, self.words, self.scripts = {}, {}, {}, {}
        self.section = self.script = self.row = None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "section":
            self.section = attributes["id"]
        elif tag == "tr":
            self.row = [None]
            self.rows.setdefault(self.section, []).append(self.row)
        elif tag == "span" and self.row == [None]:
            self.row[0] = attributes.get("title")
        elif tag == "data":
            number = float(attributes["value"])
            self.numbers.setdefault(self.section, []).append(number)
            if self.row is not None:
                self.row.append(number)
        elif tag == "script":
            self.script = attributes.get("id")

    def handle_endtag(self, tag):
        if tag == "script":
            self.script = None
        elif tag == "tr":
            self.row = None

    def handle_data(self, text):
        if self.script:
            self.scripts[self.script] = text
        elif self.section:
            self.words[self.section] = self.words.get(self.section, "") + text


class Page:
    def __init__(self, path):
        self.text = path.read_text()
        tables = Tables(self.text)
        self.rows, self.numbers, self.words = tables.rows, tables.numbers, tables.words
        scripts = tables.scripts
        self.curves = json.loads(scripts.get("curves-data", "null"))
        self.body = json.loads(scripts.get("body-data", "null"))
        packed = base64.b64decode(scripts.get("body-numbers", ""))
        self.content = gzip.decompress(packed) if packed else b""

    def array(self, reference):
        kind, start, length = reference
        return np.frombuffer(self.content, f"<{kind}", length, start).astype(float)

    def points(self, part, moved=True):
        """Places of the vertices that viewer.js works out, magnified once."""
        dim, body = self.body["dimension"], self.body
        places = self.array(part["points"]).reshape(-1, dim) * body["extent"] / 65535
        places += body["low"][:dim]
        if moved:
            shift = (self.array(part["moved"]).reshape(-1, dim) - 32768) / 32767
            places += body["displacement"] * shift
        return places


def page_of(result):
    process = report(result.directory)
    if process.returncode != 0:
        raise AssertionError(process.stderr)
    return Page(Path(process.stdout.strip()))


class Runs(TestCase):
    """One run in space on changing meshes and two ranks, in units; one in the plane."""

    @classmethod
    def setUpClass(cls):
        cls.results = {
            3: run("pad_adaptive", {**UNITS, "Time/Phases": "0.5: 2"}, ranks=2),
            2: run("slab"),
        }
        cls.pages = {dim: page_of(result) for dim, result in cls.results.items()}

    def each(self):
        return [(self.results[dim], self.pages[dim]) for dim in (2, 3)]

    def test_results_are_those_of_the_statistics(self):
        for result, page in self.each():
            rows = [row for row in page.rows["results"] if row[0]]
            for name, last, largest, time in rows:
                values = result[name]
                self.assertEqual(last, values[-1], name)
                self.assertEqual(abs(largest), np.abs(finite(values)).max(), name)
                self.assertIn(largest, values[result["t"] == time], name)
            names = [row[0] for row in rows]
            self.assertLess(names.index("friction_force_x"), names.index("t"))
            wanted = {n for n, v in result.statistics.items() if finite(v).any()}
            self.assertEqual((len(names), set(names)), (len(wanted), wanted))

    def test_errors_are_those_of_the_record(self):
        for result, page in self.each():
            errors = result.info["estimated_error"]
            for value in page.numbers["error"]:
                self.assertIn(value, errors.values())
            for part in ("t", "space", "total", "largest_energy_norm"):
                self.assertIn(errors[part], page.numbers["error"])
            self.assertIn(errors["relative"], page.numbers["computed"])
            peak = result.info["costs"]["peak_memory_MB"]
            self.assertIn(peak, page.numbers["computed"])

    def test_bill_adds_up(self):
        for result, page in self.each():
            *parts, whole = page.numbers["bill"]
            self.assertClose(sum(parts), whole, 1e-9)
            self.assertGreaterEqual(whole, result["wall_total"][-1])
            costs = result.info["costs"]
            seconds, friction = dict(costs["seconds"]), costs["friction_seconds"]
            self.assertGreater(friction, 0.0)
            self.assertLess(friction, seconds["contact"])
            seconds["contact"] -= friction
            for part in (friction, *seconds.values()):
                if part > 0.0:
                    self.assertIn(part, parts)
            printed = re.search(r"^  friction +([\d.]+) ", result.stdout, re.M).group(1)
            self.assertClose(friction, float(printed), 0.05, 1e-3)

    def test_bill_knows_all_phases(self):
        header = SOURCE / "include/viscoplastic_contact/results/run_summary.h"
        text = header.read_text().split("run_phases{", 1)[1]
        names = re.findall(r'\{"([^"]+)"', text)
        self.assertEqual([name for name in bill.PHASES if name != "friction"], names)

    def test_balances(self):
        for result, page in self.each():
            numbers = page.numbers["balances"]
            self.assertIn(np.abs(result["force_balance_defect"][1:]).max(), numbers)
            self.assertIn(result["energy_balance_defect"][-1], numbers)

    def test_remarks_and_origin(self):
        for result, page in self.each():
            info = result.info
            for sentence in info.get("remarks", ["nothing to warn of"]):
                self.assertIn(sentence, page.words["remarks"])
            for name in ("version", "git_revision", "processor", "date"):
                self.assertIn(info[name], page.words["again"])
            for effect in info["effects"]:
                self.assertIn(effect, page.words["computed"])
            link = r'download="results.prm" href="data:[^,]*,([^"]*)"'
            saved = base64.b64decode(re.search(link, page.text).group(1))
            parameters = (result.directory / "parameters.prm").read_bytes()
            self.assertEqual(saved, parameters)
        for sentence in self.results[3].info["remarks"]:
            self.assertIn(sentence, self.results[3].stdout)
        self.assertIn("mpirun -n 2 ", self.pages[3].text)
        # Of laws only that of the material.
        words = self.pages[2].words["again"]
        found = [f"Material / {law}" in words for law in ("maxwell", "perzyna")]
        self.assertEqual(found, [True, False])

    def test_curves_are_the_columns(self):
        for result, page in self.each():
            times = page.curves["time"]
            sizes = np.array(times["values"]) * times["size"]
            self.assertClose(sizes, result["t"], 1e-5)
            columns = {}
            for panel in page.curves["panels"]:
                for line in panel["lines"]:
                    columns[line["column"]] = line["values"]
            for name in ("friction_force_x", "stored_energy", "max_displacement"):
                shown, there = np.array(columns[name]), result[name]
                at = np.abs(there).argmax()
                # one factor for all: the unit
                self.assertClose(shown / shown[at], there / there[at], 1e-5, 1e-9, name)
            share = 100.0 * result["estimate_total"] / result["energy_norm"].max()
            self.assertClose(columns["estimate_total"], share, 1e-5)

    def test_body_is_that_of_the_fields(self):
        for result, page in self.each():
            results = Results(result.directory)
            frames = page.body["frames"]
            self.assertEqual([f["t"] for f in frames], [t for t, _ in results.solution])
            for index in (0, len(frames) // 2, len(frames) - 1):
                self.compare(page, frames[index], results.body(index))

    def compare(self, page, frame, record):
        dim = page.body["dimension"]
        surface = Surface(record)
        expected = record.points + record["displacement"]
        allowed = 2e-5 * (page.body["extent"] + page.body["displacement"])
        self.assertClose(
            page.points(frame), expected[surface.vertices][:, :dim], absolute=allowed
        )
        faces = page.array(frame["faces"]).reshape(-1, 4).astype(int)
        self.assertEqual(len(faces), len(surface.faces))
        for name, legend in page.body["fields"].items():
            values = field(record, name)
            self.assertClose(frame["ends"][name], [values.min(), values.max()], 1e-6)
            if name not in frame["fields"]:
                continue
            low, high = legend["low"], legend["high"]
            levels = low + page.array(frame["fields"][name]) / 255.0 * (high - low)
            on = surface.corners if legend["onCells"] else surface.vertices
            allowed = 0.51 / 255 * (high - low)
            self.assertClose(levels, np.clip(values[on], low, high), absolute=allowed)

    def test_contact_face(self):
        for result, page in self.each():
            contact = result.fields("contact")
            face = page.body["frames"][-1]["face"]
            self.assertEqual(
                len(page.array(face["faces"])) // face["corners"], len(contact.cells)
            )
            names = [state["name"] for state in page.body["states"]]
            shown = {names[int(i)] for i in page.array(face["states"])}
            slips = contact.point_data["stick"] < 0.5
            has_bound = contact.point_data["bound"] > 0.0
            self.assertEqual("slip" in shown, (slips & has_bound).any())
            self.assertEqual("stick" in shown, (~slips & has_bound).any())

    def test_what_does_not_fit_is_left_out_and_told(self):
        results = Results(self.results[2].directory)
        whole = body.Body(results)
        self.assertEqual(whole.thinned, [])
        small = body.Body(results, most=whole.packed.size // 8)
        self.assertLess(small.packed.size, whole.packed.size // 2)
        limits = {"MOST_BYTES": whole.packed.size, "MOST_TEXT": len(whole.numbers) - 1}
        with mock.patch.multiple(body, **limits):
            fitting = body.fitting_body(results)
        self.assertLess(len(fitting.numbers), len(whole.numbers))
        self.assertTrue(fitting.thinned)
        text = " ".join(small.thinned)
        n_outputs = len(results.solution)
        self.assertIn(f"{len(small.frames)} of {n_outputs} outputs", text)
        self.assertIn(f"{len(small.names)} of {len(whole.names)} fields", text)
        # the first and the last output are there in any case
        shown = [small.frames[0].time, small.frames[-1].time]
        self.assertEqual(shown, [results.solution[i][0] for i in (0, -1)])

    def test_units(self):
        page = self.pages[3]
        self.assertEqual(page.curves["time"]["label"], "time <i>t</i> [ms]")
        self.assertRegex(page.body["fields"]["von_mises"]["unit"], "Pa$")
        self.assertRegex(page.words["results"], r"friction force exerted by the body.*N")

    def test_nothing_comes_from_elsewhere_and_pages_are_small(self):
        for _, page in self.each():
            self.assertLess(len(page.text.encode()), MOST_BYTES)
            markup = re.sub(r"<script.*?</script>", "", page.text, flags=re.DOTALL)
            loads = re.findall(r'(?:src|href)="([^"]*)"', markup)
            self.assertTrue(loads)
            for place in loads:
                self.assertRegex(place, "^(data:|#)")
            self.assertNotRegex(markup, r"@import|url\(")
            self.assertNotRegex(page.text, "<script[^>]* src=")

    def test_same_results_same_page(self):
        result = self.results[2]
        other = result.directory / "other.html"
        self.assertEqual(report(result.directory, "--output", other).returncode, 0)
        self.assertEqual(other.read_text(), self.pages[2].text)


class OtherResults(TestCase):
    def test_without_contact_error_bar_and_outputs(self):
        result = run(
            "cantilever_creep",
            {"Error control/Error bar": "false", "Time/Phases": "0.13: 2"},
        )
        page = page_of(result)
        self.assertFalse(page.body["faceFields"])
        self.assertNotIn("face", page.body["frames"][-1])
        self.assertIn("no error bar", page.words["error"])
        self.assertIn("has not been estimated", page.words["computed"])
        # what a run leaves that is killed before its first output
        for path in result.directory.glob("*.pvd"):
            path.unlink()
        info = result.info
        del info["costs"]
        (result.directory / "run.json").write_text(json.dumps(info))
        page = page_of(result)
        self.assertIsNone(page.body)
        self.assertIn("no solution.pvd", page.words["view"])
        self.assertIn("has not ended", page.words["remarks"])
        statistics = result.directory / "statistics.csv"
        statistics.write_text("\n".join(statistics.read_text().splitlines()[:2]) + "\n")
        page = page_of(result)
        self.assertIsNone(page.curves)
        (result.directory / "run.json").unlink()
        self.assertIn("no run.json", page_of(result).words["remarks"])

    def test_refused(self):
        with tempfile.TemporaryDirectory() as directory:
            directory = Path(directory)
            for arguments, words in (
                ([directory / "nowhere"], "there is no directory"),
                ([directory], "it is no directory of results"),
            ):
                process = report(*arguments)
                self.assertEqual(process.returncode, 1)
                self.assertRegex(process.stderr, f"^Error: .*{words}")
                self.assertEqual(len(process.stderr.splitlines()), 1)
            (directory / "statistics.csv").write_text("step,t,k\n0,0,0\n1,1\n2,2,1\n")
            process = report(directory)
            self.assertEqual(process.returncode, 1)
            self.assertIn("is damaged", process.stderr)
        help_text = report("--help").stdout
        self.assertIn("RESULTS/<its name>.html", help_text)


class Written(TestCase):
    """Pages of studies and of effects."""

    MARKDOWN = """\
# Study of `a_b.prm`

Two *words* and **more**, a < b, [a link](place.md), 2*3*4.

## Runs
| run | error |
| --- | --- |
| `h0_k0` | 0.5 |

- one
  and its second line
- two

    contrib/plot output

![convergence](convergence.png)
![missing](../secret.txt)
"""

    def test_markdown_of_studies(self):
        with tempfile.TemporaryDirectory() as directory:
            directory = Path(directory)
            (directory / "study.md").write_text(self.MARKDOWN)
            for name in ("convergence", "cost"):
                (directory / f"{name}.png").write_bytes(name.encode())
            process = report(directory)
            self.assertEqual(process.returncode, 0, process.stderr)
            path = Path(process.stdout.strip())
            self.assertEqual(path.name, "study.html")
            text = path.read_text()
        for part in (
            "<h2>Study of <code>a_b.prm</code></h2>",
            "Two <i>words</i> and <b>more</b>, a &lt; b, a link, 2*3*4.",
            "<h3>Runs</h3>",
            "<td><code>h0_k0</code></td><td>0.5</td>",
            "<li>one\n  and its second line\n</li>",
            "<pre>contrib/plot output</pre>",
        ):
            self.assertIn(part, text)
        for name in ("convergence", "cost"):  # the second one is not mentioned
            content = base64.b64encode(name.encode()).decode()
            self.assertEqual(text.count(f"base64,{content}"), 1)
        self.assertIn("missing", text)

    def test_kinds(self):
        with tempfile.TemporaryDirectory() as directory:
            directory = Path(directory)
            self.assertIsNone(written.kind_of(directory))
            for kind in "effects", "price":
                (directory / f"{kind}.md").write_text("# Title\n")
                self.assertEqual(written.kind_of(directory), kind)

    def test_price(self):
        """What the console says becomes paragraphs, points and options."""
        said = "Pilots:\n  a: 8 cells,   1 s\n  b: 9 cells\nNow with\n  --set A/B=1\n\nEnd\n"
        text = written.html(as_markdown(said), Path())
        self.assertEqual(
            re.sub(r"\n", "", text),
            "<p>Pilots:</p><ul><li>a: 8 cells, 1 s</li><li>b: 9 cells</li></ul>"
            "<p>Now with</p><pre>--set A/B=1</pre><p>End</p>",
        )


class Parts(TestCase):
    def test_formulas(self):
        for text, expected in (
            ("a < b", "a &lt; b"),
            ("$u_n$, $|u|$", "<i>u</i><sub><i>n</i></sub>, |<i>u</i>|"),
            (r"$\sigma_\mathrm{vM}$", "σ<sub>vM</sub>"),
            (r"$\varepsilon^\mathrm{i}_{xx}$", "ε<sup>i</sup><sub><i>xx</i></sub>"),
            (r"$\dot{u}_x$", "<i>u</i>\u0307<sub><i>x</i></sub>"),
            (r"$\dot\varepsilon_\mathrm{c}$", "ε\u0307<sub>c</sub>"),
            ("$10^{-3}$ m", "10<sup>−3</sup> m"),
            (r"costs \$5", "costs $5"),
        ):
            self.assertEqual(formula(text), expected, text)

    def test_tolerance_where_no_error_bar_is_true(self):
        results = SimpleNamespace(data={("Error control", "Tolerance"): "0.3"})
        for share, jump, words in (
            (0.2, {}, "has been kept"),
            (0.2, {"prescribed_jump": [1, 0]}, "met by the estimate alone"),
            (0.4, {"prescribed_jump": [1, 0]}, "has <b>not</b> been kept"),
        ):
            about = {"estimated_error": {"relative": share}, **jump}
            self.assertIn(words, tables.tolerance(results, about))

    def test_places_have_their_names(self):
        """Where a quantity is that of a point; what slips into equilibrium is told."""
        parts = dict.fromkeys(("space", "total", "largest_value"), 1.0)
        about = {"quantity": "point1_y", "t": 0.0, **parts}
        statistics = {"t": np.arange(2.0), "slip_area": np.array([2.0, 1.0])}
        results = SimpleNamespace(statistics=statistics, data={})
        names = {"point 1": "crown"}
        with mock.patch.object(quantities, "names_of_places", names):
            text = tables.errors(results, {"estimated_error_of_quantity": about}, Units())
        self.assertIn("Of displacement of crown, <i>y</i>, largest", text)
        table = tables.columns(statistics, ["slip_area"], Units())
        self.assertIn("(initial equilibrium)", table)

    def test_bill_of_a_resumed_run(self):
        """The record has the seconds since the restart, the statistics all."""
        seconds = {"contact": 4.0, "set-up": 1.0}
        for contact, words in (([2.0, 2.0], "initial state"), ([2.0, 6.0], "restart")):
            total = {"wall_total": [6.0, 20.0], "wall_contact": np.array(contact)}
            results = SimpleNamespace(statistics=total)
            text = bill.bars(results, {"costs": {"seconds": seconds}})
            last = text.split('<div role="listitem">')[-1]
            self.assertIn(words, last)
            self.assertIn('<data value="15.0">', last)

    @staticmethod
    def area(faces, places):
        corners = places[faces][:, :, :2]
        ahead = np.roll(corners, -1, axis=1)
        return 0.5 * (
            corners[..., 0] * ahead[..., 1] - corners[..., 1] * ahead[..., 0]
        ).sum(axis=1)

    @staticmethod
    def square(n, refined=()):
        """Cells of the unit square, numbered as refinement leaves them: those of the
        first refinement row by row, of those in `refined' the four children."""
        faces, places, number = [], [], {}

        def vertex(x, y):
            if (x, y) not in number:
                number[x, y] = len(places)
                places.append((x, y, 0.0))
            return number[x, y]

        def add(x, y, size):
            around = ((0, 0), (1, 0), (1, 1), (0, 1))
            faces.append([vertex(x + size * i, y + size * j) for i, j in around])

        coarse = [(i, j) for j in range(n) for i in range(n)]
        for i, j in coarse:
            if (i, j) not in refined:
                add(i / n, j / n, 1 / n)
        for i, j in coarse:
            if (i, j) in refined:
                for b in (0, 1):
                    for a in (0, 1):
                        add((2 * i + a) / (2 * n), (2 * j + b) / (2 * n), 0.5 / n)
        return np.array(faces), np.array(places)

    def test_families_become_the_face_that_they_were(self):
        refined = [(i, j) for i in range(8) for j in range(8) if (i + j) % 3]
        faces, places = self.square(8, refined)
        plain, _ = self.square(8)
        new, owner = thinning.merged(faces, most=len(faces) - 1)
        self.assertEqual(len(new), len(plain))
        self.assertClose(np.sort(self.area(new, places)), 1 / 64, 1e-12)
        # each old face lies in the one that stands for it
        middles = places[faces].mean(axis=1)
        low, high = places[new].min(axis=1)[owner], places[new].max(axis=1)[owner]
        self.assertTrue(((low <= middles) & (middles <= high)).all())
        # as those of surfaces in space, which begin and turn otherwise
        turned = np.array([np.roll(face[::-1], i) for i, face in enumerate(faces)])
        again, _ = thinning.merged(turned, most=len(faces) - 1)
        self.assertEqual(len(again), len(plain))
        self.assertClose(self.area(again, places), -1 / 64, 1e-12)

    def test_faces_around_a_vertex_are_no_family_unless_they_close(self):
        n = 5
        star = [[0, 1 + 2 * i, 2 + 2 * i, 1 + (2 * i + 2) % (2 * n)] for i in range(n)]
        faces, owner = thinning.merged(np.array(star), most=1)
        self.assertEqual(faces.tolist(), star)
        self.assertEqual(owner.tolist(), list(range(n)))

    def test_meshes_without_families(self):
        faces, places = self.square(40)
        edges = [(f[k], f[(k + 1) % 4]) for f in faces for k in range(4)]
        on_edge = [
            (a, b)
            for a, b in edges
            if any(places[a][d] == places[b][d] in (0.0, 1.0) for d in (0, 1))
        ]
        new, outline, owner = thinning.clustered(faces, np.array(on_edge), places, 400)
        self.assertLessEqual(len(new), 400)
        self.assertGreater(len(new), 200)
        # no hole, no overlap, corners where they were
        self.assertClose(self.area(new, places).sum(), 1.0, 1e-12)
        self.assertGreater(self.area(new, places).min(), 0.0)
        self.assertClose(np.ptp(places[outline].reshape(-1, 3), axis=0), (1, 1, 0))
        self.assertEqual(set(owner), {*range(-1 if -1 in owner else 0, len(new))})

    def test_means_of_what_faces_stand_for(self):
        faces, places = self.square(4, [(i, j) for i in range(4) for j in range(4)])
        cells = np.arange(4 * len(faces)).reshape(-1, 4)
        points = places[faces].reshape(-1, 3)
        record = SimpleNamespace(points=points, cells=cells, size=1.0)
        surface = Surface(record, most=16)
        self.assertEqual((surface.n_before, len(surface.faces)), (64, 16))
        x = np.repeat(points[cells].mean(axis=1)[:, 0], 4)
        on_faces = surface.on_faces(x)
        expected = points[surface.vertices][surface.faces].mean(axis=1)[:, 0]
        self.assertClose(on_faces, expected, 1e-12)

    def test_bodies_that_touch_move_by_themselves(self):
        """Two cells, one over the other without a gap: two bodies where they part."""
        square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
        points = np.concatenate([square, square + [0, 1, 0]])
        record = SimpleNamespace(
            points=points, cells=np.arange(8).reshape(2, 4), size=2.0, data={}
        )
        apart = np.repeat([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0]], 4, axis=0)
        for moved, n_vertices, n_edges in ((0 * apart, 6, 6), (apart, 8, 8)):
            for given in (None, moved):
                record.data = {} if given is not None else {"displacement": moved}
                surface = Surface(record, moved=given)
                self.assertEqual(len(surface.vertices), n_vertices)
                self.assertEqual(len(surface.edges), n_edges)
        # Of two cubes the faces between them are seen where they part.
        below = np.concatenate([square, square + [0, 0, 1]])
        for way, n_faces in (0.0, 10), (0.3, 12):
            record = SimpleNamespace(
                points=np.concatenate([below, below + [0, 0, 1]]),
                cells=np.arange(16).reshape(2, 8),
                size=2.0,
                data={"displacement": np.repeat([[0, 0, 0], [way, 0, 0]], 8, axis=0)},
            )
            self.assertEqual(len(Surface(record).faces), n_faces)

    def test_vtk_js_is_that_of_the_lock_file(self):
        folder = SOURCE / "contrib" / "reporting" / "vtk"
        lock = json.loads((folder / "package-lock.json").read_text())["packages"]
        wanted = json.loads((folder / "package.json").read_text())["dependencies"]
        text = (folder / "vtk.min.js").read_text()
        head = text[: text.index("*/")]
        inside = dict(re.findall(r"^(@?[a-z][\w./-]*) (\d+\.\d+\.\d+)$", head, re.M))
        self.assertIn("@kitware/vtk.js", inside)
        for name, version in inside.items():
            self.assertEqual(lock[f"node_modules/{name}"]["version"], version, name)
        for name, version in wanted.items():
            self.assertEqual(inside[name], version)
        parts = set(re.findall(r"default as (\w+) ", (folder / "parts.js").read_text()))
        viewer = (folder.parent / "viewer.js").read_text()
        self.assertEqual(set(re.findall(r"\bvtk\.([A-Z]\w+)", viewer)), parts)
        self.assertLess(len(text), 600_000)


if __name__ == "__main__":
    main()
