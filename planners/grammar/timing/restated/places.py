"""Where to, and where not to."""

from __future__ import annotations

from ..moments import OWN
from .wording import Rules

RULES: Rules = (
    (r"^(?P<x>.+ (?:to|toward|towards|into|at|against|beside|by|till|until) .+?)(?: ,)? (?:instead of|rather than|"
     r"and not|not) (?:to |at |into |against |on |in |toward |towards |by |beside |next to )?(?P<np>(?:the|its|that|"
     r"a) (?!right$|left$|other way)(?![a-z ]*(?:second|time|speed|way|start|end|beginning)s?\b)[a-z]+(?: "
     r"[a-z]+){0,2})(?: like now| as now| as before| like before)?$", rf"\g<x> {OWN}"),
)  # fmt: skip
