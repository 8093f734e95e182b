"""A session: plans, executes, checks, logs, undoes and replays instructions on one scene."""
