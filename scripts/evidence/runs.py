"""Runs of the program, kept in a work folder so that none is done twice.

A run is known by the program's bytes, the input's bytes and the options: change any of them, and it is
done again.
"""

import hashlib
import json
import os
import pathlib
import subprocess
import sys
from dataclasses import dataclass

# The program's exit code for an input or an option that it refuses; all others are faults.
REFUSED = 2


def say(text):
    """Progress, on standard error."""
    print(text, file=sys.stderr, flush=True)


def hash_of(path):
    """SHA-256 of a file."""
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def write_whole(path, data):
    """Writes bytes so that the file is there whole or not at all."""
    new = path.with_name(path.name + ".new")
    new.write_bytes(data)
    os.replace(new, path)


@dataclass
class Bake:
    """What came of a bake: a file and its report, or why there is none."""

    path: pathlib.Path
    report: dict | None
    file_hash: str | None
    refused: str | None  # the program's words
    failed: str | None  # the same, where it did not refuse but broke


class Runs:
    """The program and the folder of what it made."""

    def __init__(self, program, work):
        self.program, self.work = program, work
        self.program_hash = hash_of(program)
        self.hashes = {}
        for name in ("bakes", "measures", "inputs"):
            (work / name).mkdir(parents=True, exist_ok=True)

    def input_hash(self, path):
        if path not in self.hashes:
            self.hashes[path] = hash_of(path)
        return self.hashes[path]

    def key(self, path, options):
        # A file of lines goes by its bytes, wherever it is.
        options = [self.input_hash(text) if isinstance(text, pathlib.Path) else text for text in options]
        text = json.dumps([self.program_hash, self.input_hash(path), options])
        return hashlib.sha256(text.encode()).hexdigest()[:32]

    def call(self, *arguments):
        return subprocess.run([self.program, *arguments], capture_output=True, text=True, errors="replace")

    def lines(self, path):
        """The feature lines that are found on a mesh: a file of them."""
        made = self.work / "inputs" / f"{self.key(path, ['edges'])}.obj"
        if not made.exists():
            new = made.with_suffix(".new.obj")
            done = self.call("edges", path, "-o", new, "--quiet")
            if done.returncode != 0:
                raise RuntimeError(f"{path.name}: {done.stderr.strip()}")
            os.replace(new, made)
        return made

    def bake(self, path, options):
        """Bakes an input; options are texts, or paths of files of lines."""
        key = self.key(path, ["bake", *options])
        made, kept = self.work / "bakes" / f"{key}.qsplat", self.work / "bakes" / f"{key}.json"
        if not kept.exists():
            say(f"  bake {path.name} {' '.join(str(option) for option in options)}")
            report = self.work / "bakes" / f"{key}.report.json"
            done = self.call("bake", path, *options, "-o", made, "--report", report, "--quiet")
            # The page is the same wherever the inputs lie.
            words = done.stderr.replace(f"{path.parent}/", "").strip() or f"exit code {done.returncode}"
            facts = {
                "report": json.loads(report.read_text()) if done.returncode == 0 else None,
                "file_hash": hash_of(made) if done.returncode == 0 else None,
                "refused": words if done.returncode == REFUSED else None,
                "failed": words if done.returncode not in (0, REFUSED) else None,
            }
            report.unlink(missing_ok=True)
            if facts["failed"]:
                return Bake(made, **facts)  # not kept: it may have been the machine's fault
            write_whole(kept, json.dumps(facts).encode())
        return Bake(made, **json.loads(kept.read_text()))

    def measure(self, bake, path, options):
        """Measures a bake against its input: the measures, or the program's words where it broke."""
        kept = self.work / "measures" / f"{self.key(path, ['measure', bake.file_hash, *options])}.json"
        if not kept.exists():
            say(f"  measure {path.name} {' '.join(str(option) for option in options)}")
            done = self.call("measure", bake.path, "--against", path, *options, "--json", "--quiet")
            if done.returncode != 0:
                return None, done.stderr.strip() or f"exit code {done.returncode}"
            write_whole(kept, done.stdout.encode())
        return json.loads(kept.read_text()), None
