"""Body measures of a standing adult, in metres, from which clearances and heights in rooms follow."""

from __future__ import annotations

EYE_HEIGHT = 1.55  # of standing eyes above the floor: between the averages of women and men
SEATED_EYES = 1.15  # height of the eyes of a person on a chair or sofa
HEADROOM = 1.9  # people walk under things above this height; use zones end at it
SHOULDERS = 0.5  # shoulder width with clothes: the narrowest passage that a person walks through
WALKWAY = 0.6  # width of a comfortable passage, preferred where there is a choice
ARM = 0.6  # reach from the edge of the body
STEP = 0.05  # people and furniture stand on things up to this height: rugs, mats, sills
HUNG_AT = 1.5  # usual height of the middle of things that hang on a wall, a little below the eyes

# Width and depth in metres of the floor that an activity takes: of a yoga mat, of outstretched arms, of a lying adult.
ACTIVITIES: dict[str, tuple[float, float]] = {
    "yoga": (2.0, 1.0), "pilates": (2.0, 1.0), "stretching": (2.0, 1.0), "exercise": (2.0, 1.5), 
    "exercises": (2.0, 1.5),
    "gymnastics": (2.0, 2.0), "push ups": (2.0, 1.0), "sit ups": (2.0, 1.0), "a workout": (2.0, 1.5),
    "dance": (2.4, 2.4),
    "dancing": (2.4, 2.4), "play": (1.6, 1.6), "lie": (2.0, 0.8), "sleep": (2.0, 0.9), "sit": (0.9, 0.9),
    "stand": (0.6, 0.6), "kneel": (0.9, 0.6), "tai chi": (2.0, 2.0), "aerobics": (2.0, 2.0), "meditation": (1.0, 1.0),
}  # fmt: skip
