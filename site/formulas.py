"""Short formulas as text, which a page shows without a script that draws them."""

from __future__ import annotations

import html
import re

_SYMBOLS = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "varepsilon": "ε",
    "zeta": "ζ", "eta": "η", "theta": "θ", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν",
    "xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ", "varphi": "φ",
    "chi": "χ", "psi": "ψ", "omega": "ω", "Gamma": "Γ", "Delta": "Δ", "Sigma": "Σ", "Psi": "Ψ",
    "Omega": "Ω", "cdot": "·", "times": "×", "leq": "≤", "le": "≤", "geq": "≥", "ge": "≥",
    "neq": "≠", "approx": "≈", "in": "∈", "subset": "⊂", "subseteq": "⊆", "to": "→", "infty": "∞",
    "partial": "∂", "nabla": "∇", "sum": "Σ", "int": "∫", "pm": "±", "perp": "⊥", "circ": "°",
    "ldots": "…", "dots": "…", "quad": " ", "top": "ᵀ", "|": "‖", ",": " ", ";": " ", " ": " ",
    "left": "", "right": "", "sin": "sin", "cos": "cos", "tan": "tan", "ln": "ln", "exp": "exp",
    "max": "max", "min": "min",
}  # fmt: skip
_UPRIGHT = ("mathrm", "text", "operatorname", "mathbf", "mathit")
_GROUP = r"\{((?:[^{}]|\{[^{}]*\})*)\}"


def formula(latex: str) -> str:
    r"""Return HTML of a short formula, without a script that draws it.

    Raises:
        ValueError: naming a command that is not known.

    >>> formula(r"R\dot\varphi")
    'Rφ̇'
    """
    text = latex.strip()
    text = re.sub(rf"\\(?:{'|'.join(_UPRIGHT)}){_GROUP}", r"\1", text)
    text = re.sub(r"\\sqrt" + _GROUP, r"√(\1)", text)
    text = re.sub(r"\\[dt]?frac" + _GROUP + _GROUP, r"(\1)/(\2)", text)
    dots: list[str] = []

    def dotted(match: re.Match[str]) -> str:
        dots.append("\u0307" if match[1] == "dot" else "\u0308")
        return f"{match[2] or match[3]}\0"

    text = re.sub(r"\\(d?dot)(?:\{([^{}]*)\}|\s*(\\\w+|\w))", dotted, text)

    def symbol(match: re.Match[str]) -> str:
        try:
            return _SYMBOLS[match[1]]
        except KeyError:
            raise ValueError(
                f"\\{match[1]} in {latex!r} is not known to site/formulas.py"
            ) from None

    text = re.sub(r"\\([A-Za-z]+|.)\s*", symbol, text)
    marks = iter(dots)
    text = re.sub("\0", lambda _: next(marks), text)
    text = html.escape(text, quote=False)
    for mark, tag in (("_", "sub"), ("^", "sup")):
        text = re.sub(rf"{re.escape(mark)}(?:\{{([^{{}}]*)\}}|(\S))", rf"<{tag}>\1\2</{tag}>", text)
    return text.replace("{", "").replace("}", "")
