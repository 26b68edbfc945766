"""The choice of the engine that does the work of a verb."""

from __future__ import annotations

from typing import TYPE_CHECKING

from spigolo.errors import ConfigError

if TYPE_CHECKING:
    from spigolo.batch import Engine

LOCAL = "local"


def choose_cluster(scheduler: str, workers: int | None, flag: str) -> Engine:
    """Return the engine of a Dask cluster: a new one on this machine for "local", else one at an address.

    flag: that of the workers. Raises ConfigError for workers of a cluster that has its own.
    """
    from spigolo.batch import dask_cluster, dask_local
    from spigolo.batch.engine import cores

    if scheduler == LOCAL:
        return dask_local(cores() if workers is None else workers)
    if workers is not None:
        raise ConfigError(
            f"expected {flag} or the address of a scheduler, got both: a cluster has workers of its own;"
            f" --scheduler {LOCAL} starts one with {flag} workers"
        )
    return dask_cluster(scheduler)
