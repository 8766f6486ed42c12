"""What the command line says of itself."""

from __future__ import annotations

import pytest

from abut.cli import main

COMMANDS = ("run", "sweep", "mesh", "check", "convert", "verify", "infsup", "fit", "schema")


@pytest.mark.parametrize("arguments", [[], ["--help"]], ids=["nothing", "help"])
def test_what_there_is(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Every command with a line, and examples; without arguments the same, as bad input."""
    with pytest.raises(SystemExit) as end:
        main(arguments)
    out = capsys.readouterr().out
    assert end.value.code == (0 if arguments else 2)
    for name in COMMANDS:
        assert f"\n    {name} " in out
    assert "\n  abut run punch.toml" in out


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_says_what_it_does(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main([name, "--help"])
    assert end.value.code == 0
    usage, description = capsys.readouterr().out.split("\n\n")[:2]
    assert usage.startswith(f"usage: abut {name}")
    assert not description.startswith(("positional arguments", "options"))
