"""Choice of the Dask cluster on which a command runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from spigolo.errors import ConfigError

if TYPE_CHECKING:
    from spigolo.batch import Engine

LOCAL = "local"


def choose_cluster(scheduler: str, workers: int | None, flag: str) -> Engine:
    """Return an engine that runs jobs on a Dask cluster.

    - scheduler: the address of a running cluster, or "local" for a new cluster on this machine.
    - workers: number of worker processes of a local cluster. If None, one process is started for each CPU core.
    - flag: name of the command-line flag for `workers`, printed in error messages.

    Raises ConfigError if `workers` is given together with an address.
    """
    from spigolo.batch import dask_cluster, dask_local
    from spigolo.batch.engine import cores

    if scheduler == LOCAL:
        return dask_local(cores() if workers is None else workers)
    if workers is not None:
        raise ConfigError(
            f"expected either {flag} or the address of a scheduler, got both: leave out {flag}, because a cluster has"
            f" its own workers. Only --scheduler {LOCAL} starts a new cluster with {flag} workers"
        )
    return dask_cluster(scheduler)
