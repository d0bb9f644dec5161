"""The ROS 2 graph: nodes, messages, quality of service, orchestration."""

import os

# Results are bit-identical only with one linear algebra thread, set before numpy loads.
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")
