"""The examples of the book's pages on this package."""

import re
from pathlib import Path

import pytest

BOOK = Path(__file__).parents[2] / "book"
PAGES = [BOOK / "guides" / "python.md", BOOK / "tutorials" / "python.md"]
EXAMPLES = [
    (f"{page.parent.name} {number}", code)
    for page in PAGES
    for number, code in enumerate(re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL), 1)
]


@pytest.mark.parametrize("code", [code for _, code in EXAMPLES], ids=[title for title, _ in EXAMPLES])
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_examples_run(code, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "book", "exec"), {})
    told = capsys.readouterr().out
    assert told


def test_there_is_an_example_of_each_function():
    text = "".join(code for _, code in EXAMPLES)
    assert all(f"alula.{name}(" in text for name in ["run", "flutter", "gaf", "solid", "cloud", "geometry"])
