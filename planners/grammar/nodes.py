"""What a clause's tree is made of, and the exception for a clause that cannot become a plan.

Knows how to find the tokens and subtrees of a node by name. Refuses to know what any of them means.
"""

from __future__ import annotations

from lark import Token, Tree

from .tagging.tags import Tag

Node = Tree[Token]


class Refusal(Exception):
    """The clause cannot become a plan.

    Attributes:
        verdict: of the plan.
        words: the words to blame, as written.
    """

    def __init__(self, reason: str, *words: str, verdict: str = "not_understood") -> None:
        super().__init__(reason)
        self.verdict = verdict
        self.words = words


def tag_of(token: Token) -> Tag:
    """The tag that a token of the grammar carries."""
    value: Tag = token.value
    return value


def tokens(node: Node, *types: str) -> list[Tag]:
    """The tags of these types directly below a node."""
    return [tag_of(c) for c in node.children if isinstance(c, Token) and c.type in types]


def trees(node: Node, *names: str) -> list[Node]:
    """The children with these names."""
    return [c for c in node.children if isinstance(c, Tree) and (not names or c.data in names)]
