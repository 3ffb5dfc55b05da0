#!/usr/bin/env python3
"""Time to an accuracy of 1 % of the elastic leapfrog that a stencil compiler (Devito) generates.

    python3 -m venv venv && venv/bin/pip install devito        # needs a C compiler
    OMP_NUM_THREADS=1 venv/bin/python benches/stencil_compiler.py [--check] [--rates] [--tune] [--costs M,M,...]

The scheme: velocities and stresses on staggered grids, leapfrog in time, central differences of order 2, 4, 8 (and 16)
in space (Virieux 1986, doi:10.1190/1.1442147; Levander 1988, doi:10.1190/1.1442422), in plane strain, for the classical
solid and for the Cosserat solid (microrotation and force stresses 12, 21 at the same place). It corresponds to
`cargo bench -p wellposed-dynamics --bench wave_cost`, with the same media, waves, directions and definitions.

- `--check`: compares the compiled scheme with the matrix by which a step multiplies a plane wave, cell by cell, in three
  directions.
- `--rates`: million cell-steps per second on 1000² cells, one thread, double and single precision, fastest of sixty
  interleaved rounds by the timers of the kernel itself; a cell-step advances all fields of one cell by a whole time step.
  Where other programs run, repeat until the numbers do not rise.
- `--tune`: the same for several options of the compiler, orders 2, 4 and 8.
- `--costs`: given the rates of the classical solid at orders 2, 4, 8, 16 and then of the Cosserat solid, the least time
  for a square of one wavelength and one period at which the error of the velocity after twenty wavelengths is at most 1 %
  (and 5 %) in each of twelve directions, over cells per wavelength (in steps of ½) and stable Courant numbers.

Without options: all but `--tune`, with the rates just measured.
"""

import argparse
import itertools
import math
import platform
import subprocess

import numpy as np

ORDERS = (2, 4, 8, 16)
WAVELENGTHS = 20
DIRECTIONS = [(1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, 2), (2, -1), (3, 1), (1, 3), (3, 2), (-2, 3), (4, 3)]

# Wave speeds √3 and 1. Cosserat: internal lengths of a tenth of the wavelength, which is 1.
LAMBDA = MU = DENSITY = ALPHA = 1.0
INERTIA, BENDING = 0.01, 0.02
MAX_SPEED = math.sqrt(3.0)

# Where a field lives, in half cells.
PLACES = {
    "v1": (1, 0), "v2": (0, 1), "s11": (0, 0), "s22": (0, 0), "s12": (1, 1), "s21": (1, 1),
    "w": (1, 1), "m13": (0, 1), "m23": (1, 0),
}  # fmt: skip


def equations(theory):
    """Rates of velocities, then of stresses: {field: [(coefficient, axis or None, field), ...]}; the moduli are those of
    a wavelength of 1, axis None is the field itself."""
    stretch = LAMBDA + 2 * MU
    normal = {
        "s11": [(stretch, 0, "v1"), (LAMBDA, 1, "v2")],
        "s22": [(LAMBDA, 0, "v1"), (stretch, 1, "v2")],
    }
    if theory == "classical":
        velocities = {
            "v1": [(1 / DENSITY, 0, "s11"), (1 / DENSITY, 1, "s12")],
            "v2": [(1 / DENSITY, 0, "s12"), (1 / DENSITY, 1, "s22")],
        }
        return velocities, normal | {"s12": [(MU, 0, "v2"), (MU, 1, "v1")]}
    velocities = {
        "v1": [(1 / DENSITY, 0, "s11"), (1 / DENSITY, 1, "s21")],
        "v2": [(1 / DENSITY, 0, "s12"), (1 / DENSITY, 1, "s22")],
        "w": [(1 / INERTIA, axis, m) for axis, m in [(0, "m13"), (1, "m23"), (None, "s12")]]
        + [(-1 / INERTIA, None, "s21")],
    }
    plus, minus = MU + ALPHA, MU - ALPHA
    shear = {
        "s12": [(plus, 0, "v2"), (minus, 1, "v1"), (minus - plus, None, "w")],
        "s21": [(minus, 0, "v2"), (plus, 1, "v1"), (plus - minus, None, "w")],
    }
    shear = {field: [term for term in terms if term[0] != 0] for field, terms in shear.items()}
    return velocities, normal | shear | {"m13": [(BENDING, 0, "w")], "m23": [(BENDING, 1, "w")]}


def weights(order):
    """Weights of f(x + (m − ½)h) − f(x − (m − ½)h), m = 1 … order/2, in the staggered difference."""
    distances = np.arange(1, order // 2 + 1) - 0.5
    powers = np.arange(len(distances))
    matrix = 2 * distances[None, :] ** (2 * powers[:, None] + 1)
    return np.linalg.solve(matrix, (powers == 0).astype(float))


def max_courant(order):
    """Largest stable Courant number in the plane."""
    return 1 / (math.sqrt(2) * np.abs(weights(order)).sum())


def symbol(theory, differences):
    """Blocks of the rates of velocities by stresses and of stresses by velocities; `differences`: of shape (…, 2), the
    factor of a difference along each axis."""
    velocities, stresses = equations(theory)
    blocks = []
    for targets, sources in [(velocities, stresses), (stresses, velocities)]:
        block = np.zeros((*differences.shape[:-1], len(targets), len(sources)), complex)
        names = list(sources)
        for row, terms in enumerate(targets.values()):
            for coefficient, axis, name in terms:
                block[..., row, names.index(name)] += coefficient * (1 if axis is None else differences[..., axis])
        blocks.append(block)
    return blocks


def exact_wave(theory, is_shear, wave_vectors):
    """Velocities and stresses of waves of wavelength 1, with a velocity amplitude of 1, and their angular frequency
    (they turn by exp(−iωt)): of the slowest wave for S, of the wave along its vector for P."""
    by_stress, by_velocity = symbol(theory, 1j * wave_vectors)
    squares, vectors = np.linalg.eig(by_stress @ by_velocity)
    frequencies = np.sqrt(np.abs(squares.real))
    if is_shear:
        choice = frequencies.argmin(axis=-1)
    else:
        along = np.einsum("di,dij->dj", wave_vectors, vectors[:, :2])
        choice = np.abs(along).argmax(axis=-1)
    pick = np.arange(len(wave_vectors))
    velocity, frequency = vectors[pick, :, choice], frequencies[pick, choice]
    velocity = velocity / np.linalg.norm(velocity[:, :2], axis=1)[:, None]
    stress = np.einsum("dij,dj->di", by_velocity, velocity) / (-1j * frequency[:, None])
    return velocity, stress, frequency


def step_matrix(theory, order, cells, courant, wave_vectors):
    """Matrix by which a time step multiplies (velocities, stresses half a step later) of plane waves of wavelength 1."""
    differences = np.zeros(wave_vectors.shape, complex)
    for place, weight in enumerate(weights(order)):
        differences += 2j * cells * weight * np.sin((place + 0.5) * wave_vectors / cells)
    step = courant / cells / MAX_SPEED
    by_stress, by_velocity = (step * block for block in symbol(theory, differences))
    count = by_stress.shape[-2]
    total = count + by_velocity.shape[-2]
    first, second = np.broadcast_to(np.eye(total, dtype=complex), (2, len(wave_vectors), total, total)).copy()
    first[:, :count, count:] = by_stress
    second[:, count:, :count] = by_velocity
    return second @ first


def unit_vectors():
    return np.array([np.array(d) / math.hypot(*d) for d in DIRECTIONS])


def wave_error(theory, is_shear, order, cells, courant):
    """Error of the velocity after twenty wavelengths, relative to its amplitude, the largest of twelve directions."""
    wave_vectors = 2 * math.pi * unit_vectors()
    velocity, stress, frequency = exact_wave(theory, is_shear, wave_vectors)
    time = WAVELENGTHS * 2 * math.pi / frequency[0]
    steps = math.ceil(time * MAX_SPEED * cells / courant)
    step = time / steps
    matrix = step_matrix(theory, order, cells, step * MAX_SPEED * cells, wave_vectors)
    later = stress * np.exp(-0.5j * step * frequency)[:, None]
    start = np.concatenate([velocity, later], axis=1)[..., None]
    found = (np.linalg.matrix_power(matrix, steps) @ start)[:, :2, 0]
    # Twenty periods: the exact wave is where it was.
    return np.linalg.norm(found - velocity[:, :2], axis=1).max()


def least_cost(theory, is_shear, order, tolerance):
    """Cells per wavelength, Courant number and error of the least number of cell-steps for one wavelength² and period."""
    frequency = exact_wave(theory, is_shear, 2 * math.pi * unit_vectors())[2][0]
    best = (math.inf, None, None, None)
    courants = max_courant(order) * np.geomspace(0.999, 0.03, 120)
    for cells in np.arange(3.0, 140.0, 0.5):
        for courant in courants:
            cost = cells**3 / courant * MAX_SPEED * 2 * math.pi / frequency
            if cost >= best[0]:
                break
            error = wave_error(theory, is_shear, order, cells, courant)
            if error <= tolerance:
                best = (cost, cells, courant, error)
                break
    return best


class Compiled:
    """The scheme as Devito compiles it; each field is overwritten in place, which halves the memory that moves, or has a
    second copy for the new time, as is usual (`copies=2`)."""

    def __init__(self, theory, order, points, cells, dtype, opt="advanced", options=None, copies=1):
        import devito

        devito.configuration["log-level"] = "ERROR"
        spacing = 1.0 / cells
        grid = devito.Grid(shape=(points, points), extent=(spacing * (points - 1),) * 2, dtype=dtype)
        dimensions = grid.dimensions
        velocities, stresses = equations(theory)

        def create(name):
            shifted = tuple(d for d, half in zip(dimensions, PLACES[name]) if half)
            return devito.TimeFunction(
                name=name,
                grid=grid,
                space_order=order,
                time_order=1,
                save=devito.Buffer(copies),
                staggered=shifted or devito.NODE,
            )

        self.fields = {name: create(name) for name in [*velocities, *stresses]}
        step = grid.time_dim.spacing

        def equation(name, terms, is_stress):
            rate = 0
            for coefficient, axis, other in terms:
                source = self.fields[other].forward if is_stress else self.fields[other]
                rate += coefficient * (source if axis is None else source.diff(dimensions[axis]))
            return devito.Eq(self.fields[name].forward, self.fields[name] + step * rate)

        parts = [equation(name, terms, False) for name, terms in velocities.items()]
        parts += [equation(name, terms, True) for name, terms in stresses.items()]
        self.operator = devito.Operator(parts, opt=(opt, options or {}))
        self.spacing = spacing

    def advance(self, steps, courant):
        """Advances the fields by `steps` and returns the seconds that the kernel took by its own timers."""
        step = courant * self.spacing / MAX_SPEED
        summary = self.operator.apply(time_m=0, time_M=steps - 1, dt=step)
        return sum(entry.time for entry in summary.values())


def check(theory, order, cells=10.0, courant=0.4, points=400, steps=10):
    """Largest difference of the compiled scheme from the matrix of the step, relative to the largest value of the field,
    and the relative difference of the phase by which v1, v2 turn in all steps; in the cells that no side can reach."""
    largest, phase = 0.0, 0.0
    solver = Compiled(theory, order, points, cells, np.float64)
    centre = slice(steps * order + 10, points - steps * order - 10)
    for direction, is_shear in itertools.product([0, 4, 10], [False, True]):
        wave_vector = 2 * math.pi * unit_vectors()[direction : direction + 1]
        velocity, stress, _ = exact_wave(theory, is_shear, wave_vector)
        start = np.concatenate([velocity, stress], axis=1)[0]
        matrix = step_matrix(theory, order, cells, courant, wave_vector)[0]
        end = np.linalg.matrix_power(matrix, steps) @ start
        index = np.arange(points)

        def wave(name, amplitude):
            places = [(index + 0.5 * half) / cells for half in PLACES[name]]
            angle = wave_vector[0, 0] * places[0][:, None] + wave_vector[0, 1] * places[1][None, :]
            return amplitude * np.exp(1j * angle)

        for name, amplitude in zip(solver.fields, start):
            solver.fields[name].data_with_halo[:] = 0
            solver.fields[name].data[0] = wave(name, amplitude).real
        solver.advance(steps, courant)
        for place, (name, amplitude) in enumerate(zip(solver.fields, end)):
            found = solver.fields[name].data[-1][centre, centre]
            expected = wave(name, amplitude)[centre, centre]
            scale = max(np.abs(expected).max(), 1e-3)
            largest = max(largest, np.abs(found - expected.real).max() / scale)
            if name in ("v1", "v2") and np.abs(amplitude) > 1e-3:
                # Complex amplitude of the compiled wave, by least squares.
                shape = wave(name, 1.0)[centre, centre]
                columns = np.stack([shape.real.ravel(), -shape.imag.ravel()], axis=1)
                real, imaginary = np.linalg.lstsq(columns, np.asarray(found).ravel(), rcond=None)[0]
                turn, expected_turn = (np.angle(a / start[place]) for a in (real + 1j * imaginary, amplitude))
                phase = max(phase, abs(turn / expected_turn - 1))
    return largest, phase


def measure_rates(solvers, rounds=60, steps=4):
    """Rates of several compiled schemes in interleaved rounds, million cell-steps per second."""
    noise = np.random.default_rng(1)
    best = [math.inf] * len(solvers)
    for solver in solvers:
        for field in solver.fields.values():
            field.data[:] = noise.uniform(-1, 1, field.data.shape)
        solver.advance(steps, 0.3)
    for _ in range(rounds):
        for place, solver in enumerate(solvers):
            best[place] = min(best[place], solver.advance(steps, 0.3) / steps)
    points = next(iter(solvers[0].fields.values())).data.shape[1:]
    return [math.prod(points) / seconds / 1e6 for seconds in best]


BLOCKS = {"blockinner": True, "blockrelax": True}

# Copies of each field, mode and options of the compiler.
TUNING = {
    "two copies": (2, "advanced", {}),
    "in place": (1, "advanced", {}),
    "in place, blocks 16 x 512": (1, "advanced", BLOCKS | {"par-tile": (16, 512)}),
    "in place, blocks 64 x 256": (1, "advanced", BLOCKS | {"par-tile": (64, 256)}),
    "in place, skewed blocks": (1, "advanced", BLOCKS | {"par-tile": (32, 512), "skewing": True}),
    "in place, advanced-fsg": (1, "advanced-fsg", {}),
    "in place, OpenMP": (1, "advanced", {"openmp": True}),
    "in place, noop": (1, "noop", {}),
}


def print_tuning():
    for theory, order in itertools.product(("classical", "cosserat"), ORDERS[:3]):
        solvers = [
            Compiled(theory, order, 1000, 10.0, np.float64, opt, options, copies)
            for copies, opt, options in TUNING.values()
        ]
        for name, rate in zip(TUNING, measure_rates(solvers)):
            print(f"{theory}, order {order}, {name}: {rate:.0f} M cell-steps/s", flush=True)


def print_costs(rates):
    print("| theory | order | rate, M/s | wave | error ≤ | cells | Courant number | error | ms |")
    print("|---|---|---|---|---|---|---|---|---|")
    for (theory, order), rate in rates.items():
        for wave, tolerance in itertools.product("PS", (0.01, 0.05)):
            cost, cells, courant, error = least_cost(theory, wave == "S", order, tolerance)
            numbers = f"{tolerance} | {cells} | {courant:.3f} | {error:.4f} | {cost / rate / 1e3:.4f}"
            print(f"| {theory} | {order} | {rate:.0f} | {wave} | {numbers} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--rates", action="store_true")
    parser.add_argument("--tune", action="store_true")
    parser.add_argument("--costs")
    chosen = parser.parse_args()
    is_all = not (chosen.check or chosen.rates or chosen.tune or chosen.costs)
    schemes = list(itertools.product(("classical", "cosserat"), ORDERS))
    if not chosen.costs or is_all:
        import devito

        compiler = devito.configuration["compiler"]
        version = subprocess.run([compiler.cc, "--version"], capture_output=True, text=True).stdout.splitlines()[0]
        print(f"Devito {devito.__version__}, {version}, {' '.join(compiler.cflags)}; {platform.machine()}")
    if chosen.check or is_all:
        for theory, order in schemes:
            difference, phase = check(theory, order)
            print(f"{theory}, order {order}: largest difference {difference:.1e}, of the phase {phase:.1e}", flush=True)
            # The compiler writes the weights with nine digits.
            assert difference < 1e-6 and phase < 1e-7, "the compiled scheme differs from its symbol"
    if chosen.tune:
        print_tuning()
    rates = {}
    if chosen.costs:
        rates = dict(zip(schemes, map(float, chosen.costs.split(",")), strict=True))
    elif chosen.rates or is_all:
        for dtype in (np.float32, np.float64):
            found = measure_rates([Compiled(t, order, 1000, 10.0, dtype) for t, order in schemes])
            rates = dict(zip(schemes, found))
            for (theory, order), rate in rates.items():
                print(f"{theory}, order {order}, {dtype.__name__}: {rate:.0f} M cell-steps/s", flush=True)
    if chosen.costs or is_all:
        print_costs(rates)


if __name__ == "__main__":
    main()
