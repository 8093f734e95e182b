"""What people, things and weather do, beside what commands ask for: verbs of everyday life and their finite forms.

They tell a remark from a noun phrase ("the lamp glares", "nobody plays that guitar") and, at the beginning of a
command, what no operation does ("boil the kettle").
"""

from __future__ import annotations

from functools import cache

from ..tagging.words import bag

# Done to things or by people: as a command, no operation carries it out.
ACTIONS = bag(
    "answer ask bake light slice rock carve decorate "
    "bang beat bite blend blink boil boot bounce braise brew build buy call catch "
    "charge chat chew chill climb connect cook crack crush cry dance defrost deliver descale dial dig disconnect "
    "dismantle donate drain draw drill drink drive dry eat explain extinguish feed film "
    "finish fish freeze fry grate grill grind hammer harvest heat hire hit hoover hug "
    "ignite iron juggle jump kiss knit knock laugh launch lend listen "
    "load mend microwave milk mince mix mop mow nail oil operate order overhaul pay peel "
    "phone photograph pluck poke pour practise practice preheat press prune pump punch "
    "rattle read rebuild recharge record refill reheat rent repair rescue ride "
    "ring rinse roast run rush sail saw scratch scream screw scrub sell service sew shave shine shoot shout shower "
    "sing sip skate sketch sleep smoke sniff solve speak spill squash squeeze squirt start steam stitch stir "
    "strike stroke strum study sweep swim talk tap taste teach telephone test "
    "thaw tickle tie toast translate tune tweet type unblock unlock untie unwrap vacuum visit wake "
    "warm-up wash watch water weave weed weigh weld whisk whistle wind wrap"
)
# What things and people are said to do; never a command here.
_HAPPENINGS = bag(
    "ache age agree annoy appear argue arrive attract bang beep belong blare bleed blind block bloom bother break "
    "breathe bring bulge burn buzz bump care cause change clash clutter collect come complain confuse cost crack "
    "creak crumble crowd date depress decide deserve die disappear distract drag dominate droop drop drip eat echo "
    "embarrass end fade fall feel fidget fight fill find fit flicker forget frighten gather get glare gleam glow "
    "grate gross grow grumble hang happen hate have hear hit hog hum hurt irritate jam jar keep kill know lack leak "
    "leave lie like live loom look loathe lose love make match mean melt miss need nag obstruct offend open overwhelm "
    "peel pinch play prefer rattle reek reflect remind remember ruin rust rot sag say scare scrape scratch see seem "
    "shake shed shine show sit sleep smell snag snore spoil squeak squeal squash stain stand start stay steal stick "
    "stink stop stress suffer suit swallow sweat sway swear take talk tangle tear think throw tick tip tire topple "
    "trip trouble twist upset use visit want warp waste wear weep whine whistle wilt wobble wonder work worry yell"
)
_IRREGULAR: dict[str, str] = {
    "bite": "bit", "bleed": "bled", "break": "broke", "bring": "brought", "buy": "bought", "catch": "caught",
    "come": "came", "cost": "cost", "dig": "dug", "draw": "drew", "drink": "drank", "drive": "drove", "eat": "ate",
    "fall": "fell", "feed": "fed", "feel": "felt", "fight": "fought", "find": "found", "forget": "forgot",
    "get": "got", "grow": "grew", "have": "had", "hear": "heard", "hit": "hit", "hurt": "hurt", "keep": "kept",
    "know": "knew", "leave": "left", "lose": "lost", "make": "made", "mean": "meant", "pay": "paid", "ride": "rode",
    "ring": "rang", "run": "ran", "say": "said", "see": "saw", "sell": "sold", "shake": "shook", "shoot": "shot",
    "sing": "sang", "sit": "sat", "sleep": "slept", "speak": "spoke", "stand": "stood", "steal": "stole",
    "stick": "stuck", "stink": "stank", "strike": "struck", "swear": "swore", "sweep": "swept", "swim": "swam",
    "take": "took", "teach": "taught", "tear": "tore", "think": "thought", "throw": "threw", "wake": "woke",
    "wear": "wore", "weave": "wove", "weep": "wept", "wind": "wound",
}  # fmt: skip
_VOWELS = "aeiou"


def _third(verb: str) -> str:
    if verb.endswith(("s", "sh", "ch", "x", "z", "o")):
        return verb + "es"
    return verb[:-1] + "ies" if verb.endswith("y") and verb[-2] not in _VOWELS else verb + "s"


def _past(verb: str) -> str:
    if verb.endswith("e"):
        return verb + "d"
    if verb.endswith("y") and verb[-2] not in _VOWELS:
        return verb[:-1] + "ied"
    short = len(verb) > 2 and verb[-1] not in _VOWELS + "wxy" and verb[-2] in _VOWELS and verb[-3] not in _VOWELS
    return verb + verb[-1] + "ed" if short and len(verb) < 5 else verb + "ed"


def _ongoing(verb: str) -> str:
    if verb.endswith("ie"):
        return verb[:-2] + "ying"
    if verb.endswith("e") and not verb.endswith("ee"):
        return verb[:-1] + "ing"
    short = len(verb) > 2 and verb[-1] not in _VOWELS + "wxy" and verb[-2] in _VOWELS and verb[-3] not in _VOWELS
    return verb + verb[-1] + "ing" if short and len(verb) < 5 else verb + "ing"


@cache
def plain() -> frozenset[str]:
    """The verbs themselves."""
    return ACTIONS | _HAPPENINGS


@cache
def said_of_one() -> frozenset[str]:
    """The forms behind one thing or person: "glares", "tripped"."""
    return frozenset(_third(v) for v in plain()) | said_before()


@cache
def said_before() -> frozenset[str]:
    """The forms of what was: "broke", "tripped"."""
    return frozenset(_IRREGULAR.get(v, _past(v)) for v in plain())


@cache
def ongoing() -> frozenset[str]:
    """The -ing forms: "tripping"."""
    return frozenset(_ongoing(v) for v in plain())
