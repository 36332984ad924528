"""The examples of the book's page on this package."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "book" / "guides" / "python.md"
EXAMPLES = re.findall(r"## ([^\n]*)\n\n```python\n(.*?)```", PAGE.read_text(), re.DOTALL)


@pytest.mark.parametrize("code", [code for _, code in EXAMPLES], ids=[title for title, _ in EXAMPLES])
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_examples_run(code, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    exec(compile(code, str(PAGE), "exec"), {})
    told = capsys.readouterr().out
    assert told


def test_there_is_an_example_of_each_function():
    text = "".join(code for _, code in EXAMPLES)
    assert all(f"alula.{name}(" in text for name in ["run", "flutter", "gaf", "solid", "cloud", "geometry"])
