#!/usr/bin/env python3
"""Turns the formulas of the book into MathML, which browsers draw by themselves: a preprocessor of mdBook.

    mdbook build book                       calls it, as book.toml says
    python3 book/formulas.py --check        only tells what it cannot read, page by page

Pages hold TeX as code, so that Markdown leaves every backslash alone: $`x_i`$ in a line, and a fence ```math for a line of its own.
It knows the part of TeX that the book uses. A command that it does not know is an error, with its page.
"""
import json
import pathlib
import re
import sys

GREEK = dict(zip(
    "alpha beta gamma delta epsilon varepsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi varphi chi psi omega "
    "Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega".split(), "αβγδϵεζηθκλμνξπρστϕφχψωΓΔΘΛΞΠΣΦΨΩ"))
OPERATORS = {"cdot": "⋅", "times": "×", "otimes": "⊗", "pm": "±", "to": "→", "leftarrow": "←", "approx": "≈", "le": "≤", "ge": "≥",
             "in": "∈", "ne": "≠", "sim": "∼", "dots": "…", "nabla": "∇"}
SYMBOLS = {"partial": "∂", "infty": "∞"}
FUNCTIONS = {"sin", "cos", "tan", "exp", "ln", "log", "det", "min", "max"}
SPACES = {",": 0.167, ";": 0.278, " ": 0.25, "quad": 1, "qquad": 2}
ACCENTS = {"bar": "¯", "hat": "^", "dot": "˙", "tilde": "~"}
FENCES = {"pmatrix": ("(", ")"), "bmatrix": ("[", "]"), "cases": ("{", None), "matrix": (None, None)}
BOX = "border: 1px solid; padding: 0.4em"
TOKEN = re.compile(r"\\[a-zA-Z]+|\\.|\d+(?:\.\d+)?|\s+|.", re.DOTALL)


def plain(text):
    """Characters that Markdown cannot take for its own."""
    return "".join(c if c.isascii() and c.isalnum() else f"&#{ord(c)};" for c in text)


def operator(text, attributes=""):
    return f"<mo{attributes}>{plain(text)}</mo>"


def space(width):
    return f'<mspace width="{width}em"/>'


class Formula:
    """One formula, read from left to right."""

    def __init__(self, tex):
        self.tokens = [t for t in TOKEN.findall(tex) if not t.isspace()]
        self.at = 0
        self.letters = ""

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else None

    def next(self):
        if self.at >= len(self.tokens):
            raise ValueError("ends too early")
        self.at += 1
        return self.tokens[self.at - 1]

    def expect(self, wanted):
        if (found := self.next()) != wanted:
            raise ValueError(f"has `{found}` where `{wanted}` belongs")

    def word(self):
        """The letters of a group, as they are."""
        self.expect("{")
        end = self.tokens.index("}", self.at)
        text, self.at = "".join(self.tokens[self.at:end]), end + 1
        return text

    def row(self, *ends):
        """Everything up to one of `ends`, which stays; None ends with the formula."""
        parts, unary = [], True
        while (token := self.peek()) not in ends:
            if token is None:
                raise ValueError(f"lacks `{ends[0]}`")
            parts.append(self.scripted(unary))
            unary = token in ("=", "(", "[", ",", "<", ">", "\\cdot", "\\{", "\\to", "\\quad", "\\qquad")
        return "<mrow>" + "".join(parts) + "</mrow>"

    def argument(self):
        token = self.peek() or ""
        if token[:1].isdigit():
            # of a number without braces the first digit
            self.tokens[self.at:self.at + 1] = list(token)
        if token != "{":
            return self.atom(True)
        self.next()
        inner = self.row("}")
        self.next()
        return inner

    def scripted(self, unary):
        """An atom with what hangs below and above it."""
        name = (self.peek() or "").lstrip("\\")
        base, scripts = self.atom(unary), {}
        while self.peek() in ("_", "^", "'"):
            kind = self.next()
            scripts["^" if kind == "'" else kind] = operator("′") if kind == "'" else self.argument()
        if scripts:
            # sums carry their limits above and below where there is room
            tag = {"_": "munder", "^": "mover", "_^": "munderover"} if name in ("sum", "min", "max") else \
                  {"_": "msub", "^": "msup", "_^": "msubsup"}
            tag = tag["".join(k for k in "_^" if k in scripts)]
            base = f"<{tag}>{base}{scripts.get('_', '')}{scripts.get('^', '')}</{tag}>"
        if name in FUNCTIONS and self.peek() not in ("(", "\\left", "\\{", None):
            base += space(SPACES[","])
        return base

    def atom(self, unary):
        token = self.next()
        if token[0] == "\\":
            return self.command(token[1:])
        if token == "{":
            self.at -= 1
            return self.argument()
        if token[0].isdigit():
            return f"<mn>{token}</mn>"
        if token.isalpha():
            return f"<mi{self.letters}>{token}</mi>"
        if token in "-+":
            return operator("−" if token == "-" else "+", ' form="prefix"' if unary else "")
        if token in "()[]":
            return operator(token, ' stretchy="false"')
        if token in "|/.":
            return operator(token, ' stretchy="false" lspace="0" rspace="0"')
        if token in "=<>,:;":
            return operator(token)
        if token == "°":
            return f"<mtext>{plain(token)}</mtext>"
        raise ValueError(f"has `{token}`, which is not known here")

    def command(self, name):
        if name in GREEK:
            letters = self.letters or (' mathvariant="normal"' if name[0].isupper() else "")
            return f"<mi{letters}>{plain(GREEK[name])}</mi>"
        if name in OPERATORS:
            return operator(OPERATORS[name])
        if name in SYMBOLS:
            return f'<mi mathvariant="normal">{plain(SYMBOLS[name])}</mi>'
        if name in SPACES:
            return space(SPACES[name])
        if name in FUNCTIONS:
            return f"<mi>{name}</mi>"
        if name in "{}":
            return operator(name, ' stretchy="false"')
        if name == "sum":
            return operator("∑")
        return self.structure(name)

    def structure(self, name):
        """Commands with arguments."""
        if name in ("frac", "tfrac"):
            above, below = self.argument(), self.argument()
            small = ' displaystyle="false"' if name == "tfrac" else ""
            return f"<mstyle{small}><mfrac>{above}{below}</mfrac></mstyle>" if small else f"<mfrac>{above}{below}</mfrac>"
        if name == "sqrt":
            return f"<msqrt>{self.argument()}</msqrt>"
        if name in ACCENTS:
            return f'<mover accent="true">{self.argument()}{operator(ACCENTS[name])}</mover>'
        if name in ("mathbf", "boldsymbol"):
            return self.bold(name == "mathbf")
        if name in ("mathrm", "operatorname"):
            return f'<mi mathvariant="normal">{plain(self.word())}</mi>'
        if name == "text":
            return f"<mtext>&#160;{plain(self.word())}&#160;</mtext>"
        if name == "boxed":
            return f'<mrow style="{BOX}">{self.argument()}</mrow>'
        if name == "left":
            return self.fenced()
        if name == "begin":
            return self.matrix(self.word())
        raise ValueError(f"has `\\{name}`, which is not known here")

    def bold(self, upright):
        before, self.letters = self.letters, ' style="font-weight: bold"' + (' mathvariant="normal"' if upright else "")
        inner, self.letters = self.argument(), before
        return inner

    def fence(self):
        token = self.next()
        return token[1] if token in ("\\{", "\\}") else token

    def fenced(self):
        opening = self.fence()
        inner = self.row("\\right")
        self.next()
        return "<mrow>" + operator(opening, ' form="prefix" stretchy="true"') + inner + \
            operator(self.fence(), ' form="postfix" stretchy="true"') + "</mrow>"

    def matrix(self, kind):
        if kind not in FENCES:
            raise ValueError(f"begins `{kind}`, which is not known here")
        rows, row = [], []
        while True:
            row.append(self.row("&", "\\\\", "\\end"))
            end = self.next()
            if end != "&":
                rows, row = rows + [row], []
            if end == "\\end":
                break
        if self.word() != kind:
            raise ValueError(f"does not end `{kind}`")
        aligned = ' style="text-align: left"' if kind == "cases" else ""
        cells = "".join("<mtr>" + "".join(f"<mtd{aligned}>{cell}</mtd>" for cell in row) + "</mtr>" for row in rows)
        opening, closing = (operator(f, ' stretchy="true"') if f else "" for f in FENCES[kind])
        return f"<mrow>{opening}<mtable>{cells}</mtable>{closing}</mrow>"


def mathml(tex, display=False):
    block = ' display="block"' if display else ""
    return f"<math{block}>{Formula(tex).row(None)}</math>"


def page(text):
    """The page with MathML in the place of its formulas."""
    def fence(found):
        if found[1] != "math":
            return found[0]
        return formula(found[2], True)

    def formula(tex, display):
        try:
            return mathml(tex, display)
        except ValueError as why:
            raise ValueError(f"the formula `{' '.join(tex.split())}` {why}") from None

    # fences first, and kept apart: what looks like a formula inside of them is none
    parts = re.split(r"(^```.*?^```[ \t]*$)", text, flags=re.MULTILINE | re.DOTALL)
    for k, part in enumerate(parts):
        if k % 2:
            parts[k] = re.sub(r"\A```(\w*)[^\n]*\n(.*?)^```[ \t]*\Z", fence, part, flags=re.MULTILINE | re.DOTALL)
        else:
            parts[k] = re.sub(r"\$`(.+?)`\$", lambda found: formula(found[1], False), part, flags=re.DOTALL)
    return "".join(parts)


def change(value):
    """Every chapter of the book, sections of sections too."""
    if isinstance(value, list):
        return [change(v) for v in value]
    if not isinstance(value, dict):
        return value
    value = {k: change(v) for k, v in value.items()}
    if isinstance(value.get("content"), str):
        try:
            value["content"] = page(value["content"])
        except ValueError as why:
            sys.exit(f"error: {value.get('path')}: {why}")
    return value


def check():
    mistakes = 0
    for file in sorted(pathlib.Path(__file__).resolve().parent.rglob("*.md")):
        try:
            page(file.read_text(encoding="utf-8"))
        except ValueError as why:
            mistakes += 1
            print(f"{file}: {why}", file=sys.stderr)
    sys.exit(1 if mistakes else 0)


def main():
    if sys.argv[1:2] == ["--check"]:
        check()
    if sys.argv[1:2] == ["supports"]:
        sys.exit(0 if sys.argv[2] == "html" else 1)
    _, book = json.loads(sys.stdin.buffer.read().decode("utf-8"))
    sys.stdout.buffer.write(json.dumps(change(book)).encode("utf-8"))


if __name__ == "__main__":
    main()
