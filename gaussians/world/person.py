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
