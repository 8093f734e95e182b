"""Measures of `bench ask`: questions with exact truth, written ones, robustness, routing, views and speed."""

NOTES = (
    "gaussians, graphs: questions generated from true tables (boxes, colours, labels) by geometry of the benchmark's "
    "own; in rooms of Gaussians the product sees only the embedded scene. A length or an area is right within 10 %, a "
    "list from F1 0.8, a count if it is equal; mra is the mean relative accuracy of VSI-Bench over all numbers.",
    "gaussians_true_table: the same questions of the same rooms, asked of their true tables: what is wrong there is no "
    "fault of segmentation or recognition.",
    "graphs_held_wordings: the same kinds of questions in wordings that were held back while the reader was developed "
    "(`sentences_held.py`); the wordings of the other sets were seen, in other rooms.",
    "margins: only questions whose answer is clear are asked. Taller: by 15 % and 15 cm; bigger: 1.6 times the "
    "volume; nearest: by 30 cm or 30 %, by gap and by centre; a side: 50 cm, and 1.5 times the offset along the other "
    "axis; next to: a gap up to 15 cm, not: from 1.6 m; under: 75 % of the smaller footprint; between: within 12 % of "
    "the way, not: from 80 %; fits: by 15 cm on each side; a way: for a body of 70 cm, none: for one of 40 cm; a "
    "colour: nominal paint, mean and at least half of the surface agree.",
    "refusals: what is absent must be told as absent by name; undecidable questions must have the answer null "
    "(undecidable_said: with a reason other than that the question was not read); one of several alike things must be "
    "told as several.",
    "written: questions that people wrote about composed rooms. answered: the rest was refused although there is an "
    "answer; wrong: of all questions. The held set was never read while the reader was developed.",
)
