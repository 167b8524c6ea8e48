# SPDX-License-Identifier: Apache-2.0
"""The folder of a campaign: one run at a time, and every result whole or not there."""

import fcntl
import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pyharness.campaign import Campaign, Drive
from pyharness.child_drives import DriveResult
from pyharness.drive_table import (
    CAMPAIGN_FILE,
    DRIVES_FOLDER,
    RESULTS_FOLDER,
    RUN_FILE,
    result_path,
    result_text,
)
from pyharness.errors import OutputError
from sim.config import dump_model, load_model
from sim.terrain_io import write_atomic

LOCK_FILE = ".lock"
PARTIAL = ".partial"


@contextmanager
def opened_folder(folder: Path, campaign: Campaign) -> Iterator[None]:
    """Hold a campaign's folder, made if it is not there.

    Raises:
        OutputError: It cannot be made, belongs to something else, or another run holds it.
    """
    try:
        if not folder.exists():
            folder.mkdir(parents=True)
        elif not (folder / CAMPAIGN_FILE).exists() and _others(folder):
            raise OutputError(f"{folder}: exists and is not the folder of a campaign")
        with (folder / LOCK_FILE).open("a") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise OutputError(f"{folder}: another run is at work there") from None
            _prepare(folder, campaign)
            yield
    except OSError as error:
        raise OutputError(f"{error.filename or folder}: {error.strerror or error}") from error


def _others(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if path.name != LOCK_FILE]


def _prepare(folder: Path, campaign: Campaign) -> None:
    """Check that the folder is of this campaign; remove what a killed run left half done."""
    path = folder / CAMPAIGN_FILE
    if path.exists():
        _check_same(load_model(path, Campaign), campaign, path)
    for name in (RESULTS_FOLDER, DRIVES_FOLDER):
        (folder / name).mkdir(exist_ok=True)
    for torn in [
        *folder.glob(".*.*"),
        *(folder / RESULTS_FOLDER).glob(".*"),
        *(folder / DRIVES_FOLDER).glob(f"*{PARTIAL}"),
    ]:
        shutil.rmtree(torn) if torn.is_dir() else torn.unlink()
    write_atomic(path, dump_model(campaign).encode())


def _check_same(before: Campaign, campaign: Campaign, path: Path) -> None:
    """Refuse a campaign with other drives; it may be held against other requirements."""
    old, new = before.model_dump(), campaign.model_dump()
    different = [key for key in new if new[key] != old[key] and key != "requirements"]
    if different:
        raise OutputError(
            f"{path}: a campaign with another {', '.join(different)},"
            " expected the same one or an empty folder"
        )


def land(folder: Path, drive: Drive, place: dict[str, Any], mode: str, result: DriveResult) -> None:
    """Put a finished drive into the folder; its result comes last."""
    kept = folder / DRIVES_FOLDER / drive.name
    if kept.exists():  # of a run that was killed just here
        shutil.rmtree(kept)
    if result.files:
        partial = kept.with_name(f"{kept.name}{PARTIAL}")
        partial.mkdir()
        for name, content in result.files.items():
            (partial / name).write_bytes(content)
        partial.rename(kept)
    write_atomic(result_path(folder, drive), result_text(place, mode, result).encode())


def write_run(folder: Path, run: dict[str, Any]) -> None:
    """Write how the campaign was run."""
    write_atomic(folder / RUN_FILE, (json.dumps(run, indent=2) + "\n").encode())


def read_run(folder: Path) -> dict[str, Any]:
    """Return how the campaign was run so far."""
    path = folder / RUN_FILE
    if not path.exists():
        return {}
    try:
        run: dict[str, Any] = json.loads(path.read_text("utf-8"))
    except ValueError:
        raise OutputError(f"{path}: not JSON text (removed, the campaign goes on)") from None
    return run
