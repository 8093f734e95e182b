"""Further wordings of generated questions, by kind, which were held back while the reader was developed.

Names and holes are those of `sentences`; yes-or-no wordings keep the words by which the makers tell which side is yes.
"""

from __future__ import annotations

EXISTENCE = ("Have they got {one} in there?", "I wonder if there is {one} somewhere.", "Any {many} around?")
COUNT = (
    "I'd like to know how many {many} this place has.",
    "{many}: how many of them?",
    "How many {many} stand around here?",
)
COUNT_COLOUR = ("What number of {colour} {many} do we have?", "I want the number of {colour} {many}.")
COUNT_IS = ("Are there exactly {n} {many} here?", "Do you count more than {less} {many}?")
COLOUR = ("Can you tell what colour {a} is?", "Which colour is {a} painted in?", "{A}: what colour?")
COLOUR_IS = ("Does {a} look {colour}?", "{A} is {colour}, isn't it?")
HEIGHT = (
    "How many metres does {a} measure from top to bottom?",
    "Tell me {a}'s height.",
    "How tall would you say {a} is?",
)
LENGTH = ("What does {a} measure lengthwise?", "Tell me the length of {a} please.")
WIDTH = ("What width does {a} have?", "How broad is {a}?")
TALLER = ("Of {a} and {b}, which is the taller one?", "Is it {a} or {b} that is taller?")
BIGGER = ("Of {a} and {b}, which is the larger?", "Which has more volume, {a} or {b}?")
TALLER_IS = (
    "Does {a} have a greater height than {b}?",
    "Is {b} shorter than {a}?",
)
BIGGER_IS = ("Would you call {a} bigger than {b}?", "Compared with {b}, is {a} smaller?")
CENTERS = (
    "From centre to centre, what separates {a} and {b}?",
    "How many metres lie between the centre of {a} and that of {b}?",
)
GAP = ("What clearance is there between {a} and {b}?", "How many metres of empty space separate {a} and {b}?")
APART = (
    "How far apart do {a} and {b} stand?",
    "What's the distance of {b} from {a}?",
    "How close is {a} to {b}, in metres?",
)
FARTHER_THAN = ("Would I measure more than {d} m between {a} and {b}?", "Are {a} and {b} over {d} metres apart?")
NEAREST = ("What stands nearest to {a}?", "Which thing lies closest to {a}?", "Name the nearest neighbour of {a}.")
FARTHEST = ("What lies farthest away from {a}?", "Name the thing at the greatest distance from {a}.")
NEARER = ("Of {a} and {b}, which one is closer to {c}?", "Which one stands nearer to {c}, {a} or {b}?")
NEARER_IS = ("Does {a} stand closer to {c} than {b} does?", "Compared with {b}, is {a} nearer to {c}?")
SIDE = ("Do I see {a} left or right of {b}?", "On which side of {b}, left or right, is {a}?")
SIDE_IS = ("Does {a} lie to the {side} of {b} as I see it?", "Looking from here, is {a} {side} of {b}?")
DEPTH = ("As I see it, is {a} before or behind {b}?", "Is {a} nearer to me than {b}, so in front of it, or behind it?")
DEPTH_IS = ("As I see it, does {a} stand {side} {b}?", "From my place, is {a} {side} {b}?")
OWN_SIDE = (
    "Going by the front of {b}, is {a} at its left or its right?",
    "On which of {b}'s own sides, left or right, is {a}?",
)
OWN_FRONT = (
    "Going by the front of {b}, is {a} before it or behind it?",
    "Is {a} at the front of {b} or at its back?",
)
SEATED = (
    "Taking a seat on {b}, would I have {a} to my left or to my right?",
    "From the seat of {b}, is {a} left or right?",
)
SEATED_IS = ("When I take a seat on {b}, is {a} on my {side}?", "Seated on {b}, would {a} be at my {side} hand?")
FACING = (
    "I am at {b} and face {c}. Which side of me is {a} on, left or right?",
    "From {b}, looking in the direction of {c}, is {a} left or right?",
)
FACING_BEHIND = ("I am at {b}, facing {c}. Is {a} behind me?", "Facing {c} from {b}, would I have {a} behind me?")
ON = ("What has been placed on {a}?", "What can be found on top of {a}?", "Tell me what stands on {a}.")
ON_IS = ("Has {a} been put on {b}?", "Does {a} rest on {b}?", "Can I find {a_one} on {b}?")
CARRIER = ("What carries {a}?", "What does {a} rest on?", "Which thing has {a} on top?")
ANY_ON = ("Has anything been put on {a}?", "Does {a} carry anything?")
UNDER_IS = ("Does {a} lie beneath {b}?", "Can I find {a_one} below {b}?")
NEXT_IS = ("Does {a} stand beside {b}?", "Are {a} and {b} side by side?", "Is {a} adjacent to {b}?")
BETWEEN_IS = ("Would you find {a} in the middle between {b} and {c}?", "Do {b} and {c} have {a} between them?")
INSIDE = ("What has been put inside {a}?", "Tell me what {a} holds.", "What can be found in {a}?")
INSIDE_IS = ("Has {a} been put in {b}?", "Can {a} be found inside {b}?")
OF_COLOUR = (
    "Show me all that is {colour}.",
    "What {colour} things are there?",
    "Which of the things here have a {colour} colour?",
)
ON_WALL = ("What has been hung on the walls?", "Name the things that hang on a wall.")
ALL = ("Give me a list of the things in here.", "What objects are there?", "Enumerate the contents of this room.")
TALLEST = ("What rises highest among the things on the floor?", "Name the tallest of the things on the floor.")
TALLEST_BUT = ("Doors and windows aside, what is the tallest thing on the floor?",)
BULKIEST = ("What has the greatest volume in here?", "Name the biggest thing in this room.")
SMALLEST = ("Name the smallest thing here.", "What has the least volume in this room?")
ROOM_WIDTH = ("What does the room measure from left to right?", "Tell me the room's width.")
ROOM_DEPTH = ("What does the room measure from front to back?", "Tell me the room's depth.")
ROOM_HEIGHT = ("What is the ceiling height?", "How far up is the ceiling?", "Tell me how high this room is.")
ROOM_AREA = (
    "What area does the floor have?",
    "How many square metres of floor are there in all?",
    "How big is this room in m2?",
)
FREE = ("How many square metres of the floor are free?", "What area of the floor has nothing standing on it?")
FITS = (
    "Is there a free spot of {w} m by {d} m on the floor?",
    "Can a thing measuring {w} x {d} m be placed in this room?",
)
FITS_BETWEEN = (
    "Is there room for a {w} cm wide thing between {a} and {b}?",
    "Can I squeeze a {w} cm wide shelf between {a} and {b}?",
)
TRIP = (
    "What would I stumble over on the straight way from {a} to {b}?",
    "Heading straight from {a} to {b}, what is in my way?",
)
WAY_CLEAR = (
    "Does anything stand in the straight way from {a} to {b}?",
    "Heading straight from {a} to {b}, would anything be in my way?",
)
ROUTE = (
    "Could I get from {a} to {b} walking?",
    "Is there a walkable path between {a} and {b}?",
    "Can {b} be reached from {a} on foot?",
)
ABSENT = (
    "Can you tell what colour the {absent} is?",
    "What height does the {absent} have?",
    "Does the {absent} stand close to {a}?",
    "What has been placed on the {absent}?",
    "Which is taller, the {absent} or {a}?",
    "I wonder if there is {absent_one} somewhere.",
    "Is {a} next to the {absent}?",
    "On which side of the {absent} is {a}, left or right?",
)
UNDECIDABLE = (
    "Whose {a_bare} is that?",
    "Did {a} cost a lot?",
    "In which year was {a} built?",
    "Which shop sold {a}?",
    "Is {a} pleasant to use?",
    "Who uses {a} most?",
    "How long has {a} been here?",
    "Would anyone want to buy {a}?",
    "What is the family that lives here called?",
    "Is it raining outside?",
    "Does it smell nice in here?",
    "When was this room last cleaned?",
    "Who designed {a}?",
    "Is {a} under guarantee?",
    "What did {a} look like before?",
)
SEVERAL = (
    "Can you tell what colour the {bare} is?",
    "How far apart do the {bare} and {a} stand?",
    "Tell me the {bare}'s height.",
)
