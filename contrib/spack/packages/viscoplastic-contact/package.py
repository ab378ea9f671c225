# SPDX-License-Identifier: LGPL-2.1-or-later
"""Recipe for Spack. From the top directory of the sources:

    spack repo add contrib/spack
    spack dev-build viscoplastic-contact@develop

Not tested by the tests of this repository, which have no Spack.
"""

from spack.package import *


class ViscoplasticContact(CMakePackage):
    """Quasi-static frictional contact of elastic-viscoplastic bodies."""

    version("develop")

    depends_on("cmake@3.13.4:", type="build")
    depends_on("mpi")
    depends_on("dealii@9.4:+mpi+trilinos+p4est+muparser")
    depends_on("suite-sparse")
    depends_on("nlohmann-json@3.10:")
    # Mesh files of other programs are converted by a script.
    depends_on("python@3.9:", type=("build", "run"))
    depends_on("py-numpy", type="run")
    depends_on("py-meshio", type="run")

    def cmake_args(self):
        return [
            self.define("DEAL_II_DIR", self.spec["dealii"].prefix),
            self.define("VISCOPLASTIC_PYTHON", self.spec["python"].command.path),
            self.define("VISCOPLASTIC_CONTACT_TESTS", False),
        ]
