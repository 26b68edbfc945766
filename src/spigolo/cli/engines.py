"""Choice of the engine for a verb."""

from __future__ import annotations

from typing import TYPE_CHECKING

from spigolo.errors import ConfigError

if TYPE_CHECKING:
    from spigolo.batch import Engine

LOCAL = "local"


def choose_cluster(scheduler: str, workers: int | None, flag: str) -> Engine:
    """Return the engine of a Dask cluster: a new one on this machine for "local", else the one at an address.

    flag: name of the flag for workers. Raises ConfigError if workers are given for a cluster at an address.
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
