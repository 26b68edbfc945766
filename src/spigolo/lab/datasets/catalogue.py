"""List of published data sets that `spigolo.lab.datasets` can read, with URL, licence and size."""

from __future__ import annotations

from dataclasses import dataclass

from spigolo.errors import ConfigError

NOT_STATED = "not stated"
BOP_HOME = "https://bop.felk.cvut.cz/media/data/bop_datasets"


@dataclass(frozen=True, slots=True)
class Archive:
    """Zip file of a data set."""

    url: str
    sha256: str
    """SHA-256 hash of the zip file."""
    into: str
    """Subfolder to extract the zip file into, empty for the download folder itself."""

    @property
    def file_name(self) -> str:
        """Return the name of the zip file, which is the last part of its URL."""
        return self.url.rpartition("/")[2]


@dataclass(frozen=True, slots=True)
class KnownSet:
    """Published data set."""

    name: str
    title: str
    licence: str
    size: str
    home: str
    """URL of the data set's web page, or name of its publisher."""
    archives: tuple[Archive, ...] = ()
    """Zip files to download, with their hashes. The tuple is empty if the hashes of the files are unknown."""


KNOWN_SETS = (
    KnownSet(
        "rutgers-apc",
        "Rutgers APC RGB-D (Rennie et al. 2016), original files",
        NOT_STATED,
        "10,368 frames",
        "www.pracsyslab.org/rutgers_apc_rgbd_dataset",
    ),
    KnownSet(
        "ruapc",
        "Rutgers APC as BOP: 14 objects, 14 scenes",
        NOT_STATED,
        "5,964 frames",
        BOP_HOME,
        (
            Archive(
                f"{BOP_HOME}/ruapc_base.zip", "245cabf78a52f24eef7ce4c187015dfecf753c1d85b556a2591e97175a08e247", ""
            ),
            Archive(
                f"{BOP_HOME}/ruapc_models.zip",
                "00e713c5782dd8d3d92e8df5744aa5d30595c2cac8f88fdfbabd8d193c9603eb",
                "ruapc",
            ),
            Archive(
                f"{BOP_HOME}/ruapc_test_all.zip",
                "d2b9c4528ba8e89ffffcf1f298101855b4aad48c6e12e04c06675a449a6981e7",
                "ruapc",
            ),
        ),
    ),
    KnownSet(
        "uw-scenes-v1",
        "UW RGB-D Scenes v1 (Lai et al. 2011): 8 videos of table-tops",
        NOT_STATED,
        "1,434 frames",
        "rgbd-dataset.cs.washington.edu/dataset/rgbd-scenes",
    ),
    KnownSet(
        "quickfind",
        "hand-traced masks of UW RGB-D Scenes v1 (Zhong et al. 2016)",
        "CC BY 4.0",
        "1,434 masks",
        "hzhongresearch.github.io",
    ),
    KnownSet(
        "uw-scenes-v2",
        "UW RGB-D Scenes v2: 14 videos of rooms",
        NOT_STATED,
        "11,427 frames",
        "rgbd-dataset.cs.washington.edu/dataset/rgbd-scenes-v2",
    ),
    KnownSet(
        "tejani",
        "several instances of one object (Tejani et al. 2014), original files",
        NOT_STATED,
        "6 scenes",
        "Imperial College London, ICVL",
    ),
    KnownSet("icmi", "Tejani et al. as BOP: 6 objects, 6 scenes", NOT_STATED, "about 2,067 frames", BOP_HOME),
    KnownSet(
        "osd",
        "Object Segmentation Database (Richtsfeld et al. 2012)",
        NOT_STATED,
        "111 frames",
        "acin.tuwien.ac.at",
    ),
    KnownSet(
        "mosd",
        "OSD with corrected labels near edges (Alexandrov), as point clouds",
        "as for OSD",
        "111 frames",
        "github.com/PointCloudLibrary/data, segmentation/mOSD",
    ),
    KnownSet(
        "ocid",
        "Object Clutter Indoor Dataset: ARID20, ARID10, YCB10",
        NOT_STATED,
        "2,390 frames",
        "TU Wien, ACIN",
    ),
)


def known_set(name: str) -> KnownSet:
    """Return the published data set with the name `name`. Raises ConfigError for an unknown name."""
    found = next((known for known in KNOWN_SETS if known.name == name.lower().replace("_", "-")), None)
    if found is None:
        raise ConfigError(f"expected one of {', '.join(known.name for known in KNOWN_SETS)}, got {name!r}")
    return found
