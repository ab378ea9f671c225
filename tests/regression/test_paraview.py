# SPDX-License-Identifier: LGPL-2.1-or-later
"""ParaView opens results ready colored: pvbatch draws what a user would see.

Skipped (exit code 77) without pvbatch, or without a display to draw on.
"""

import os
import shutil
import subprocess
import sys

import matplotlib.image
import numpy as np

from harness import SOURCE, TestCase, main, run

SLIP = (0.835, 0.369, 0.0)
STICK = (1.0, 1.0, 1.0)
NO_FRICTION = (0.6, 0.6, 0.6)


def reason_to_skip():
    if not shutil.which("pvbatch"):
        return "pvbatch is not installed (Debian: paraview python3-paraview)"
    if not os.environ.get("DISPLAY") and not shutil.which("Xvfb"):
        return "there is neither a display nor Xvfb (Debian: xvfb)"
    return None


def share(image, color):
    """The part of the pixels that have the color."""
    return (np.abs(image - color).max(axis=2) < 0.03).mean()


class Opens(TestCase):
    @classmethod
    def setUpClass(cls):
        """A display of our own, where there is Xvfb: it names its number as
        soon as it is ready."""
        # nor a daemon of Open MPI for each start
        cls.environment = {
            **os.environ,
            "OMPI_MCA_ess_singleton_isolated": "1",
            "OMPI_MCA_orte_create_session_dirs": "0",
        }
        if not shutil.which("Xvfb"):
            return
        read, write = os.pipe()
        server = subprocess.Popen(
            # Without -noreset it starts anew when its last client has gone, and
            # refuses the next one meanwhile.
            ["Xvfb", "-noreset", "-displayfd", str(write),
             "-screen", "0", "1920x1200x24"],
            pass_fds=[write],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        cls.addClassCleanup(server.wait)
        cls.addClassCleanup(server.terminate)
        os.close(write)
        with os.fdopen(read) as pipe:
            cls.environment["DISPLAY"] = ":" + pipe.readline().strip()

    def pvbatch(self, *arguments, **options):
        return subprocess.run(
            ["pvbatch", *map(str, arguments)],
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=120,
            **options,
        )

    def render(self, result):
        """The picture of the state that contrib/plot writes, and a .pvsm."""
        plot = subprocess.run(
            [sys.executable, SOURCE / "contrib" / "plot", result.directory, "--paraview"],
            capture_output=True,
            text=True,
        )
        self.assertEqual(plot.returncode, 0, plot.stderr)
        state = result.directory / "view.py"
        self.assertEqual(plot.stdout.strip(), str(state))
        return self.draw(result, state, "--state", result.directory / "view.pvsm")

    def draw(self, result, script, *arguments):
        picture = result.directory / "paraview.png"
        process = self.pvbatch(
            script, "--screenshot", picture, *arguments, cwd=result.directory.parent
        )
        self.assertEqual(process.returncode, 0, process.stdout[-3000:])
        self.assertTrue(picture.exists(), process.stdout[-3000:])
        image = matplotlib.image.imread(picture)[:, :, :3]
        self.assertEqual(image.shape[0], 800)
        return image

    def assertColored(self, image):
        """The body in many colors of viridis, not one."""
        hue = image[:, :, 1] - image[:, :, 0]
        colorful = image.max(axis=2) - image.min(axis=2) > 0.15
        self.assertGreater(colorful.mean(), 0.03)
        self.assertGreater(np.ptp(np.quantile(hue[colorful], (0.1, 0.9))), 0.1)

    def test_two_dimensions(self):
        result = run("slab")
        image = self.render(result)
        self.assertColored(image)
        # a band below the body and a bar in the legend: some of each
        for color in SLIP, STICK, NO_FRICTION:
            self.assertGreater(share(image, color), 0.002, color)
        # the state file needs no script
        loader = result.directory / "load.py"
        loader.write_text(
            "import sys\n"
            "from paraview.simple import *\n"
            f"LoadState({str(result.directory / 'view.pvsm')!r})\n"
            "GetAnimationScene().GoToLast()\n"
            "layout = GetLayout(GetActiveView())\n"
            "layout.SetSize(1200, 800)\n"
            "SaveScreenshot(sys.argv[2], layout=layout)\n"
        )
        self.assertColored(self.draw(result, loader))

    def test_three_dimensions_two_views(self):
        """In a scene with units, which the names of its fields have."""
        units = {"Units/Length": "mm", "Units/Time": "s", "Units/Stress": "MPa"}
        result = run("pad_adaptive", {**units, "Time/Phases": "0.5: 5"}, ranks=2)
        image = self.render(result)
        self.assertColored(image)
        middle = image.shape[1] * 55 // 100
        # the right view is the contact face: most of it slips, some sticks
        self.assertGreater(share(image[:, middle:], SLIP), 0.05)
        self.assertGreater(share(image[:, middle:], STICK), 0.05)

    def test_without_friction_and_by_the_script_itself(self):
        result = run("elastic_frictionless")
        script = SOURCE / "contrib" / "paraview" / "open_results.py"
        image = self.draw(result, script, result.directory)
        self.assertGreater(share(image, NO_FRICTION), 0.005)
        self.assertLess(share(image, SLIP), 0.001)

    def test_without_contact(self):
        result = run(
            "cantilever_creep", {"Output/Fields every": 0, "Time/Phases": "0.13: 1"}
        )
        image = self.render(result)
        self.assertColored(image)
        self.assertLess(share(image, NO_FRICTION), 0.002)

    def test_no_results(self):
        result = run("elastic_frictionless")
        script = SOURCE / "contrib" / "paraview" / "open_results.py"
        process = self.pvbatch(script, result.directory.parent)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("holds no solution.pvd", process.stdout)


if __name__ == "__main__":
    if reason_to_skip():
        print("skipped:", reason_to_skip())
        sys.exit(77)
    main()
