"""Sealed answers: the hash of each answer, salt included, is on disk before the diagnosis of its case starts.

This proves the order of events to whoever holds the earlier hash; it does not prove that answer and diagnosis were
written by different people.
"""

import hashlib
import json
import os
from pathlib import Path

from fricomp.errors import DiagnosisError


class SealBook:
    """Hashes of answers by case, one JSON line each, in the order in which they were sealed.

    Args:
        path: The file; it is made where there is none, and only ever appended to.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._digests: dict[str, str] = {}
        self._opened: set[str] = set()
        if path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                entry = json.loads(line)
                self._digests[entry["case"]] = entry["sha256"]

    def seal(self, case: str, answer: bytes) -> str:
        """Write the hash of an answer to disk and return it.

        A case that was stopped before it was opened and is made again on another processor can differ in last digits:
        it gets a second line, which counts from then on, and the first stays for everybody to see.

        Raises:
            DiagnosisError: The case was opened with another answer.
        """
        digest = hashlib.sha256(answer).hexdigest()
        known = self._digests.get(case)
        if known == digest:
            return digest
        if case in self._opened:
            raise DiagnosisError(f"{case} was opened with the seal {known}, not with {digest}: start a new folder")
        self._digests[case] = digest
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"case": case, "sha256": digest}) + "\n")
            file.flush()
            os.fsync(file.fileno())
        return digest

    def open(self, case: str, answer: bytes) -> None:
        """Check an answer against its seal.

        Raises:
            DiagnosisError: It is another one, or was never sealed.
        """
        if self._digests.get(case) != hashlib.sha256(answer).hexdigest():
            raise DiagnosisError(f"the answer of {case} does not match its seal: it cannot be scored")
        self._opened.add(case)
