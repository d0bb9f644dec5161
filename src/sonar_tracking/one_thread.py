"""One thread for linear algebra: results are bit-identical only then, and small matrices gain none.

The environment has to say so before numpy loads; a node started by hand leaves it to its user
(:mod:`sonar_tracking.graph`).
"""

ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Environment variables of the libraries numpy may use."""
