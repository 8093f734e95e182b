"""The person that rooms are measured for: heights and widths in metres, of a standing adult."""

from __future__ import annotations

EYE_HEIGHT = 1.55  # of standing eyes above the floor: between women's and men's middle
HEADROOM = 1.9  # what begins higher up is walked under, and using a thing takes no more height
SHOULDERS = 0.5  # from shoulder to shoulder, with clothes: the narrowest way that is walked through
WALKWAY = 0.6  # a way that is passed at ease, where there is a choice
ARM = 0.6  # reach from the edge of the body
STEP = 0.05  # what is lower is stepped or stood upon: rugs, mats, sills
HUNG_AT = 1.5  # above the floor of the middle of what hangs on a wall to be looked at, a little below the eyes
