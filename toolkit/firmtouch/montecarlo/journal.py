"""`runs.jsonl`: a first line with the question, then a line for each run, appended as it is done."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final, Self

from firmtouch.errors import InputError
from firmtouch.montecarlo.question import differences
from firmtouch.montecarlo.record import Label, Record, record_as_json, record_from_json

SCHEMA: Final = "firmtouch.montecarlo-runs/1"
NAME: Final = "runs.jsonl"
MOST_DIFFERENCES: Final = 4


class OtherQuestionError(InputError):
    """The folder holds runs of another question."""


def read_runs(folder: Path, question: Mapping[str, Any]) -> dict[Label, Record]:
    """Read the runs that a folder holds; a last line that was cut off is dropped. No file is no run.

    Raises
    ------
    OtherQuestionError
        If they are runs of another question.
    InputError
        If the file cannot be read, or is none of ours.
    """
    path = folder / NAME
    try:
        lines = _whole(path.read_bytes()).splitlines() if path.exists() else []
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    if not lines:
        return {}
    _expect_same(path, lines[0], question)
    found: dict[Label, Record] = {}
    for i, line in enumerate(lines[1:], start=2):
        try:
            record = record_from_json(json.loads(line))
        except (ValueError, KeyError, TypeError, AttributeError, InputError) as error:
            raise InputError(f"{path}:{i}: no run; `--fresh` begins anew") from error
        found[record.label] = record
    return found


class Journal:
    """The file, open for appending: `with Journal(...) as journal`."""

    def __init__(self, folder: Path, question: Mapping[str, Any], *, fresh: bool) -> None:
        """Begin a file, or go on with one that `read_runs` has read."""
        path = folder / NAME
        try:
            folder.mkdir(parents=True, exist_ok=True)
            kept = b"" if fresh or not path.exists() else _whole(path.read_bytes())
            self._file = path.open("r+b" if kept else "wb")
            self._file.truncate(len(kept))
            self._file.seek(len(kept))
            if not kept:
                self._write([{"schema": SCHEMA, "question": question}])
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error

    def append(self, records: Iterable[Record]) -> None:
        """Write lines down at once."""
        self._write(record_as_json(each) for each in records)

    def _write(self, lines: Iterable[Mapping[str, Any]]) -> None:
        self._file.write("".join(json.dumps(each, allow_nan=False) + "\n" for each in lines).encode())
        self._file.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()


def _whole(content: bytes) -> bytes:
    """Drop what follows the last end of a line."""
    return content[: content.rfind(b"\n") + 1]


def _expect_same(path: Path, line: bytes, question: Mapping[str, Any]) -> None:
    try:
        head = json.loads(line)
        there = head["question"] if head["schema"] == SCHEMA else None
    except (ValueError, KeyError, TypeError):
        there = None
    if not isinstance(there, Mapping):
        raise InputError(f"{path}: these are no runs of firmtouch; `--fresh` writes over them, `--out` goes elsewhere")
    found = list(differences(there, json.loads(json.dumps(question))))
    if found:
        more = f", and {len(found) - MOST_DIFFERENCES} more" if len(found) > MOST_DIFFERENCES else ""
        raise OtherQuestionError(
            f"{path} holds runs of another question: {', '.join(found[:MOST_DIFFERENCES])}{more} differ; "
            "`--fresh` throws them away, `--out DIR` keeps both"
        )
