"""Questions that boxes, labels and colours cannot answer: owner, price, age, material, state, style, purpose.

Some of them pictures may answer ("is the door open?"), others nothing here can ("who owns it?"). They are read before
all other kinds, so that "is the piano in tune" is not taken for a question about places.
"""

from __future__ import annotations

from dataclasses import dataclass

from ....gaussians import late_re as re
from ..answer import AnswerType
from ..kind import Asked, Kind, Undecided
from ..reading.phrase_templates import templates
from ..survey import Survey

_THE = r"(?:the|this|that|these|those|my|our|your|his|her|their|a|an|all|all the|any|any of the|each of the|every)"
_BE = r"(?:is|are|was|were|be|being|been)"
_IS = rf"^(?:whether )?(?:{_BE}|do|does|did|has|have|can|could|would|will) "
_WHO = (
    r"(?:someone|somebody|anyone|anybody|people|person|persons|kids?|children|child|family|"
    r"owners?|owner|residents?|guests?|man|woman|students?|teachers?|he|she|they)"
)
_MATERIALS = (
    "wood|wooden|oak|walnut|pine|mahogany|teak|bamboo|timber|plywood|metal|metallic|steel|stainless steel|iron|"
    "aluminium|"
    "aluminum|chrome|brass|bronze|copper|leather|marble|stone|concrete|brick|porcelain|ceramic|glass|plastic|fabric|"
    "cloth|"
    "velvet|linen|cotton|wool|woolen|paper|cardboard|rattan|wicker|upholstered|upholstery|tiled|carpeted|hardwood|"
    "laminate|"
    "tiles|granite|silk|rubber|foam|felt|fur|denim|acrylic|crystal|clay"
)
_STATES = (
    "open|opened|closed|shut|ajar|locked|unlocked|on|off|turned on|turned off|switched on|switched off|lit|plugged in|"
    "unplugged|full|empty|clean|dirty|dusty|tidy|untidy|messy|cluttered|neat|broken|damaged|cracked|scratched|torn|"
    "worn|worn "
    "out|stained|wet|dry|made|unmade|made up|folded|rolled up|drawn|pulled back|up or down|occupied|used|in use|"
    "running|working|"
    "ticking|burning|blooming|in bloom|flowering|dead|alive|wilted|watered|tucked in|pushed in|ready|ready to use|"
    "set|laid|decorated|"
    "charged|playing|showing|displaying|ringing|steaming|boiling|frozen|organized|disorganized|well organized|"
    "intact|assembled|sharp|blunt|fresh|ripe|rotten"
)
_STYLES = (
    "cosy|cozy|modern|contemporary|traditional|old fashioned|antique|vintage|rustic|minimalist|minimalistic|elegant|"
    "stylish|"
    "fancy|luxurious|beautiful|pretty|nice|nicer|ugly|attractive|cute|lovely|inviting|welcoming|homely|"
    "warm and cosy|cheerful|gloomy|"
    "bright|dark|light|dim|well lit|sunny|airy|lived in|harmonious|balanced|crowded|cramped|spacious|formal|informal|"
    "professional|romantic|relaxing|relaxed|calm|boring|interesting|tasteful|tacky|feminine|masculine|"
    "child friendly|kid friendly|"
    "industrial|scandinavian|bohemian|classic|classical|retro|shabby|posh|patterned|striped|plain|solid|floral|"
    "checkered|"
    "checked|spotted|dotted|textured|shiny|glossy|matte|matt|reflective|transparent|see through|opaque|round|square|"
    "rectangular|circular|oval|triangular|curved|straight edged|curvy|cylindrical|spherical|folding|foldable|"
    "adjustable|padded|cushioned|framed|handmade|"
    "symmetrical|realistic|abstract|artificial|fake|real|electric|digital|analog|analogue|wireless|portable"
)
_NEVER_STATES = (
    "comfy|comfortable|uncomfortable|soft|hard|firm|cosy to sit on|heavy|light enough|sturdy|stable|wobbly|strong|"
    "solid enough|robust|"
    "expensive|cheap|valuable|pricey|worth it|worth anything|a bargain|affordable|overpriced|for sale|on sale|sold|"
    "rented|insured|"
    "old|new|brand new|second hand|used before|antique|original|genuine|authentic|"
    "hot|cold|warm|cool|chilly|freezing|noisy|loud|quiet|silent|smelly|stinky|fragrant|in tune|out of tune|tuned|"
    "waterproof|fireproof|flammable|edible|tasty|delicious|poisonous|toxic|healthy|safe|dangerous|haunted|allergic|"
    "popular|famous|important|necessary|useful|practical|functional|any good|good|bad|worth keeping|recyclable|"
    "washable|machine washable|dishwasher safe|easy to clean|hard to clean|easy to move|hard to move|movable|"
    "too heavy|happy|sad"
)


@dataclass(frozen=True)
class _Topic:
    """One topic that geometry does not tell.

    Attributes:
        why: the sentence that says so.
        sight: whether pictures may tell.
        patterns: of the words of a question, joined by spaces.
    """

    why: str
    sight: bool
    patterns: tuple[re.Pattern[str], ...]


def _topic(why: str, sight: bool, *patterns: str) -> _Topic:
    return _Topic(why, sight, tuple(re.compile(p) for p in patterns))


_TOPICS: tuple[_Topic, ...] = (
    _topic(
        "Nothing here tells who owns, made or uses it.", False,
        r"^(?:who|whose|whom)\b",
        r"\b(?:owner|owners|belong|belongs|owned|owns) (?:of|to|by)\b|\bwho(?:se)?\b .*\b(?:own|owns|owned|belong|"
        r"belongs|live|lives|sleep|sleeps|sit|sits|bought|made|built|designed|painted|uses|used)\b",
        rf"^(?:is|are|was|were) (?:it|this|that|{_THE} .*) (?:mine|yours|ours|hers|theirs)$",
        rf"{_IS}(?:{_THE} )?{_WHO} (?:else )?(?:\w+ly )?(?:live|lives|living|sleep|sleeps|sleeping|work|works|"
        rf"working|sit|sitting|use|uses|using|stay|come|been|home|here|own|owns|like|likes|play|plays|playing|share|"
        rf"shares|present|study|eat)\b",
        rf"\bhow many {_WHO} (?:live|sleep|work|use|are|stay|were|own)\b", r"\bwhat is the (?:name|profession|job|"
        r"hobby|gender|age) of (?:the )?(?:owner|person|resident|people)\b",
        r"\b(?:does|do|did) (?:the )?(?:owner|owners|people|residents?|person|family)\b",
    ),
    _topic(
        "Nothing here tells what it cost or is worth.", False,
        r"\b(?:price|prices|cost|costs|costing|priced|pricey|worth|value|valued|expensive|cheap|cheaper|cheapest|"
        r"dearer|affordable|afford|"
        r"retail|resale|budget|invoice|pay|paid|dollars?|euros?|pounds? sterling|money|buy|bought|purchase|"
        r"purchased|sell|sold)\b",
    ),
    _topic(
        "Nothing here tells the maker, brand or model.", False,
        r"\b(?:brand|brands|manufacturer|maker|manufactured|make and model|model number|serial number|designer|ikea|"
        r"which company|what company|warranty|"
        r"produced by|made by|which shop|which store|what store|what shop|where .* (?:come from|made|built|produced|"
        r"from originally))\b",
        r"^(?:what|which) (?:make|model)\b",
    ),
    _topic(
        "Nothing here tells how old it is, or when something happened.", False,
        r"\bhow (?:old|new|long ago|recent|recently|often|frequently|many (?:times|years|months|days|weeks|hours))\b",
        r"\b(?:what|which) (?:year|century|era|decade|date|day|month|season|period)\b",
        r"^when\b(?! (?:i|we|you|one|someone|sitting|standing|seen|looking|viewed|entering|"
        r"facing)\b)", rf"{_IS}.*\b(?:years? old|older|newer|the oldest|the newest|oldest|newest|brand new|"
        r"second hand|antique)\b",
        r"\b(?:oldest|newest)\b", r"\bthe age of\b", rf"{_IS}{_THE} [\w ]*(?<!how )(?:old|new)$", r"\bsince when\b|"
        r"\bhow long (?:has|have|did|will|does it take|ago|until|before)\b",
        r"\b(?:yesterday|tomorrow|tonight|last (?:week|year|month|night)|next (?:week|year|month)|weekends?|"
        r"every day|usually|in the past|recently)\b",
    ),
    _topic(
        "Nothing here tells how heavy it is or what it can carry.", False,
        r"\b(?:weigh|weighs|weighing|weight|heavy|heavier|heaviest|lightest|lighter|kilos?|kg|kilograms?|pounds?|"
        r"lbs|tons?|carry the weight|hold my weight|bear)\b",
        r"\b(?:how much|what) (?:load|mass)\b", rf"{_IS}.*\b(?:sturdy|stable|strong enough|wobbly)\b",
    ),
    _topic(
        "Comfort, smell, sound, taste and warmth are not in a scene's geometry.", False,
        r"\b(?:comfy|comfortable|uncomfortable|comfort|comfier|comfiest|comfortably seated|smell|smells|smelly|"
        r"scent|odor|odour|stink|sound like|sounds like|noise|noisy|loud|"
        r"quiet|hear|acoustics|taste|tastes|tasty|delicious|temperature|how warm|how cold|how hot|warm enough|"
        r"cold enough|feel like to touch|feels soft|soft to)\b",
        rf"{_IS}.*\b(?:{_NEVER_STATES})$", r"\bin tune\b|\bout of tune\b",
        r"^how (?:soft|hard|firm|warm|cold|hot|comfy|cosy|cozy|noisy|loud|quiet|sturdy|strong|stable|fast|smooth|"
        r"rough|sharp|tasty)\b",
        r"\bfeel(?:s)? (?:soft|hard|warm|cold|smooth|rough|comfy|comfortable|heavy|light)\b",
    ),
    _topic(
        "Geometry does not tell what things are made of; a picture may.", True,
        r"\b(?:made (?:out )?of|made from|what material|which material|what kind of material|materials?|fabric type|"
        r"type of (?:wood|fabric|metal|material|stone)|"
        r"kind of (?:wood|fabric|metal|material|stone)|texture|finish|upholstered|built (?:out )?of)\b",
        rf"{_IS}.*\b(?:{_MATERIALS})(?: (?:or|and) (?:{_MATERIALS}))*$",
        rf"^(?:which|what|list|name|how many|show me|count|any)\b.*\b(?:{_MATERIALS})(?: things?| objects?| items?|"
        rf" furniture| ones?| pieces?.*)?(?: (?:here|in the room|are there|is there|are here))*$",
        rf"^(?:is|are) there (?:any|some|anything)(?: thing| things)? (?:{_MATERIALS})\b(?! (?:table|desk|chair|"
        rf"bottle|bowl|vase|shelf|board|basket|bin|bag|box|door|jar|case))",
        rf"{_IS}.*\b(?:wooden|metallic|leather|plastic|woolen) (?:or|and)\b",
    ),
    _topic(
        "Geometry does not read writing, dials or pictures; somebody who sees them may.", True,
        r"\b(?:what|which).*\b(?:say|says|said|read|reads|written|write|writing|text|title|titles|titled|words?|"
        r"letters?|language|caption|label say|logo|inscription|headline|subject|"
        r"show time|time does|time is it|time it is|time on|time shown|depicted|depict|depicts|painted on|printed|"
        r"portrayed|drawn on|channel|program|programme|movie|song|music)\b(?! (?:in|on) the (?:left|right))",
        r"^what (?:does|do|is|are) (?:the |this |that )?(?:clock|watch|thermometer|calendar|sign|poster|painting|"
        r"picture|photo|photograph|screen|monitor|tv|television|board|whiteboard|blackboard|book|books|display|"
        r"scale)s? "
        r"(?:say|show|shows|showing|read|reads|display|displaying|depict|depicting|about|of|playing|tell|tells|"
        r"portray|mean)\b",
        r"^(?:is|are) (?:there )?(?:anything|something|any text|any writing|some text|a name|a logo|"
        r"a picture) (?:written|printed|drawn|shown|displayed|painted)\b",
        r"\bwritten on\b|\bwhat time\b|\bwhat is (?:on|showing on|playing on) (?:the )?(?:tv|telly|television|"
        r"screen)\b", r"\b(?:painted|drawn|photographed) by\b",
        rf"{_IS}.*\b(?:blank|legible|readable|signed)$", r"\bwhat (?:kind|type|sort|genre) of (?:books?|music|"
        r"paintings?|pictures?|art|movies?|plants?|flowers?|animals?|trees?)\b",
    ),
    _topic(
        "Geometry does not tell the state of things, open or closed, on or off; a picture may.", True,
        rf"{_IS}{_THE} [\w' ,]*?(?<!further )\b(?:{_STATES})(?: or (?:{_STATES}|not))?$",
        rf"{_IS}(?:everything|anything|something|it|they) (?:\w+ly )?(?:{_STATES})(?: or (?:{_STATES}))?$",
        r"\b(?:turned|switched|plugged|screwed) (?:on|off|in|up|down)\b|\b(?:open or (?:closed|shut)|closed or open|"
        r"on or off|full or empty|empty or full|up or down|clean or dirty|made or unmade|lit or)\b",
        r"^how (?:clean|dirty|full|empty|tidy|messy|dusty|bright|dark|worn|damaged|open)\b", r"\b(?:condition|"
        r"state) of\b|\bin (?:good|bad|poor|working) (?:condition|order|shape)\b",
        r"\b(?:need|needs) (?:cleaning|repair|repairing|fixing|washing|dusting|water|watering|tidying|replacing|"
        r"painting)\b",
        r"\bwhat (?:condition|state)\b", r"\bhas (?:the|this) bed been made\b", r"^(?:does|do|is|are) (?:the|"
        r"this|that) .* (?:work|works|function|functioning)$",
        rf"^(?:which|what) (?:\w+ )+(?:is|are) (?:{_STATES})$", r"^how many (?:\w+ )+(?:is|are) (?:open|closed|shut|"
        r"turned on|switched on|lit|on|off|broken|empty|full|made)$",
        r"\b(?:dust|stain|stains|scratch|scratches|crack|cracks|dents?|mold|mould|damage|rust) (?:on|in)\b",
        r"^(?:is|are) there (?:any |some |a |much |a lot of )?(?:dust|stains?|scratch(?:es)?|cracks?|dents?|mold|"
        r"damage|rust|dirt|clutter|mess|rubbish lying|water in)\b",
    ),
    _topic(
        "Geometry does not tell looks, style or mood; somebody who sees a picture may.", True,
        r"\b(?:style|styles|mood|atmosphere|vibe|vibes|ambience|ambiance|theme|decor|aesthetic|aesthetics|"
        r"interior design|impression|feel of|feeling of|pattern|patterns|looks like|look like|appearance)\b",
        rf"{_IS}.*\b(?:look|looks|feel|feels|seem|seems|appear|appears) (?:\w+ly |very |a bit |quite |rather |too |"
        rf"more |like )*(?:{_STYLES}|{_STATES}|like|good|clean|tidy|old|new|expensive|cheap|comfortable|lived in|"
        rf"inviting|used|well)\b",
        rf"{_IS}{_THE} [\w' ]*?\b(?:very |rather |quite |too |a bit |really )?(?:{_STYLES})$", rf"{_IS}(?:it|this|"
        rf"that) (?:a )?(?:very |rather |quite |too |a bit )?(?:{_STYLES})(?: (?:room|place|scene|space))?$",
        rf"{_IS}{_THE} [\w' ]*?(?:{_STYLES}) or (?:{_STYLES})$", r"^how (?:does|do|would you describe) (?:the|this|"
        r"it) .*(?:look|feel|style|mood)\b|^how (?:cosy|cozy|modern|stylish|pretty|beautiful|nice|elegant|"
        r"old fashioned|homely|inviting)\b",
        r"\bwhat shape\b|\bshape of\b|\bwhich shape\b|\bthe shape\b", r"\b(?:room|place|scene|apartment) (?:is|look|"
        r"looks|feel|feels) (?:cosy|cozy|modern|warm|nice|inviting)\b",
        r"\bwhat (?:kind|sort|type) of (?:room|place|house|building|home|apartment|scene|style) \b|\bwhat (?:kind|"
        r"sort|type) of (?:room|place|house|building)\b|^(?:what|which) room is (?:this|it|shown)\b|^is (?:this|"
        r"it) an? (?:bedroom|living room|kitchen|office|bathroom|hotel|dining room|classroom|studio|house|home|flat|"
        r"apartment)\b",
        r"\b(?:beautiful|prettiest|nicest|ugliest|cutest|coolest|cosiest|coziest|most (?:beautiful|modern|stylish|"
        r"elegant|attractive|interesting))\b",
    ),
    _topic(
        "What happens outside, by day or in the weather cannot be told from here.", True,
        r"\b(?:weather|raining|rain|snowing|sunny|sunlight|sunshine|sun|daylight|natural light|daytime|night time|"
        r"nighttime|dark outside|light outside|outside|outdoors|view from|see outside|the view|what floor|"
        r"which floor|city|country|address|street|neighbou?rhood|storey)\b(?! of)",
        r"\b(?:enough|much|how much) (?:light|daylight)\b", r"^(?:is it|was it) (?:day|night|morning|evening|dark|"
        r"light|bright)\b",
    ),
    _topic(
        "What to do or to use for something is no matter of geometry; somebody who sees the room may advise.", True,
        r"^(?:should|shall) (?:i|we|you|one)\b|\bwhat should\b|\bshould (?:i|we)\b",
        r"^how (?:do|can|would|should) (?:i|we|you|one) (?:use|turn|switch|open|operate|clean|assemble|fix|repair|cook|"
        r"make|wash|improve|decorate|play|get rid|start|connect|cool|heat|warm|increase|reduce|lower the|raise the)\b",
        r"\b(?:can|could) (?:i|we|you|one) use (?:to|for|in)\b|\bcan be used (?:to|for|as)\b|"
        r"\bis there anything i can use\b",
        r"^(?:i am|i feel|i am feeling) (?:thirsty|hungry|tired|cold|hot|bored|sleepy|ill|sick)\b",
    ),
    _topic(
        "Reasons, purposes and opinions cannot be told from geometry.", False,
        r"^why\b|^what (?:is|are) .* (?:used for|for|good for|the purpose|the point)$|\bwhat .* purpose\b|"
        r"\bhow come\b|\bwhat for\b|\bthe purpose of\b|\bthe reason\b|\bmeaning of\b",
        r"\b(?:do|would|did) you (?:like|prefer|enjoy|recommend|love|hate|suggest|choose|buy|want|live|feel)\b|"
        r"\b(?:your|the) (?:favourite|favorite|opinion|advice|recommendation)\b",
        r"^(?:should|shall) (?:i|we|you|one)\b|\bwhat should\b|\bwould it be (?:better|nicer|good|wise|"
        r"a good idea)\b|\bis it (?:a good idea|better|worth|safe|ok|okay|allowed|legal|healthy|hygienic)\b",
        r"\b(?:favorite|favourite|the best|the worst|nicer|better|prettier|prefer|preferred)\b(?! (?:seen|placed))",
        r"^how (?:do|can|would|should) (?:i|we|you|one) (?:use|turn|switch|open|operate|clean|assemble|fix|repair|"
        r"cook|make|wash|improve|decorate|play|get rid|start|connect)\b", r"^how (?:does|do) (?:it|this|that|"
        r"the .*) work\b",
        r"\b(?:allergic|allergies|insurance|warranty|ghosts?|haunted|dream|happy|sad|feeling|think about|religion|"
        r"politics|rich|poor)\b",
        r"\bgood for (?:sleeping|reading|working|children|kids|my back|parties|studying|guests|the environment)\b",
    ),
)  # fmt: skip
_PHRASES = "{w:words}"


def answer(asked: Asked, survey: Survey) -> Undecided | None:
    """Why a question cannot be answered, and whether somebody who sees pictures may; None if it is of another kind."""
    said = " ".join(asked.words)
    whole = " ".join(w for w in asked.words if w != ",")
    for topic in _TOPICS:
        for pattern in topic.patterns:
            if pattern.search(said) or pattern.search(whole):
                return Undecided(topic.why, topic.sight, _type(asked))
    return None


def _type(asked: Asked) -> AnswerType:
    first = asked.words[0] if asked.words else ""
    closed = first in (
        "is",
        "are",
        "does",
        "do",
        "has",
        "have",
        "can",
        "could",
        "was",
        "were",
        "whether",
        "did",
        "would",
    )
    return "yesno" if closed and "or" not in asked.words else "text"


KIND = Kind("undecidable", templates(_PHRASES), answer)
