"""What is run for each version: jobs of the examples, some in several load steps, the scikit-fem example, small models, the
benchmarks."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from same.versions import Version, VersionError, ran

CLI = "import sys; from abut.cli import main; sys.exit(main())"
STEPS = 3
IN_STEPS = ("two-blocks/job", "two-rings/job", "hertz-line/quad4")  # examples that are run in several load steps too
MODELS = Path(__file__).with_name("models.py")
GROUPS = ("contact", "friction", "rough", "ties", "round", "pressure-spaces", "laws", "multigrid")  # of MODELS
FAULTY = "faulty"  # jobs that are there to be refused
SCIKIT_FEM = "scikit-fem/contact"
# The example by itself, its numbers as JSON.
BY_SCIKIT_FEM = """
import json, sys
sys.path.insert(0, sys.argv[1])
import contact
own, alone = contact.solve(), contact.solve_with_abut()
names = ("displacement", "force", "active", "abut/displacement", "abut/force")
print(json.dumps(dict(zip(names, [a.tolist() for a in (*own, *alone)]))))
"""


@dataclass(frozen=True)
class Run:
    """An example (``what``: folder/file without suffix), a group of small models or a benchmark (its name)."""

    kind: str
    what: str
    steps: int = 1

    @property
    def name(self) -> str:
        """As --only and the table have it."""
        steps = f" in {self.steps} steps" if self.steps > 1 else ""
        return f"{self.kind} {self.what}{steps}"


def runs_of(version: Version) -> list[Run]:
    """Every run that a version knows of."""
    folder = version.tree / "examples"
    jobs = [path.relative_to(folder).with_suffix("") for path in sorted(folder.glob("*/*.toml"))]
    names = [job.as_posix() for job in jobs if job.parts[0] != FAULTY]
    examples = [Run("example", name) for name in names]
    examples += [Run("example", name, STEPS) for name in names if name in IN_STEPS]
    if (folder / f"{SCIKIT_FEM}.py").is_file():
        examples.append(Run("example", SCIKIT_FEM))
    examples += [Run("models", group) for group in GROUPS]
    listed = ran([str(version.python), "-c", CLI, "verify", "--list"], "abut verify --list", version.environment)
    return examples + [Run("benchmark", line.split()[0]) for line in listed.splitlines()]


def execute(run: Run, version: Version, folder: Path, tree: Path) -> None:
    """Run, and leave the numbers as files in ``folder`` (made); examples are those of ``tree``, so that two versions may run
    the same. Raises VersionError where it fails."""
    folder.mkdir(parents=True)
    if run.kind == "benchmark":
        text = _child(version, folder, CLI, "verify", run.what, "--json", statuses=(0, 1))  # 1: outside its tolerance
        (folder / "verify.json").write_text(json.dumps(benchmark_numbers(json.loads(text))))
    elif run.kind == "models":
        ran([str(version.python), str(MODELS), run.what, str(folder / "numbers.json")], run.name, version.environment)
    elif run.what == SCIKIT_FEM:
        text = _child(version, folder, BY_SCIKIT_FEM, str((tree / "examples" / SCIKIT_FEM).parent))
        (folder / "numbers.json").write_text(text)
    else:
        job = tree / "examples" / f"{run.what}.toml"
        if run.steps > 1:
            job = Path(shutil.copytree(job.parent, folder / "job")) / job.name
            with job.open("a", encoding="utf-8") as file:
                file.write(f"\n[solve]\nsteps = {run.steps}\n")
        _child(version, folder, CLI, "run", str(job), "--output", str(folder), "--quiet")


def benchmark_numbers(outcomes: list[dict]) -> dict[str, dict]:
    """Of each quantity its values by level ("error" where the reference is zero), the reference and its tolerance."""
    return {
        row["quantity"]: {
            "value" if row["reference"] else "error": row["values"],
            "reference": row["reference"],
            "tolerance": row["tolerance"],
        }
        for row in outcomes
    }


def _child(version: Version, folder: Path, code: str, *arguments: str, statuses: tuple[int, ...] = (0,)) -> str:
    command = [str(version.python), "-c", code, *arguments]
    child = subprocess.run(command, cwd=folder, env=version.environment, capture_output=True, text=True, check=False)
    if child.returncode not in statuses or (child.returncode and not child.stdout):
        said = (child.stderr or child.stdout).strip().splitlines()[-3:]
        raise VersionError("; ".join(said) or f"exit status {child.returncode}")
    return child.stdout
