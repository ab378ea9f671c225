# SPDX-License-Identifier: LGPL-2.1-or-later
"""Published cases (prm/verification/literature, where their sources are): the
values that others give, found with the settings that one writes down first."""

import numpy as np

from harness import TestCase, main, run


class Published(TestCase):
    def test_plate_with_friction(self):
        """GRECO: three digits are given, and other programs differ in the last."""
        plate = run("literature/greco_plate")
        published = 2.86, 2.72, 2.28, 1.98, 1.54
        for i, value in enumerate(published):
            self.assertClose(1e5 * plate[f"point{i}_x"][-1], value, absolute=0.01)
        # two of the points have lifted off
        self.assertGreater(plate["point1_y"][-1], 1e-7)
        self.assertClose(plate["point2_y"][-1], 0, absolute=1e-15)

    def test_thick_cylinder_in_creep(self):
        """NAFEMS: the steady state, up to the error of 16 cells across the wall,
        0.9 % with half of them and of second order."""
        cylinder = run("literature/thick_cylinder_creep")
        self.assertClose(cylinder["point0_velocity_x"][-1], 5.190, relative=3e-3)
        table = np.genfromtxt(
            cylinder.directory / "line_0.csv", delimiter=",", names=True
        )
        last, other = table["stress_yy"][-2:]  # one cell apart
        self.assertClose(last + 0.5 * (last - other), 250.4, relative=3e-3)

    def test_cavity_in_salt(self):
        """The steady closure of a ring of finite size; 24 cells across it leave an
        error of 0.7 %, 36 of 0.3 %."""
        cavity = run("literature/salt_cavity")
        p, n, rate, radius = 15, 3, 6e-6, 10
        strength = np.sqrt(3) * p / n / (1 - radius ** (-2 / n))
        closure = np.sqrt(3) / 2 * rate * strength**n
        self.assertClose(cavity["point0_velocity_x"][-1], -closure, relative=0.01)

    def test_slab_on_a_bed_that_does_not_pull(self):
        """Weitsman's beam; that its load is spread, and shear, leave 5 %."""
        slab = run("literature/slab_on_bed")
        bed, load = 50e6, 2e6
        bending = 30e9 / (1 - 0.2**2) * 0.25**3 / 12
        wave = (bed / 4 / bending) ** 0.25
        self.assertClose(slab["contact_force_y"][-1], -0.5 * load, relative=1e-7)
        self.assertClose(slab["contact_area"][-1], np.pi / 2 / wave, relative=0.03)
        depth = load * wave / 2 / bed * (1 + np.cosh(np.pi)) / np.sinh(np.pi)
        self.assertClose(slab["max_penetration"][-1], depth, relative=0.05)


if __name__ == "__main__":
    main()
