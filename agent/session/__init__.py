"""A session: plans, executes, checks, logs, undoes and replays instructions on one scene.

`Session.do` passes an instruction through `planner_client` (words to a plan), `plan_runner` (operations on the scene),
`log` and `history`.
"""
