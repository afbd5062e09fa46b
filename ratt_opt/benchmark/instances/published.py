"""The place of a library: a folder, or a published archive that is fetched once by name."""

from __future__ import annotations

from pathlib import Path

from ratt_opt.benchmark.instances.library import INDEX
from ratt_opt.errors import InputError

__all__ = ["PUBLISHED", "library_folder"]

PUBLISHED: dict[str, tuple[str, str]] = {}
"""Name -> (address of an archive, its hash as ``sha256:...``). Empty until there is a public address."""


def library_folder(library: str | Path) -> Path:
    """The folder of a library, given as such or by the name of a published one, which is fetched and kept.

    Raises
    ------
    InputError : it is neither, fetching needs the extra ``benchmark``, nobody answers, or the archive is another one.
    """
    folder = Path(library)
    if (folder / INDEX).is_file():
        return folder
    if str(library) not in PUBLISHED:
        known = f", or {', '.join(PUBLISHED)}" if PUBLISHED else ""
        raise InputError("library", f"must be a folder that holds {INDEX}{known}", library)
    try:
        import pooch
    except ImportError:
        raise InputError("library", "needs pooch: install the extra 'benchmark'", "no module 'pooch'") from None
    address, digest = PUBLISHED[str(library)]
    try:
        files = pooch.retrieve(address, known_hash=digest, processor=pooch.Untar(), progressbar=False)
    except (OSError, ValueError) as error:  # nobody answers, or the archive has another hash
        raise InputError("library", f"must be fetched from {address}", str(error).splitlines()[0]) from None
    return next(Path(file).parent for file in files if Path(file).name == INDEX)
