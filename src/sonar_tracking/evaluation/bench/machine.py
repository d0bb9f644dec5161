"""The machine that figures were measured on, and what it can do at most.

The two limits are measured at the start of every bench, with one thread as everything else: the
product of two matrices of double precision (dgemm) for what is bound by arithmetic, the copy of an
array too large for the caches for what is bound by memory.
"""

from __future__ import annotations

import os
import platform
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from pathlib import Path

import numpy as np

import sonar_tracking
from sonar_tracking.evaluation.bench.timing import cpu_seconds

MATRIX_SIZE = 512
COPIED_NUMBERS = 4_000_000
"""32 MB there and 32 MB back."""

PATIENCE = 1.0
"""For each of the limits, s."""


@dataclass(frozen=True)
class Machine:
    """A machine and its limits.

    Attributes
    ----------
    date : str
        When, ISO 8601, UTC.
    version : str
        Of this package.
    cpu : str
        Model of the processor.
    cores : int
        That this process may use.
    load : float
        Processes that wanted to run, mean of the minute before.
    system, python, numpy, blas : str
        Versions.
    dgemm_gflops : float
        Limit of arithmetic, 1e9 additions and multiplications of real numbers a second.
    copy_gb_s : float
        Limit of memory, 1e9 bytes read or written a second.
    """

    date: str
    version: str
    cpu: str
    cores: int
    load: float
    system: str
    python: str
    numpy: str
    blas: str
    dgemm_gflops: float
    copy_gb_s: float

    def in_words(self) -> str:
        """Return one sentence for people."""
        return (
            f"{self.cpu}, {self.cores} cores, load {self.load:.1f} before; Python {self.python}, "
            f"numpy {self.numpy}, {self.blas}; dgemm {self.dgemm_gflops:.1f} Gflop/s, copy "
            f"{self.copy_gb_s:.1f} GB/s, one thread; sonar_tracking {self.version}, {self.date}"
        )

    def as_mapping(self) -> dict[str, object]:
        """Return the fields by their names."""
        return asdict(self)


def measured_machine() -> Machine:
    """Describe this machine and measure its limits; takes about a second."""
    return Machine(
        date=datetime.now(timezone.utc).isoformat(timespec="seconds"),
        version=sonar_tracking.__version__,
        cpu=_cpu(),
        cores=len(os.sched_getaffinity(0)),
        load=round(os.getloadavg()[0], 2),
        system=platform.platform(),
        python=platform.python_version(),
        numpy=np.__version__,
        blas=_blas(),
        dgemm_gflops=round(_dgemm(), 2),
        copy_gb_s=round(_copy(), 2),
    )


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.machine()


def _blas() -> str:
    found = np.show_config(mode="dicts")["Build Dependencies"]["blas"]
    return f"{found['name']} {found['version']}"


def _dgemm() -> float:
    first, second = np.random.default_rng(0).standard_normal((2, MATRIX_SIZE, MATRIX_SIZE))
    seconds = cpu_seconds(lambda: first @ second, PATIENCE)
    return float(2e-9 * MATRIX_SIZE**3 / seconds)


def _copy() -> float:
    source = np.ones(COPIED_NUMBERS)
    target = np.empty_like(source)
    return 2e-9 * source.nbytes / cpu_seconds(lambda: np.copyto(target, source), PATIENCE)
