"""The wordings of generated questions, by kind of question; {a}, {b} and {c} are things with their article.

They are written without a look at the phrases that the product reads.
"""

from __future__ import annotations

EXISTENCE = (
    "Is there {one} in here?",
    "Do you see {one} anywhere?",
    "Does this room have {one}?",
    "Can I find {one} in this room?",
    "Is {one} present?",
    "Are there any {many} in the room?",
    "Would there happen to be {one} around here?",
)
COUNT = (
    "How many {many} are there?",
    "How many {many} does the room have?",
    "What is the number of {many} in here?",
    "Count the {many}.",
    "Tell me how many {many} you can see.",
    "What's the total number of {many}?",
)
COUNT_COLOUR = (
    "How many {colour} {many} are there?",
    "Count the {colour} {many}.",
    "How many of the {many} are {colour}?",
)
COUNT_IS = (
    "Are there {n} {many} in the room?",
    "Does the room have exactly {n} {many}?",
    "Are there more than {less} {many}?",
)
COLOUR = (
    "What colour is {a}?",
    "Which color does {a} have?",
    "What is the colour of {a}?",
    "{A} is what color?",
    "Tell me the color of {a}.",
)
COLOUR_IS = ("Is {a} {colour}?", "Would you say that {a} is {colour}?", "Is the colour of {a} {colour}?")
HEIGHT = (
    "How tall is {a}?",
    "What's the height of {a}?",
    "How high is {a} from its bottom to its top?",
    "What height does {a} have, in metres?",
    "Give me the height of {a}.",
)
LENGTH = (
    "How long is {a} along its longer side?",
    "What is the length of {a}?",
    "How many metres long is {a}?",
)
WIDTH = ("How wide is {a}?", "What's the width of {a}?", "Tell me how wide {a} is in metres.")
TALLER = (
    "Which is taller, {a} or {b}?",
    "Between {a} and {b}, which one is taller?",
    "What stands higher off its base, {a} or {b}?",
    "Which of the two has the greater height: {a} or {b}?",
)
BIGGER = (
    "Which is bigger, {a} or {b}?",
    "Which one is larger, {a} or {b}?",
    "Does {a} or {b} take up more space?",
)
TALLER_IS = ("Is {a} taller than {b}?", "Is {a} higher than {b} is tall?", "Would {a} be taller than {b}?")
BIGGER_IS = ("Is {a} bigger than {b}?", "Is {a} larger than {b}?", "Is {a} smaller than {b}?")
CENTERS = (
    "How far is it from the centre of {a} to the centre of {b}?",
    "What is the distance between the middle of {a} and the middle of {b}?",
    "Measured centre to centre, how far apart are {a} and {b}?",
    "Give me the center-to-center distance between {a} and {b}.",
)
GAP = (
    "How much space is there between {a} and {b}?",
    "How wide is the gap between {a} and {b}?",
    "What is the shortest distance from the edge of {a} to the edge of {b}?",
    "How big is the gap from {a} to {b}?",
)
APART = (
    "How far is {a} from {b}?",
    "What is the distance between {a} and {b}?",
    "How many metres are {a} and {b} apart?",
    "How far away from {a} is {b}?",
)
FARTHER_THAN = (
    "Is {a} more than {d} metres away from {b}?",
    "Is the distance from {a} to {b} greater than {d} m?",
)
NEAREST = (
    "What is the closest thing to {a}?",
    "Which object is nearest to {a}?",
    "What's nearest {a}?",
    "Which thing is {a} closest to?",
)
FARTHEST = (
    "What is farthest from {a}?",
    "Which object is the furthest away from {a}?",
    "What's the most distant thing from {a}?",
)
NEARER = (
    "Which is closer to {c}, {a} or {b}?",
    "Is {a} or {b} nearer to {c}?",
    "Which of these is nearer to {c}: {a} or {b}?",
)
NEARER_IS = ("Is {a} closer to {c} than {b}?", "Is {a} nearer to {c} than {b} is?")
SIDE = (
    "Is {a} to the left or to the right of {b}?",
    "Which side of {b} is {a} on, left or right?",
    "Seen from here, is {a} left or right of {b}?",
    "From my point of view, does {a} stand left or right of {b}?",
)
SIDE_IS = (
    "Is {a} to the {side} of {b}?",
    "Is {a} {side} of {b}?",
    "From where I am looking, is {a} on the {side} of {b}?",
    "Would I see {a} on the {side} of {b}?",
)
DEPTH = (
    "Is {a} in front of or behind {b}?",
    "From where I stand, is {a} in front of {b} or behind it?",
)
DEPTH_IS = ("Is {a} {side} {b}?", "Seen from here, is {a} {side} {b}?")
OWN_SIDE = (
    "From the {b_bare}'s own point of view, is {a} on its left or its right?",
    "Taking the {b_bare}'s own left and right, on which side of it is {a}?",
    "Is {a} on {b}'s own left or right side?",
)
OWN_FRONT = (
    "Is {a} in front of {b} or behind it, going by the way {b} faces?",
    "Does {b} have {a} before it or behind it, from its own point of view?",
)
SEATED = (
    "If I sat on {b}, would {a} be on my left or my right?",
    "Sitting on {b}, do I have {a} on my left or on my right?",
    "I am seated on {b}. Is {a} to my left or to my right?",
    "When someone sits on {b}, which side is {a} on, left or right?",
)
SEATED_IS = (
    "If I were sitting on {b}, would {a} be on my {side}?",
    "I sit on {b}. Is {a} on my {side} hand side?",
    "Suppose I am sitting on {b}: is {a} to my {side}?",
)
FACING = (
    "If I stood at {b} facing {c}, would {a} be on my left or my right?",
    "Standing by {b} and looking at {c}, is {a} left or right of me?",
    "I stand next to {b} and look towards {c}. Is {a} to my left or to my right?",
    "Imagine standing at {b} and facing {c}: which side is {a} on, left or right?",
)
FACING_BEHIND = (
    "If I stood at {b} facing {c}, would {a} be behind me?",
    "Standing at {b} with my eyes on {c}, is {a} at my back?",
)
ON = (
    "What is on {a}?",
    "What is lying or standing on {a}?",
    "Which things are on top of {a}?",
    "What does {a} have on it?",
    "Name everything on {a}.",
)
ON_IS = (
    "Is {a} on {b}?",
    "Is {a} standing on {b}?",
    "Does {b} have {a_one} on it?",
    "Is there {a_one} on top of {b}?",
)
CARRIER = ("What is {a} standing on?", "On what does {a} stand?", "What is underneath {a}, holding it up?")
ANY_ON = ("Is there anything on {a}?", "Is anything standing on {a}?", "Is {a} empty on top?")
UNDER_IS = ("Is there {a_one} under {b}?", "Is {a} underneath {b}?", "Does {b} have {a_one} below it?")
NEXT_IS = ("Is {a} next to {b}?", "Is {a} right beside {b}?", "Are {a} and {b} next to each other?")
BETWEEN_IS = (
    "Is {a} between {b} and {c}?",
    "Does {a} stand between {b} and {c}?",
    "Is {a} somewhere in between {b} and {c}?",
)
INSIDE = ("What is inside {a}?", "What does {a} contain?", "What's in {a}?")
INSIDE_IS = ("Is {a} inside {b}?", "Is {a} in {b}?", "Does {b} contain {a_one}?")
OF_COLOUR = (
    "Which things are {colour}?",
    "List everything that is {colour}.",
    "What in this room is {colour}?",
    "Name all the {colour} things.",
)
ON_WALL = ("What hangs on the walls?", "List what is on the walls.", "Which things are hanging on the walls?")
ALL = (
    "What is in this room?",
    "List all the things in the room.",
    "Which objects do you see here?",
    "Name everything that is in here.",
)
TALLEST = (
    "What is the tallest thing standing on the floor?",
    "Which thing on the floor is the tallest?",
    "Of everything that stands on the floor, what is tallest?",
)
TALLEST_BUT = (
    "Apart from doors and windows, what is the tallest thing standing on the floor?",
    "Not counting doors and windows, which thing on the floor is the tallest?",
)
BULKIEST = (
    "Which thing has the largest volume?",
    "What is the largest thing in the room?",
    "What is the biggest object in here?",
)
SMALLEST = (
    "What is the smallest thing in the room?",
    "Which object is the smallest?",
    "What's the tiniest thing in here?",
)
ROOM_WIDTH = (
    "How wide is the room?",
    "What is the width of this room in metres?",
    "How many metres wide is this room?",
)
ROOM_DEPTH = ("How deep is the room?", "What is the depth of this room?", "How deep is this room from front to back?")
ROOM_HEIGHT = (
    "How high is the room?",
    "What's the height of the room?",
    "How tall is this room from floor to ceiling?",
)
ROOM_AREA = (
    "What is the floor area of the room?",
    "How many square metres does the room have?",
    "How large is the floor in square metres?",
)
FREE = (
    "How much free floor is there?",
    "How many square metres of floor are not covered by furniture?",
    "How much of the floor is empty, in square metres?",
)
FITS = (
    "Would something {w} m wide and {d} m deep fit on the floor?",
    "Is there enough free floor for a table of {w} by {d} metres?",
    "Could I put a {w} m x {d} m carpet-sized crate down somewhere without moving anything?",
    "Does a {w} m by {d} m bed fit anywhere in here?",
)
FITS_BETWEEN = (
    "Would a box {w} cm wide fit between {a} and {b}?",
    "Could something {w} cm wide go between {a} and {b}?",
    "Is the gap between {a} and {b} wide enough for a {w} cm wide cabinet?",
)
TRIP = (
    "Walking straight from {a} to {b}, what could I trip over?",
    "What lies on the straight way from {a} to {b}, so that I could stumble over it?",
    "If I go straight from {a} to {b}, what might I stumble over?",
)
WAY_CLEAR = (
    "Is anything standing on the straight line between {a} and {b}?",
    "Is something blocking the straight way from {a} to {b}?",
    "Walking straight from {a} to {b}, would I bump into anything?",
)
ROUTE = (
    "Can one walk from {a} to {b}?",
    "Is there a way to get from {a} to {b} on foot?",
    "Could a person walk from {a} over to {b} without climbing over anything?",
    "Is {b} reachable on foot from {a}?",
)
ABSENT = (
    "What colour is the {absent}?",
    "How tall is the {absent}?",
    "How far is the {absent} from {a}?",
    "Where is the {absent}?",
    "What is next to the {absent}?",
    "Is the {absent} to the left of {a}?",
    "What is on the {absent}?",
    "Is there {absent_one} in this room?",
    "Do you see {absent_one} anywhere?",
    "How many {absent_many} are there?",
    "Is {a} bigger than the {absent}?",
)
UNDECIDABLE = (
    "Who owns {a}?",
    "Who bought {a}?",
    "How much did {a} cost?",
    "What is {a} worth?",
    "How old is {a}?",
    "When was {a} made?",
    "How heavy is {a}?",
    "What does {a} weigh?",
    "Which brand is {a}?",
    "Which company made {a}?",
    "Is {a} comfortable?",
    "Does {a} still work?",
    "Who put {a} there?",
    "Where was {a} bought?",
    "What does {a} smell like?",
    "Is {a} a present from somebody?",
    "Does anybody like {a}?",
    "Has {a} ever been repaired?",
    "How often is {a} used?",
    "How warm is it in this room?",
    "Who lives here?",
    "Which city is this room in?",
    "What time is it?",
    "Is anybody at home?",
    "How noisy is it in here?",
    "What will be put on {a} tomorrow?",
    "What stood where {a} is now?",
    "Is {a} insured?",
)
SEVERAL = ("What colour is the {bare}?", "How far is the {bare} from {a}?", "How tall is the {bare}?")
