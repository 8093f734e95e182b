"""Where something is, and which of several is meant."""

from __future__ import annotations

from .wording import EVENT, ING, PLAIN, Rules, S

RULES: Rules = (
    # where
    (r"(?: (?:across|over|along))? so (?:that )?(?:it|he|she|they) (?:ends? up|stands?|is|lands?|sits?) (?=(?:next "
     r"to|beside|by|near|at|in front of|behind|on|under) the )", " "),
    (rf"\b(?P<v>{PLAIN}|{S}) (?:until|till|up until) (?P<np>(?:the|my) (?!end|start|beginning|finish|middle|final|"
     r"second|moment|time|last|first|very)[a-z]+)(?= (?:in|from|at|over|within|during|between|for|by|,)\b|$| ,)",
     r"\g<v> to \g<np>"),
    (rf"\b(?P<v>(?:{PLAIN}|{S})(?: (?:the|my) [a-z]+(?: [a-z]+)??)?)(?: (?:across|over|along|up|down|around|"
     r"through))? and (?:then )?(?:settles?|parks?|lands?|(?:come|comes) to (?:a )?(?:rest|stop|halt)|sits?|stops?|"
     r"waits?|stands?|rests?|halts?|stays?) (?P<at>next to|beside|by|near|in front of|behind|at|on|under|against)\b",
     r"\g<v> \g<at>"),
    (r"\b(?:straight|right|directly) (?=(?:up|down|into the air)\b)", ""),
    (r"\b(?P<w>stays?|remains?) (?:up|down|over|right|exactly|just) (?=where\b|put\b)", r"\g<w> "),
    (r"\b(?P<v>pushe?s?|moves?|slides?|shoves?|rolls?|drives?|put|bring|pull|drag)(?P<x>(?: .*?)?) (?:right )?up "
     r"(?:against|next to|close to|beside|to) (?=the )", r"\g<v>\g<x> to "),
    (r"\b(?P<v>moved?|pushed?|brought|carried|slid|shifted|placed|put) (?:right )?over (?:by|to|next to|beside|near) "
     r"(?=the )", r"\g<v> to "),
    (r"\b(?P<w>up|upwards) (?:off|from|above) (?:the|its|his) [a-z]+(?: [a-z]+)?(?= (?:,|from|between|at|in|for|over|"
     r"until)|$)", r"\g<w>"),
    (r"\bback up (?:on |on to |onto |to )(?:its|their|the) (?:board|shelf|shelves|place|spot)\b", "back"),
    (r"\bback (?:up |down |over |in )?to (?:its|his|her) (?!start|place|spot|old|first|original|former|colou?r)"
     r"(?P<x>[a-z]+)", r"to the \g<x>"),
    (r"\b(?P<w>stays?|remains?|staying) (?:up|down|over|right|back) there\b", r"\g<w> where it is"),
    (rf"(?P<v>\b(?:{PLAIN}|{S}|{ING}))(?: (?:across|through|along|over) the (?:room|floor|scene|ground|air))? and "
     r"(?:to )?(?:ends?|ended|ending|finish(?:es)?|wind|winds) up (?=(?:at|beside|next|by|in|on|near) )", r"\g<v> "),
    (r"(?P<v>\b(?:float|go|move|rise|lift|come|fly)s? (?:up )?(?:by )?)(?P<d>(?:\d+(?:\.\d+)?|[a-z]+) (?:cm|"
     r"centimet(?:re|er)s?|m|met(?:re|er)s?)) (?:from|off|above|over) the [a-z]+(?: [a-z]+)?(?= ?(?:[,.]|$))",
     r"\g<v>\g<d>"),
    (r"(?P<d>\b(?:\d+(?:\.\d+)?|[a-z]+) (?:cm|centimet(?:re|er)s?|m|met(?:re|er)s?)) (?:off|above) the [a-z]+(?: "
     r"[a-z]+)?(?= ?(?:[,.]|$))", r"\g<d>"),
    (r"\b(?P<v>(?:drive|roll|move|walk|go|come|slide|run|fly|hop)s?)(?: up| over)? and (?:then )?(?:stop|park|halt|"
     r"wait|stand|stay)s? (?=(?:beside|next to|by|near|in front of|behind|at|on) )", r"\g<v> "),
    (r"(?P<v>\b(?:drive|roll|move|walk|go|come|slide|run|fly|hop)s? (?:[a-z]+ )*?(?:\d+(?:\.\d+)?|one|two|three|half a)"
     r" ?(?:cm|m|met(?:re|er)s?|centimet(?:re|er)s?))(?: ,)? and (?:then )?(?:stop|park|halt|wait|stand|stay|rest)s?"
     r"(?: there| still| here)?$", r"\g<v>"),
    # which
    (rf"\bthe (?:whole|entire|complete|full) (?P<e>{EVENT}|action) (?=of the )", r"the \g<e> "),
    (r"\bthe (?:whole |entire )?(?P<x>[a-z]+(?: [a-z]+)?) action\b", r"the \g<x> motion"),
    (rf"\bthe (?:whole|entire|complete) (?P<x>[a-z]+(?: 's)?) (?P<e>{EVENT})\b", r"the \g<x> \g<e>"),
    (rf"\b(?:cut|break) (?P<x>.+? (?:'s )?{EVENT}) (?:off|short) (?=at|after|when|once)", r"stop \g<x> "),
    (rf"\b(?P<det>the [a-z ]*?)(?P<noun>[a-z]+) (?P<rest>(?:(?:to|should|must|shall) )?{PLAIN} (?:before|after|while)"
     r" the [a-z]+) one (?P<do>does|do|did)$", r"\g<det>\g<noun> \g<rest> \g<noun> \g<do>"),
    (rf"\b(?P<verb>{PLAIN}) (?P<w>before|after|while) (?P<x>(?:the|my|our|both|all) [a-z ]+?) (?:does|do|did)$",
     r"\g<verb> \g<w> \g<x> \g<verb>"),
)  # fmt: skip
