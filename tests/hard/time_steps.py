# SPDX-License-Identifier: LGPL-2.1-or-later
"""Time: steps of every size, ratios of 10^6, loads with kinks and jumps, and
very many steps."""

import os
import threading
from pathlib import Path

import numpy as np

from harness import run
from suite import case

GROUP = "Time"
THETA = 1.3  # mu/eta = 1/THETA for the Maxwell bodies of these scenes
LIMIT = 2 * THETA  # of k for explicit schemes
EXPLICIT = "forward Euler", "Heun"
SCHEMES = *EXPLICIT, "backward Euler"
COLUMNS = "point0_x", "stored_energy", "friction_force_x"


def scene(name, **overrides):
    return run(f"hard/{name}", overrides)


def in_steps(phases, scheme="forward Euler", **more):
    return scene(
        "step_sizes_2d", **{"Time/Phases": phases, "Time/Scheme": scheme, **more}
    )


def end(result):
    return np.array([result[column][-1] for column in COLUMNS])


def relative_error(result, reference):
    """Largest of the relative differences at the end of two runs."""
    return (abs(end(result) - end(reference)) / abs(end(reference))).max()


# ---------------------------------------------------------------- sizes


@case(GROUP, "explicit steps from a 100th of the stability limit up to it: the error "
             "stays below C k")
def step_sizes_explicit(size, report):
    reference = in_steps(f"5.2: {size(1024, 16384)}", "Heun")
    for scheme in EXPLICIT:
        worst = 0
        for n in size((2, 4, 8, 32), (2, 3, 4, 8, 16, 32, 64, 128, 256)):
            result = in_steps(f"5.2: {n}", scheme)
            report.identities(result, 1e-10)
            worst = max(worst, relative_error(result, reference) / (5.2 / n / THETA))
        # The elastic and the creep displacement are equal after a time theta.
        # A Riemann sum misses at most k/2 times the variation of the creep rate,
        # hence k/(2 theta) of the displacement.
        report.figure(
            f"{scheme}, error at the end over k/theta, largest", worst, largest=0.5
        )
    report.figure("largest step, of the limit", 2.6 / LIMIT, 1, 1)


@case(GROUP, "backward Euler with steps up to 1000 relaxation times")
def step_sizes_implicit(size, report):
    since, theta = 1.3, THETA
    for factor in size((1, 1000), (0.1, 1, 10, 100, 1000)):
        last = since + 8 * factor * theta
        fine = in_steps(f"{since}: 16, {last!r}: {size(512, 2048)}", "backward Euler")
        result = in_steps(f"{since}: 16, {last!r}: 8", "backward Euler")
        report.identities(result, 1e-10)
        # Under constant load the rate decays to that of the steady flow, so the
        # error is at most k/2 times the variation of the rate, as above; the
        # displacement grows with t/theta.
        report.figure(
            f"k = {factor:g} theta, error at the end after 8 steps, relative",
            relative_error(result, fine),
            largest=0.5 / 8,
        )
    report.figure("largest step, of 2/r", result["k"].max() / LIMIT, least=499)


@case(
    GROUP,
    "a thousand steps of 1e-11, or a few of one rounding error, between ordinary "
    "ones: nothing changes beyond O(k)",
)
def tiny_steps(size, report):
    def phases(inserted):
        return f"0.65: 8, {inserted}1.3: 8, 5.2: 48"

    for scheme in SCHEMES:
        plain = in_steps(phases(""), scheme)
        for name, inserted in (
            ("1e-11", "0.65000001: 1000, "), ("1e-14", "0.65000000000001: 1, ")
        ):
            result = in_steps(phases(inserted), scheme)
            report.identities(result, 1e-10)
            # the steps after it are shorter by 1e-8/8, and each of the many may
            # stop within the contact tolerance
            report.figure(
                f"{scheme}, with steps of {name}, relative",
                relative_error(result, plain),
                largest=1e-8,
            )
            report.figure(
                "estimated time error at the end, over that without them",
                result["estimate_time"][-1] / plain["estimate_time"][-1],
                0.5,
                2,
            )
    n_first = 8 * size(4, 16)  # factors of 10^(1/4), 10^(1/16) from 1e-8 to 1
    times = 1.3 * 10.0 ** np.linspace(-8, 0, n_first + 1)
    growing = in_steps(", ".join(f"{t!r}: 1" for t in times.tolist()) + ", 5.2: 24")
    equal = in_steps("1.3: 8, 5.2: 24")
    fine = in_steps(f"5.2: {size(1024, 8192)}", "Heun")
    report.identities(growing, 1e-10)
    steps = np.log10(growing["k"][1:])
    report.figure("smallest and largest step apart, decades", np.ptp(steps))
    report.figure(
        "steps that grow from 1e-8, error of that of equal steps",
        relative_error(growing, fine) / relative_error(equal, fine),
        largest=2,
    )


@case(GROUP, "long and short steps in turn, with ratios up to 10^6: the error of the "
             "long ones")
def step_ratios(size, report):
    n = size(52, 104)  # a step ends at the kink of the load
    k = 5.2 / n

    def in_turn(ratio):
        ends = ((i + part) * k for i in range(n) for part in (1 / ratio, 1))
        return ", ".join(f"{t!r}: 1" for t in ends)

    for scheme in SCHEMES:
        equal = in_steps(f"5.2: {n}", scheme)
        for ratio in 1e3, 1e6:
            result = in_steps(in_turn(ratio), scheme)
            report.identities(result, 1e-10)
            report.figure(
                f"{scheme}, ratio {ratio:g}, difference from equal steps, over "
                "k/theta, times the ratio",
                relative_error(result, equal) / (k / THETA) * ratio,
                # all steps are shorter by the ratio, so the difference is at
                # most the error over the ratio; 1e-9: contact tolerance
                largest=1 + ratio * 1e-9,
            )
            report.figure(
                "estimated time error, of that with equal steps",
                result["estimate_time"][-1] / equal["estimate_time"][-1],
                0.5,
                2,
            )


# ---------------------------------------------------------------- loads


def layer(y, t, before=0.1, after=0.4, bound=0.1, jump=0.5):
    """u_x of load_jump_2d.prm: (elastic part + its integral over theta)/mu."""

    def stress_integral(b):  # from y to the ceiling
        return min(b / 2, bound) * (1 - y) - b * (1 - y**2) / 2

    now = stress_integral(before if t < jump else after)
    past = stress_integral(before) * min(t, jump)
    past += stress_integral(after) * max(0, t - jump)
    return -2.6 * (now + past / THETA)


def layer_error(result):
    return max(
        abs(result[f"point{p}_x"][i] - layer(y, t))
        for p, y in ((0, 0), (1, 0.5))
        for i, t in enumerate(result["t"])
    )


@case(
    GROUP,
    "a load that jumps, outside of the theory: exact equilibrium after it, the "
    "displacement right to O(k)",
)
def load_jumps(size, report):
    n = size(10, 100)
    # What creeps in a step at the stress after the jump and not at that before
    # it, largest at the foot: k int (tau_2 - tau_1)/(theta mu).
    per_step = 2.6 * (0.4 / 2 - 0.1 - (0.1 / 2 - 0.05)) / THETA
    for scheme in SCHEMES:
        for name, phases, share in (
            ("at the end of a step", f"0.5: {n}, 1: {n}",
             {"forward Euler": 0, "Heun": 0.5, "backward Euler": 1}),
            ("in the middle of a step", f"1: {2 * n - 1}",
             {"forward Euler": 0.5, "Heun": 0, "backward Euler": 0.5}),
            ("in a step of 1e-9", f"0.4999999995: {n}, 0.5000000005: 1, 1: {n}",
             {scheme: 0 for scheme in SCHEMES}),
        ):  # fmt: skip
            result = scene(
                "load_jump_2d", **{"Time/Phases": phases, "Time/Scheme": scheme}
            )
            report.identities(result, 1e-10)
            if "Data jump in time ('Boundary 0/Traction' at t = 0.5," not in (
                result.stdout
            ):
                raise AssertionError("the program does not say so")
            k = result["k"].max()
            report.figure(
                f"{scheme}, jump {name}: error, of what creeps in a step",
                layer_error(result) / (k * per_step),
                share[scheme] - 1e-6,
                share[scheme] + 1e-6,
            )
            after = result["t"] >= 0.5
            report.figure(
                "balance of forces after it", result["force_balance_defect"][after].max(),
                largest=1e-8,
            )
    report.figure(
        "work that the jump leaves open, over (change of the multiplier) slip/2",
        jump_defect(result),
        1 - 1e-6,
        1 + 1e-6,
    )


def jump_defect(result):
    """The defect of the energy balance in the step of the jump; see
    doc/method.md, section 10."""
    step = np.argmax(np.diff(result["load_x"]))
    change = [np.diff(result[c])[step] for c in
              ("friction_force_x", "point0_x", "energy_balance_defect")]
    return -2 * change[2] / (change[0] * change[1])


@case(GROUP, "loads with kinks at the ends of steps or inside: first order")
def load_kinks(size, report):
    # A trapezium that goes up, stays, falls through zero and stays: four kinks,
    # onset of slip, reversal.
    load = "0.3*if(t < 1, t, if(t < 2, 1, if(t < 4, 3 - t, -1))); 0"
    entries = {"Boundary 0/Traction": load, "Time/Scheme": "forward Euler"}
    fine = scene(
        "step_sizes_2d",
        **{**entries, "Time/Phases": f"5: {size(1280, 10240)}", "Time/Scheme": "Heun"},
    )
    for name, numbers in (
        ("at ends of steps", (20, 40, 80, 160)),
        ("inside of steps", (21, 41, 81, 161)),  # at the same places in them
    ):
        errors = []
        for n in numbers[: size(3, 4)]:
            result = scene("step_sizes_2d", **{**entries, "Time/Phases": f"5: {n}"})
            report.identities(result, 1e-10)
            errors.append(relative_error(result, fine) * n)
        report.figure(
            f"kinks {name}: error over k, largest over smallest",
            max(errors) / min(errors),
            largest=1.5,
        )


# ---------------------------------------------------------------- many steps


class Memory:
    """Samples the resident memory of the program that runs a scene, in MB."""

    def __init__(self, scene, seconds=0.005):
        self.scene = scene
        self.samples, self.seconds = [], seconds  # (bytes of statistics.csv, MB)
        self.stop = threading.Event()
        self.thread = threading.Thread(target=self.watch)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stop.set()
        self.thread.join()

    def watch(self):
        while not self.stop.wait(self.seconds):
            for process in runs_of(self.scene):
                statistics = process / "cwd" / "results" / "statistics.csv"
                try:
                    status = (process / "status").read_text()
                    size = statistics.stat().st_size
                except OSError:  # not begun, or ended
                    continue
                resident = status.partition("VmRSS:")[2].split()
                if resident:
                    self.samples.append((size, int(resident[0]) / 1024))

    def of_the_steps(self):
        """From a tenth of the steps to the last but one: without set-up and
        closing words."""
        last = max((size for size, _ in self.samples), default=0)
        return [mb for size, mb in self.samples if 0.1 * last <= size < last]


def runs_of(scene):
    """The directories in /proc of processes that run a scene, whoever has forked them."""
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if Path(os.readlink(process / "cwd")).name.startswith(scene + "_"):
                yield process
        except OSError:
            continue


@case(
    GROUP,
    "10^5 steps: equilibrium does not drift, the energy defect falls at least like "
    "k, memory is constant",
)
def many_steps(size, report):
    defects = []
    for n_periods, steps in (size(150, 250), 20), (size(150, 2500), 40):
        with Memory("many_steps_2d") as memory:
            result = scene(
                "many_steps_2d", **{"Time/Phases": f"{n_periods}: {n_periods * steps}"}
            )
        report.identities(result, 1e-10)
        report.figure("steps", len(result["t"]) - 1)
        balance = result["force_balance_defect"][1:]
        tenth = len(balance) // 10
        report.figure("balance of forces, largest", balance.max(), largest=1e-12)
        report.figure(
            "in the last tenth over that in the first",
            balance[-tenth:].max() / balance[:tenth].max(),
            largest=2,
        )
        share = result["energy_balance_defect"] / np.maximum(
            result["friction_dissipation"], 1e-300
        )
        defects.append(abs(share[-1]))
        report.figure("energy defect, of the friction dissipation", share[-1])
        report.figure(
            "at the end over that after a tenth of the run",
            share[-1] / share[tenth],
            0.9,
            1.1,
        )
        resident = memory.of_the_steps()
        report.figure("memory samples", len(resident), least=10)
        report.figure("resident memory, MB", max(resident))
        report.figure("its growth, MB", max(resident) - resident[0], largest=1)
    report.figure("order of the energy defect", np.log2(defects[0] / defects[1]), 1)
