"""Kinds of questions about scenes with time, in the order in which they are tried."""

from . import lasting, looks, movers, order, places, speeds, when, whether

KINDS = (
    lasting.CLIP,
    *looks.KINDS,
    lasting.BETWEEN,
    order.ORDER,
    order.DOES,
    speeds.OFTEN,
    when.WHEN,
    speeds.FAST,
    lasting.LONG,
    places.WAY,
    speeds.FAR,
    movers.MANY,
    places.WHERE,
    speeds.FASTER,
    movers.WHICH,
    whether.EITHER,
    whether.WHETHER,
)
